"""Whether the stimulus started a wave at all."""

import numpy as np

from cardiosurf.arrays import Floats

CAPTURE_DISTANCE = 20.0
"""How far (su) from the stimulated tissue a wave must come to count as started.

A front is 12 su wide (10-90 %), and a stimulus that fails still spreads by diffusion over about
one such width before it collapses: fitzhugh_nagumo as printed gets 6 to 8 su far when u is set
to 1, and 14 su when a current goes on for 100 tu (docs/verdict.md).
"""


def captured(lat: Floats, unperturbed: Floats) -> bool:
    """Tell whether the wave left the stimulated tissue.

    Parameters
    ----------
    lat : (n,) float
        First activation, NaN where never, in tu.
    unperturbed : (n,) float
        Distance from the stimulated vertices, in su.

    Returns
    -------
    bool
        Whether tissue at least ``CAPTURE_DISTANCE`` away was activated, or half as far as the
        surface reaches where that is less.
    """
    reachable = np.isfinite(unperturbed)
    activated = np.isfinite(lat) & reachable
    if not activated.any():
        return False
    farthest = float(unperturbed[reachable].max())
    if farthest == 0.0:
        return True
    return bool(unperturbed[activated].max() >= min(CAPTURE_DISTANCE, 0.5 * farthest))
