"""The findings of a run, one number or word each, and how they compare with what is expected."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cardiosurf.config.expectation import Expectation, Plain
from cardiosurf.study.folder import RECORDING


@dataclass(frozen=True)
class Compared:
    """One finding beside what was expected of it.

    Attributes
    ----------
    key : str
        Which, as in ``Expectation``.
    wanted, found : text, number, bool or None
        What was expected and what was found.
    tolerance : float
        How far a number may be off.
    agrees : bool
        Whether it is what was expected.
    """

    key: str
    wanted: Plain
    found: Plain
    tolerance: float
    agrees: bool


def findings_of(verdict: Mapping[str, Any]) -> dict[str, Plain]:
    """Return what a verdict says by dotted key: ``verdict``, ``reentry.verdict``, ``TARGET.route``.

    Parameters
    ----------
    verdict : mapping
        The content of verdict.json.
    """
    found: dict[str, Plain] = {
        key: verdict[key] for key in ("verdict", "captured", "quiescent_at", "end")
    }
    sections = {target["name"]: target for target in verdict["targets"]}
    for name, section in [*sections.items(), ("reentry", verdict["reentry"])]:
        found |= {
            f"{name}.{key}": value
            for key, value in section.items()
            if key != "name" and (value is None or isinstance(value, str | int | float))
        }
    return found


def probe_lats(folder: Path) -> dict[str, Plain]:
    """Return the LAT at each probe of a finished run, in tu, as ``lat.PROBE``; None: never.

    The first upward crossing of u = 0.5 in the probe's trace, interpolated inside the step.

    Parameters
    ----------
    folder : Path
        The run's folder.

    Raises
    ------
    InputError
        If its recording cannot be read.
    """
    # a check that asks for no probe reads no recording
    from cardiosurf.recording.hdf5 import read_recording  # noqa: PLC0415
    from cardiosurf.recording.recording import THRESHOLD  # noqa: PLC0415

    probes = read_recording(folder / RECORDING, with_frames=False).probes
    found: dict[str, Plain] = {}
    for number, name in enumerate(probes.names):
        u = probes.u[:, number]
        above = u >= THRESHOLD
        if not above.any():
            found[f"lat.{name}"] = None
            continue
        first = int(above.argmax())
        lat = float(probes.times[first])
        if first > 0:
            before, after = float(u[first - 1]), float(u[first])
            step = lat - float(probes.times[first - 1])
            lat -= step * (after - THRESHOLD) / (after - before)
        found[f"lat.{name}"] = lat
    return found


def compare(expected: Iterable[Expectation], findings: Mapping[str, Plain]) -> tuple[Compared, ...]:
    """Return every expectation beside what was found.

    Parameters
    ----------
    expected : iterable of Expectation
        What is expected.
    findings : mapping
        What was found, by the same keys; what is not there counts as None.
    """
    return tuple(
        Compared(one.key, one.wanted, found, one.tolerance, one.met_by(found))
        for one in expected
        for found in [findings.get(one.key)]
    )
