"""Where and with what a recording was made."""

import platform
import sys
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import version

PACKAGES = ("cardiosurf", "numpy", "scipy", "scikit-fem", "h5py")


def provenance() -> Mapping[str, str | Mapping[str, str]]:
    """Return the versions of what computed this, the platform and the time, for ``meta``."""
    return {
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "platform": f"{platform.system()} {platform.release()} {platform.machine()}",
        "versions": {"python": sys.version.split()[0]} | {name: version(name) for name in PACKAGES},
    }
