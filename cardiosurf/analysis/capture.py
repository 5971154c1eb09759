"""Whether the stimulus started a wave at all."""

import numpy as np

from cardiosurf.arrays import Floats, Mask

CAPTURE_DISTANCE = 20.0
"""How far (su) from the stimulated tissue a wave must come to count as started.

A front is 12 su wide (10-90 %), and a stimulus that fails still spreads by diffusion over about
one such width before it collapses: fitzhugh_nagumo as printed gets 6 to 8 su far when u is set
to 1, and 14 su when a current goes on for 100 tu (docs/verdict.md).
"""


def has_captured(activated: Mask, distance: Floats) -> bool:
    """Tell whether the wave that a stimulus set off left the stimulated tissue.

    Parameters
    ----------
    activated : (n,) bool
        Vertices with an activation that goes back to this stimulus.
    distance : (n,) float
        Distance from the stimulated vertices through excitable tissue, in su; infinite where there
        is no way.

    Returns
    -------
    bool
        Whether tissue at least ``CAPTURE_DISTANCE`` away was activated, or half as far as the
        excitable tissue reaches where that is less.
    """
    reachable = np.isfinite(distance)
    reached = activated & reachable
    if not reached.any():
        return False
    farthest = float(distance[reachable].max())
    if farthest == 0.0:
        return True
    return bool(distance[reached].max() >= min(CAPTURE_DISTANCE, 0.5 * farthest))
