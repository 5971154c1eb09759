"""Where the benchmarks keep what they measured, with the machine it was measured on."""

import json
import platform
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).resolve().parent / "results"
PACKAGES = ("numpy", "scipy", "numba", "scikit-fem", "h5py")


def machine() -> dict[str, str]:
    """Return processor, Python and packages."""
    processor = platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        processor = names[0].partition(":")[2].strip() if names else processor
    packages = ", ".join(f"{name} {version(name)}" for name in PACKAGES)
    return {
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "processor": processor,
        "software": f"Python {platform.python_version()}, {packages}",
    }


def write(name: str, content: dict[str, Any]) -> None:
    """Write a benchmark's results, whole or not at all."""
    RESULTS.mkdir(exist_ok=True)
    beside = RESULTS / f".{name}.json"
    beside.write_text(json.dumps(machine() | content, indent=1) + "\n", encoding="utf-8")
    beside.replace(RESULTS / f"{name}.json")


def read(name: str) -> dict[str, Any] | None:
    """Return a benchmark's results, None if it has not run."""
    path = RESULTS / f"{name}.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None
