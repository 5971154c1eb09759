"""A simplified atrium: a body with a vein on top, both surfaces of revolution."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardiosurf.errors import InputError
from cardiosurf.geometry.angles import Angle
from cardiosurf.geometry.profile import Profile
from cardiosurf.geometry.revolved import RevolvedSheet
from cardiosurf.geometry.vein import check_radii
from cardiosurf.sections import Coordinate, Positive, Section

_JOIN = 0.25 * np.pi
"""Angle from the top of the body's circle at which it takes over: the paper's first grid point."""
_BEYOND = 0.6


@dataclass(frozen=True)
class Atrium(Section):
    """A vein on a body, both turned about the vertical line x = axis_x, y = 0, in su.

    With rho the distance from the axis the profile is, from the open tip downward:

    - the vein, a quarter circle of radius root_radius - tip_radius from the tip (tip_radius,
      root_radius - tip_radius) to the root (root_radius, 0), horizontal there;
    - the join (below);
    - the body's circle of radius body_radius about (ring_radius, -body_radius), from 45 degrees
      past its top to bottom_angle past it, where it is open.

    Parts: vein and body (join and circle). Open edges: tip and bottom. Net (theta, phi): phi the
    azimuth about the axis from +x; theta grows downward, evenly with the arclength: the angle on
    the vein's circle, 0 at the tip and pi/2 at the root, and from there on pi/2 plus the
    arclength from the root over body_radius. e_theta x e_phi points outward.

    Join: the root lies outside the body's circle, by 2.46 su with the paper's numbers, and the
    circle is steeper there. A bow of radius body_radius - (root_radius - ring_radius) cot(pi/8) =
    31.72 turns down by 45 degrees, the tangent of the circle, root_radius - ring_radius = 20
    long, leads on to it at the paper's first grid point (116.57, -23.43). All tangents are
    continuous. Where ring_radius > root_radius a level ring joins the root to the circle's top.

    Source: Chun's paper, section 6: body R = 80, vein r_c = 0.7 R, axis c_m = -20.
    """

    kind: Literal["atrium"] = "atrium"
    axis_x: Coordinate = -20.0
    root_radius: Positive = 100.0
    tip_radius: Positive = 44.0
    ring_radius: Positive = 80.0
    body_radius: Positive = 80.0
    bottom_angle: Angle = 1.25 * np.pi

    def check(self) -> None:
        """Raise InputError unless vein and body meet, and the body stays clear of the axis."""
        check_radii(self.root_radius, self.tip_radius)
        gap, most = self.root_radius - self.ring_radius, self.body_radius * np.tan(0.5 * _JOIN)
        if not gap < 0.95 * most:
            raise InputError(
                "geometry.ring_radius",
                f"{self.ring_radius} with root_radius {self.root_radius}",
                f"above {self.root_radius - 0.95 * most:g}: the root at most "
                f"{0.95 * most:.4g} farther out than the top of the body's circle",
            )
        if not _JOIN < self.bottom_angle < 2.0 * np.pi:
            raise InputError(
                "geometry.bottom_angle",
                f"{self.bottom_angle:g} radians from the top of the body's circle",
                "more than pi/4 and less than 2*pi",
            )
        angle = min(self.bottom_angle, 1.5 * np.pi)
        nearest = self.ring_radius + self.body_radius * min(np.sin(_JOIN), np.sin(angle))
        if not nearest >= 0.05 * self.body_radius:
            raise InputError(
                "geometry.bottom_angle",
                f"the body comes within {nearest:.4g} su of the axis",
                f"at least {0.05 * self.body_radius:g} su (body_radius / 20)",
                "a smaller bottom_angle, or a larger ring_radius",
            )

    def extents(self) -> dict[str, float]:
        """Return the radii of the tip and of the body's circle, in su."""
        return {"tip_radius": self.tip_radius, "body_radius": self.body_radius}

    def sheet(self, edge_length: float) -> RevolvedSheet:
        """Return the exact surface (the same for every edge length)."""
        self.check()
        arc, body = self.root_radius - self.tip_radius, self.body_radius
        gap = self.root_radius - self.ring_radius
        before = _BEYOND * self.tip_radius
        after = _BEYOND * (self.ring_radius + body * float(np.sin(self.bottom_angle)))
        body_bows = _body(gap, body, self.bottom_angle)
        vein = 0.5 * np.pi * arc
        end = vein + sum(length for _, length in body_bows)
        profile = Profile(
            start=(self.tip_radius, arc + before),
            heading=-0.5 * np.pi,
            bows=((0.0, before), (1.0 / arc, vein), *body_bows, (0.0, after)),
            before=before,
        )
        return RevolvedSheet(
            profile=profile,
            axis_x=self.axis_x,
            parts=("vein", "body"),
            stations=(0.0, vein, end),
            angles=(0.0, 0.5 * np.pi, 0.5 * np.pi + (end - vein) / body),
            edge_names=("tip", "bottom"),
            coarsest=0.5 * min(arc, body, self.tip_radius),
        )


def _body(gap: float, radius: float, bottom: float) -> tuple[tuple[float, float], ...]:
    """Return the bows from the root to the bottom: curvature in 1/su, length in su."""
    if gap <= 0.0:
        return (
            ((0.0, -gap), (-1.0 / radius, radius * bottom))
            if gap < 0.0
            else ((-1.0 / radius, radius * bottom),)
        )
    turn = radius - gap / float(np.tan(0.5 * _JOIN))
    return (
        (-1.0 / turn, turn * _JOIN),
        (0.0, gap),
        (-1.0 / radius, radius * (bottom - _JOIN)),
    )
