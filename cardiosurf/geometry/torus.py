"""The torus."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardiosurf.errors import InputError
from cardiosurf.geometry.profile import Profile
from cardiosurf.geometry.revolved import RevolvedSheet
from cardiosurf.sections import Positive, Section

_THICKEST = 0.95


@dataclass(frozen=True)
class Torus(Section):
    """The tube of tube_radius about the circle of ring_radius in the plane z = 0, in su.

    x = ((R + r cos theta) cos phi, (R + r cos theta) sin phi, r sin theta), R = ring_radius,
    r = tube_radius; theta and phi from -pi to pi, theta = 0 on the outer equator. No open edges.
    e_theta x e_phi, and with it the sense of the triangles, points into the tube.

    Source: Chun's paper, Appendix C, problems 4 and 5 (its z = r cos theta is a slip).
    """

    kind: Literal["torus"] = "torus"
    ring_radius: Positive = 100.0
    tube_radius: Positive = 50.0

    def check(self) -> None:
        """Raise InputError unless there is a hole in the middle."""
        thickest = _THICKEST * self.ring_radius
        if not 0 < self.tube_radius <= thickest * (1.0 + 1e-9):
            raise InputError(
                "geometry.tube_radius",
                f"{self.tube_radius} with ring_radius {self.ring_radius}",
                f"0 < tube_radius <= {thickest:g} ({_THICKEST:g} ring_radius)",
                "ring_radius is that of the circle in the middle of the tube",
            )

    def extents(self) -> dict[str, float]:
        """Return the radii of the tube and of the hole, in su."""
        return {
            "tube_radius": self.tube_radius,
            "ring_radius": self.ring_radius - self.tube_radius,
        }

    def sheet(self, edge_length: float) -> RevolvedSheet:
        """Return the exact surface (the same for every edge length)."""
        self.check()
        ring, tube = self.ring_radius, self.tube_radius
        half = np.pi * tube
        profile = Profile(
            start=(ring - tube, 0.0),
            heading=-0.5 * np.pi,
            bows=((1.0 / tube, 2.0 * half),),
            before=half,
            closed=True,
        )
        return RevolvedSheet(
            profile=profile,
            axis_x=0.0,
            parts=("torus",),
            stations=(-half, half),
            angles=(-np.pi, np.pi),
            edge_names=(),
            coarsest=0.5 * min(tube, ring - tube),
        )
