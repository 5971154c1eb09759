"""Pieces of curves on the surface, by arclength, and the points a mesh has on them."""

from dataclasses import dataclass, replace

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.geometry.levels import Level
from cardiosurf.geometry.locate import onto_level, tangential
from cardiosurf.geometry.sheet import Sheet

# eight edges to a full turn at the least
_TURN = 0.25 * np.pi
_TURN_OF_A_CHORD = 0.3


@dataclass(frozen=True)
class Piece:
    """A curve on one level.

    Attributes
    ----------
    level : int
        The level's number.
    points : (k, 3) float
        Points in order; a closed curve ends with the point it begins with.
    ends : pair of int
        The corners it runs between; (-1, -1) for a closed curve without a corner.
    soft : bool
        Whether it is the edge of regions only, so that the mesh may balance chords against it.
    """

    level: int
    points: Floats
    ends: tuple[int, int]
    soft: bool = False

    @property
    def lengths(self) -> Floats:
        """Length from the start to each point, (k,)."""
        steps = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return np.concatenate([[0.0], np.cumsum(steps)])

    @property
    def length(self) -> float:
        """Whole length."""
        return float(self.lengths[-1])

    def at(self, shares: Floats) -> Floats:
        """Return the points (n, 3) at the given shares of the length."""
        past = self.lengths
        wanted = shares * past[-1]
        return np.stack([np.interp(wanted, past, self.points[:, k]) for k in range(3)], axis=1)

    def closed(self) -> "Piece":
        """Return the piece, which ends where it begins, without a corner there."""
        return replace(self, ends=(-1, -1))

    def followed_by(self, other: "Piece", corner: int) -> "Piece":
        """Return this piece and another one joined at a corner that both end in."""
        first = self if self.ends[1] == corner else self.reversed()
        second = other if other.ends[0] == corner else other.reversed()
        points = np.concatenate([first.points, second.points[1:]])
        return replace(self, points=points, ends=(first.ends[0], second.ends[1]))

    def reversed(self) -> "Piece":
        """Return the piece run through the other way."""
        return replace(self, points=self.points[::-1].copy(), ends=self.ends[::-1])


@dataclass(frozen=True)
class Arc:
    """A curve of the skeleton, finely and evenly sampled, by its arclength.

    Attributes
    ----------
    level : Level
        It lies where this is zero.
    lengths, points : (k,), (k, 3) float
        Arclength and place of the samples.
    ends : pair of int
        Its corners, (-1, -1) if it is closed without one.
    soft : bool
        Whether it is the edge of regions only.
    """

    level: Level
    lengths: Floats
    points: Floats
    ends: tuple[int, int]
    soft: bool

    @property
    def length(self) -> float:
        """Whole length, in su."""
        return float(self.lengths[-1])

    @property
    def loop(self) -> bool:
        """Whether it is closed without a corner."""
        return self.ends == (-1, -1)

    def at(self, stations: Floats, sheet: Sheet) -> Floats:
        """Return the exact points (n, 3) at arclengths (n,)."""
        wanted = np.mod(stations, self.length) if self.loop else stations
        rough = [np.interp(wanted, self.lengths, self.points[:, k]) for k in range(3)]
        step = float(self.lengths[1])
        return onto_level(sheet.project(np.stack(rough, axis=1)), self.level, sheet, step)

    def bend(self, stations: Floats, sheet: Sheet) -> Floats:
        """Return the curvature vectors (n, 3) at arclengths (n,), in 1/su."""
        step = min(0.02 * self.length, 0.5 * float(self.lengths[1]))
        middle = stations if self.loop else np.clip(stations, step, self.length - step)
        three = np.concatenate([middle - step, middle, middle + step])
        before, here, after = self.at(three, sheet).reshape(3, -1, 3)
        first, second = here - before, after - here
        norms = np.linalg.norm(first, axis=1), np.linalg.norm(second, axis=1)
        turn = second / norms[1][:, None] - first / norms[0][:, None]
        return np.asarray(2.0 * turn / (norms[0] + norms[1])[:, None])

    def stations(self, edge_length: float, sheet: Sheet) -> Floats:
        """Return arclengths that cut the arc into edges of about edge_length.

        Where the curve is tightly bent the edges are shorter, an eighth of a turn at most. A loop
        starts at 0 and leaves out its end; an arc between corners has both its ends.
        """
        fine = np.linspace(0.0, self.length, max(33, len(self.lengths)))
        bend = np.linalg.norm(self.bend(fine, sheet), axis=1)
        density = np.maximum(1.0 / edge_length, bend / _TURN)
        steps = 0.5 * (density[1:] + density[:-1]) * np.diff(fine)
        total = np.concatenate([[0.0], np.cumsum(steps)])
        turn = float((0.5 * (bend[1:] + bend[:-1]) * np.diff(fine)).sum())
        # a single chord cannot be balanced
        balanced = 2 if self.soft and turn > _TURN_OF_A_CHORD else 1
        least = 3 if self.loop else (2 if self.ends[0] == self.ends[1] else balanced)
        count = max(least, round(float(total[-1])))
        wanted = np.arange(count + 1) * total[-1] / count
        found = np.interp(wanted, total, fine)
        return np.asarray(found[:-1] if self.loop else found)

    def places(self, stations: Floats, sheet: Sheet) -> Floats:
        """Return the mesh points (n, 3) at the stations.

        The chord of a curve of curvature kappa cuts off kappa l^3 / 12. On a region's edge the
        points stand outward by kappa l^2 / 12 + kappa^3 l^4 / 160, so that chords and curve
        enclose the same area; everywhere else they are exact.
        """
        exact = self.at(stations, sheet)
        if not self.soft or not len(stations):
            return exact
        steps = np.diff(stations)
        if self.loop:
            around = self.length - stations[-1] + stations[0]
            steps = np.concatenate([[around], steps, [around]])
        else:
            steps = np.concatenate([[0.0], steps, [0.0]])
        before, after = steps[:-1], steps[1:]
        bend = tangential(self.bend(stations, sheet), sheet.normal(exact))
        curvature = np.linalg.norm(bend, axis=1)
        cut = curvature * (before**3 + after**3) / 24.0
        cut *= 1.0 + 0.075 * curvature**2 * (before**2 + after**2) / 2.0
        gained = 0.5 * (before + after)
        outward = cut / np.maximum(gained, 1e-300)
        if not self.loop:
            # the ends are corners and stay; what they cannot make up for the others must
            outward[[0, -1]] = 0.0
            given = float((outward * gained).sum())
            outward *= min(2.0, float(cut.sum()) / given) if given > 0 else 0.0
        return sheet.project(exact - bend * (outward / np.maximum(curvature, 1e-300))[:, None])


def made_even(piece: Piece, level: Level, sheet: Sheet, step: float) -> Arc:
    """Return the arc of a piece, sampled evenly with about the given step, exactly on its level."""
    count = max(64, int(np.ceil(piece.length / step)))
    shares = np.arange(count + 1) / count
    for _ in range(2):
        points = sheet.project(piece.at(shares))
        points[1:-1] = onto_level(points[1:-1], level, sheet, piece.length / count)
        piece = replace(piece, points=points)
    return Arc(level, piece.lengths, piece.points, piece.ends, piece.soft)
