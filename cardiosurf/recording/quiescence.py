"""Since when all tissue is at rest."""

import numpy as np

from cardiosurf.recording.observers import Snapshot
from cardiosurf.stepping.limits import REST_LEVEL
from cardiosurf.stepping.moment import Moment
from cardiosurf.stepping.rest import at_rest


class Quiescence:
    """Notes when the tissue comes to rest, and forgets it if it is excited again.

    Rest begins where the rule that ends a run first holds (``stepping.rest.at_rest``), so a run
    that goes on from there tells the same time as one that stops. It ends when a node rises above
    the rule's level or a pulse comes; recovery from an undershoot, still below it, does not end it.
    """

    def __init__(self) -> None:
        self._since: float | None = None

    @property
    def since(self) -> float | None:
        """Since when all tissue has been at rest, in tu; None if it is not."""
        return self._since

    def initialize(self, moment: Moment) -> None:
        """Wait for the first step: tissue that nothing has happened to yet is not asked."""

    def handle(self, moment: Moment) -> None:
        """Look whether rest begins or ends here."""
        if self._since is None:
            # the march does not ask its rule at an instantaneous pulse either
            if moment.time > moment.previous_time and at_rest(moment):
                self._since = moment.time
        elif moment.pulse_pending or float(moment.state[0].max()) > REST_LEVEL:
            self._since = None

    def due(self) -> float:
        """Any moment will do: there is one wherever rest begins or ends."""
        return np.inf

    def finalize(self, moment: Moment) -> None:
        """Nothing is left to do."""

    def snapshot(self) -> Snapshot:
        """Return since when there is rest, NaN = there is none."""
        return {"since": np.asarray(np.nan if self._since is None else self._since)}

    def restore(self, snapshot: Snapshot) -> None:
        """Take back what ``snapshot`` returned."""
        since = float(snapshot["since"])
        self._since = None if np.isnan(since) else since
