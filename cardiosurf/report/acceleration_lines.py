"""The measured relative acceleration in readable lines."""

from cardiosurf.analysis.acceleration_summary import AccelerationSummary, Measured


def acceleration_lines(summary: AccelerationSummary) -> list[str]:
    """Return a summary as lines of text.

    Parameters
    ----------
    summary : AccelerationSummary
        What was measured.
    """
    width = max(len(area.name) for area in summary.areas)
    window = "" if summary.window is None else f"derivatives over +-{summary.window:.0f} tu, "
    reach = f"{summary.reach:.1f} su"
    return [
        f"{summary.name}: relative acceleration |n|''/|n| of neighbouring trajectories",
        f"  {window}vertices from pairs within {reach}; medians, in brackets 5 to 95 %",
        *(f"  {area.name:{width}}  {_area(area)}" for area in summary.areas),
    ]


def _area(area: Measured) -> str:
    if area.relative is None or area.low is None or area.high is None:
        return "nothing measured: not reached, or all of it too near to an edge of the tissue"
    agree = "" if area.agree is None else f", agree to 2 errors at {area.agree:.0%}"
    other = (
        "not to be had from the LAT"
        if area.by_lat is None
        else f"from the LAT {area.by_lat:.2e} +- {area.by_lat_error:.1e}{agree}"
    )
    return (
        f"{area.relative:.2e} +- {area.error:.1e} ({area.low:.1e} to {area.high:.1e}) /tu^2"
        f" on {area.known:.0%}; {other}"
    )
