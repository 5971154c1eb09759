"""Whether the stimulus started a wave at all."""

import numpy as np

from cardiosurf.arrays import Floats, Mask

CAPTURE_DISTANCE = 20.0
"""How far (su) from the stimulated tissue a wave must come to count as started.

A front is 12 su wide (10-90 %), and a stimulus that fails still spreads by diffusion over about
one such width before it collapses: fitzhugh_nagumo as printed gets 6 to 8 su far when u is set
to 1, and 14 su when a current goes on for 100 tu (docs/verdict.md).
"""


def is_far_out(points: Floats, reached: Mask, source: Mask) -> bool:
    """Tell whether a wave came ``CAPTURE_DISTANCE`` away from its source as the crow flies.

    No way on a surface is shorter than that, so the wave was captured, and no way needs to be
    looked for; no says nothing. Measured from the box about the source, which is nearer still.

    Parameters
    ----------
    points : (n, 3) float
        Vertices, in su.
    reached : (n,) bool
        Vertices that the wave activated.
    source : (n,) bool
        The stimulated ones.
    """
    if not (reached.any() and source.any()):
        return False
    box = points[source]
    beyond = np.maximum(points[reached] - box.max(axis=0), box.min(axis=0) - points[reached])
    squared = np.square(np.maximum(beyond, 0.0)).sum(axis=1).max()
    return bool(squared >= CAPTURE_DISTANCE**2)


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
