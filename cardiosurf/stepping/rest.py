"""Rules that end a run before its end."""

from cardiosurf.stepping.limits import REST_LEVEL
from cardiosurf.stepping.moment import Moment


def at_rest(moment: Moment) -> bool:
    """Return whether all tissue is at rest: no node above 0.05 in u, falling, no pulse pending."""
    if moment.pulse_pending:
        return False
    highest = float(moment.state[0].max())
    return highest <= REST_LEVEL and highest <= float(moment.previous_state[0].max())


def never(moment: Moment) -> bool:
    """Return False: run on to the end."""
    return False
