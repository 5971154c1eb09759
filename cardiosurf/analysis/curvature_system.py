"""Linear elements for a front with curvature, one Newton step at a time (``eikonal_curvature``)."""

from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.analysis.compiled.curved import linearise, log_slowness, pattern
from cardiosurf.analysis.compiled.incomplete import solve
from cardiosurf.analysis.conductor import Conductor
from cardiosurf.arrays import Floats, Ints, Mask

FASTEST, SLOWEST = 2.5, 0.3
"""Limits of a front's speed in w, relative to c0: fronts that meet are fast without bound."""
LEFT, PATIENCE = 0.3, 100
"""What a step's solution may leave of its residual, and the iterations after which a system that
is not solved (anisotropies of 50 and more on an isotropic mesh) is factorised."""


@dataclass(frozen=True)
class Sites:
    """What brings means over triangles to the vertices.

    Attributes
    ----------
    weights : (n,) float
        Area of the triangles at each vertex.
    middles : (n, 3) float
        The way to their common middle.
    rim : (p, 2) int
        A vertex whose time is given and a neighbour whose is not, for each edge of such a pair.
    across : (p, 3) float
        The way from the one to the other.
    """

    weights: Floats
    middles: Floats
    rim: Ints
    across: Floats

    @classmethod
    def of(cls, part: Conductor, given: Mask, areas: Floats) -> "Sites":
        """Return the sites of all vertices of some triangles."""
        corners, points = part.triangles, part.points
        middles = areas[:, None] * points[corners].mean(axis=1)
        weights, *sums = (
            np.bincount(corners.ravel(), np.repeat(column, 3), len(points)).astype(np.float64)
            for column in (areas, *middles.T)
        )
        # vertices of no triangle are not asked for
        away = np.stack(sums, axis=1) / np.maximum(weights, 1e-300)[:, None] - points
        pairs = corners[:, [[0, 1], [1, 2], [2, 0], [1, 0], [2, 1], [0, 2]]].reshape(-1, 2)
        rim = np.unique(pairs[given[pairs[:, 0]] & ~given[pairs[:, 1]]], axis=0)
        return cls(weights, away, rim, points[rim[:, 1]] - points[rim[:, 0]])

    def at_vertices(self, means: Floats, slopes: Floats) -> Floats:
        """Return the values (n,) by the means of values (n,) and of gradients (n, 3)."""
        values = means - np.einsum("ni,ni->n", slopes, self.middles)
        held, free = self.rim.T
        # of the triangles there all are on one side, so what the neighbours have is carried on
        carried = values[free] - np.einsum("pi,pi->p", slopes[free], self.across)
        count = np.bincount(held, minlength=len(values))
        total = np.bincount(held, carried, len(values))
        return np.where(count > 0, total / np.maximum(count, 1), values)


@dataclass(frozen=True)
class System:
    """Linear elements on the triangles that a wave reaches, and the matrix of their Newton step.

    Attributes
    ----------
    net : tuple
        Triangles (m, 3), gradients of their hat functions (m, 3, 3), d times these (m, 3, 3), and
        areas (m,).
    sites : Sites
        Of the vertices.
    order : (k,) int
        The vertices whose times are unknown, in the order of arrival.
    rows : (n,) int
        Where each vertex stands in that order; -1 where the time is given.
    starts, columns : (k + 1,), (p,) int
        The matrix' pattern, row by row.
    slots : (m, 3, 3) int
        The entry of each pair of corners.
    rule : (float, float)
        c0 and g.
    """

    net: tuple[Ints, Floats, Floats, Floats]
    sites: Sites
    order: Ints
    rows: Ints
    starts: Ints
    columns: Ints
    slots: Ints
    rule: tuple[float, float]

    @classmethod
    def of(
        cls, conductor: Conductor, straight: Floats, held: Ints, rule: tuple[float, float]
    ) -> "System":
        """Return the elements of the triangles that are reached, but for those wholly held.

        Between sources times may be anything, and w there would spoil it on the next triangles.
        """
        given, free = np.zeros((2, len(straight)), dtype=np.bool_)
        given[held] = True
        corners = np.ascontiguousarray(conductor.triangles, dtype=np.int64)
        whole = np.isfinite(straight)[corners].all(axis=1) & ~given[corners].all(axis=1)
        part = Conductor(conductor.points, corners[whole], conductor.tensor[whole])
        hats, areas = part.hat_gradients()
        net = (part.triangles, hats, hats @ part.tangential(), areas)
        free[part.triangles] = True
        order = np.flatnonzero(free & ~given)
        order = order[np.argsort(straight[order], kind="stable")]
        rows = np.full(len(straight), -1)
        rows[order] = np.arange(len(order))
        starts, columns, slots = pattern(part.triangles, rows, (order, *part.corners_around()))
        return cls(net, Sites.of(part, given, areas), order, rows, starts, columns, slots, rule)

    def newton(self, times: Floats, w: Floats) -> float:
        """Take a Newton step of the times (n,) with w (n,) held, and return how far it went."""
        data = np.zeros(len(self.columns))
        fields = (times, w)
        residual = linearise(self.net, fields, self.rule, self.rows, self.slots, data)
        step, rounds = solve(self.starts, self.columns, data, -residual, LEFT, PATIENCE)
        if rounds < 0:
            step = self._factorised(data, -residual)
        times[self.order] += step
        return float(np.sqrt(np.mean(step**2)))

    def _factorised(self, data: Floats, given: Floats) -> Floats:
        """Return the solution by complete factors."""
        shape = (len(given), len(given))
        matrix = scipy.sparse.csr_array((data, self.columns, self.starts), shape=shape)
        # its pattern is symmetric and its diagonal strong: half the work of the default ordering
        factors = scipy.sparse.linalg.splu(
            matrix.tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.001,
            options={"SymmetricMode": True},
        )
        return np.asarray(factors.solve(given))

    def log_slowness(self, times: Floats, w: Floats) -> Floats:
        """Return log(c0 sqrt(q)) at the vertices, (n,), by the times and the gradient of w (n,)."""
        limits = (1.0 / FASTEST, 1.0 / SLOWEST)
        weights, speed = self.sites.weights, self.rule[0]
        means, slopes = log_slowness(self.net, (times, w), weights, speed, limits)
        return self.sites.at_vertices(means, slopes)
