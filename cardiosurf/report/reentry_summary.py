"""A reentry analysis in a few lines for the terminal."""

from cardiosurf.analysis.circuit import Circuit
from cardiosurf.analysis.cycles import CycleLength, ProbeCycles
from cardiosurf.analysis.rotation import Phases, ReentryAnalysis
from cardiosurf.analysis.tracks import Track

MOST_SHARES = 6
"""Shares of more activations than these are added up."""
LEAST_SHARE = 0.0005
"""Smaller ones would be printed as 0.0 %."""
SENSES = {1: "counterclockwise", -1: "clockwise"}


def reentry_lines(analysis: ReentryAnalysis) -> list[str]:
    """Return an analysis as lines of text.

    Parameters
    ----------
    analysis : ReentryAnalysis
        What to tell.
    """
    reentry, phases = analysis.reentry, analysis.phases
    if reentry.verdict == "none":
        first = f"{analysis.name}: no reentry"
    else:
        first = f"{analysis.name}: {reentry.verdict} reentry"
        first += f", last reactivation at t = {reentry.last_reactivation:.1f} tu"
    lines = [first, f"  activated  {_shares(reentry.activated_shares)}"]
    if reentry.verdict != "none":
        lines.append(f"  cycle length  {_cycle(analysis.cycle_length)}")
        lines.append(f"    in the last cycle  {_cycle(analysis.recent_cycle_length)}")
        lines.append(f"  circuit  {_circuit(analysis.circuit)}")
    lines += [f"  probe {_probe(probe)}" for probe in analysis.probes]
    if phases is None:
        return [*lines, "  no frames in which tissue was excited, so no phase singularities"]
    return lines + _phase_lines(phases, analysis.cycle_length.median)


def _shares(shares: tuple[float, ...]) -> str:
    """Return shares of the area by the number of activations, many of them added up."""
    parts = [
        f"{number} times {share:.1%}"
        for number, share in enumerate(shares[:MOST_SHARES])
        if share >= LEAST_SHARE
    ]
    if len(shares) > MOST_SHARES:
        most, rest = len(shares) - 1, sum(shares[MOST_SHARES:])
        times = f"{most}" if most == MOST_SHARES else f"{MOST_SHARES} to {most}"
        parts.append(f"{times} times {rest:.1%}")
    return ", ".join(parts) + " of the area"


def _cycle(cycle: CycleLength) -> str:
    if cycle.median is None:
        return "none"
    return f"{cycle.median:.1f} tu, spread {cycle.spread:.1f} tu ({cycle.count} returns)"


def _circuit(circuit: Circuit | None) -> str:
    if circuit is None:
        return "no closed path was found"
    line = f"{circuit.length:.1f} su in {circuit.period:.1f} tu ({circuit.speed:.3f} su/tu)"
    around = circuit.enclosure
    if around is None:
        return f"{line}, round a handle of the surface"
    what = " and ".join(around.rims) or "tissue alone"
    sense = SENSES[1 if around.turns > 0 else -1]
    return f"{line}, {sense} round {what}, {around.area:.0f} su^2 inside"


def _probe(probe: ProbeCycles) -> str:
    count = len(probe.activations)
    line = f"{probe.name}  {count} activation{'' if count == 1 else 's'}"
    return line if probe.cycle_length.median is None else f"{line}, {_cycle(probe.cycle_length)}"


def _phase_lines(phases: Phases, cycle: float | None) -> list[str]:
    rotors = phases.rotors(cycle)
    others = len(phases.tracks) - len(rotors)
    line = f"  phase singularities  {phases.most} at once at most in {phases.frames} frames"
    lines = [f"{line}; {len(rotors)} live for a cycle or longer, {others} do not"]
    lines += [f"    {_rotor(track, cycle or 0.0)}" for track in rotors]
    lines += [
        f"  a wave circulates {SENSES[rim.chirality]} round {rim.name} ({rim.length:.0f} su)"
        for rim in phases.rims
        if rim.chirality in SENSES
    ]
    return lines


def _rotor(track: Track, cycle: float) -> str:
    until = "to the end" if track.died is None else f"to {track.died:.1f} tu"
    middle, radius = track.core(cycle)
    place = ", ".join(f"{value:.1f}" for value in middle)
    return (
        f"{SENSES[track.chirality]}, t = {track.born:.1f} {until}, about ({place}) su,"
        f" core radius {radius:.1f} su"
    )
