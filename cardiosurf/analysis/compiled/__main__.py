"""Compile arrivals and trajectories now: ``python -m cardiosurf.analysis.compiled``.

Without it the first of each takes some seconds more, once.
"""

import sys

import numpy as np

from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.eikonal import arrival
from cardiosurf.analysis.eikonal_curvature import curved_arrival
from cardiosurf.analysis.sources import Sources
from cardiosurf.analysis.trajectories import Places, trajectories


def main() -> int:
    """Send a front over two triangles, and follow it."""
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    conductor = Conductor(points, triangles, np.broadcast_to(np.eye(3), (2, 3, 3)))
    found = arrival(conductor, Sources.at(np.array([0])), 1.0)
    curved_arrival(conductor, Sources.at(np.array([0])), 1.0)
    trajectories(conductor, found.times, Places(np.array([0]), np.full((1, 3), 1.0 / 3.0)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
