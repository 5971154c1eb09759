"""Arrival times of fronts whose speed depends on their curvature: c = c0 - D K.

With q = grad T . d grad T a front obeys c0 sqrt(q) - g sqrt(q) div(d grad T/sqrt(q)) = 1: in
isotropic tissue c = c0 sqrt(d) - g d K, K the geodesic curvature of the front. The factor g is 1
for a front alone and more for a pulse (``curvature_factor``). Written out,

    -g div(d grad T) + c0 sqrt(q) + g d grad T . grad log sqrt(q) = 1,

it is the eikonal-diffusion equation (Colli Franzone, Guerri and Rovida, J Math Biol 28:121, 1990)
with one term more, which takes back the diffusion along rays: without it a front that speeds up or
slows down is pulled along, at second order in d K/c0. Linear elements; w = log sqrt(q) is averaged
over the triangles of each vertex and held while a Newton step is made for T, and the next w is
found by Anderson's mixing. Edges that resolve a front (c0 h < 2 sqrt(d)) need no upwinding.

Open edges are no-flux, as in the model: a front stands at right angles on them.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.eikonal import arrival
from cardiosurf.analysis.sources import Sources
from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.errors import InputError

FASTEST, SLOWEST = 2.5, 0.3
"""Limits of a front's speed in w, relative to c0: fronts that meet are fast without bound."""
ROUNDS = 30
ENOUGH = 1e-4
"""Change (root of mean square) at which it is done, relative to the time the wave takes in all."""
MEMORY = 5
"""How many rounds Anderson's mixing looks back."""


@dataclass(frozen=True)
class CurvedArrival:
    """Arrival times of a front with c = c0 - D K.

    Attributes
    ----------
    times : (n,) float
        Arrival, in tu; NaN where no wave comes.
    straight : (n,) float
        That of the eikonal equation without curvature, in tu.
    rounds : int
        Newton steps taken.
    change : float
        Root of the mean square of the last one, in tu.
    """

    times: Floats
    straight: Floats
    rounds: int
    change: float


@dataclass(frozen=True)
class _Elements:
    """Linear elements on the triangles that a wave reaches.

    Attributes
    ----------
    triangles : (m, 3) int
    hats : (m, 3, 3) float
        Gradients of the three hat functions.
    fluxes : (m, 3, 3) float
        d times these.
    areas : (m,) float
    stiffness : (m, 3, 3) float
        Integrals of g grad . d grad on each triangle.
    weights : (n,) float
        A third of the area of each vertex' triangles.
    factor : float
        g.
    """

    triangles: Any
    hats: Floats
    fluxes: Floats
    areas: Floats
    stiffness: Floats
    weights: Floats
    factor: float

    @classmethod
    def of(cls, conductor: Conductor, reached: Mask, held: Ints, factor: float) -> "_Elements":
        """Return the elements of the triangles that are reached, but for those wholly held.

        Between sources times may be anything, and w there would spoil it on the next triangles.
        """
        given = np.zeros(len(reached), dtype=np.bool_)
        given[held] = True
        corners = conductor.triangles
        whole = reached[corners].all(axis=1) & ~given[corners].all(axis=1)
        part = Conductor(conductor.points, conductor.triangles[whole], conductor.tensor[whole])
        hats, areas = part.hat_gradients()
        fluxes = np.einsum("mij,maj->mai", part.tangential(), hats)
        stiffness = factor * np.einsum("m,mai,mbi->mab", areas, hats, fluxes)
        shares = np.repeat(areas / 3.0, 3)
        weights = np.bincount(part.triangles.ravel(), shares, len(part.points)).astype(np.float64)
        return cls(part.triangles, hats, fluxes, areas, stiffness, weights, factor)

    def summed(self, local: Floats) -> Floats:
        """Return the sums (n,) at the vertices of what each triangle has for its corners (m, 3)."""
        total = np.bincount(self.triangles.ravel(), local.ravel(), len(self.weights))
        return total.astype(np.float64)

    def matrix(self, local: Floats) -> Any:
        """Return the sparse sum of the triangles' matrices (m, 3, 3)."""
        rows = np.repeat(self.triangles, 3, axis=1).ravel()
        columns = np.tile(self.triangles, (1, 3)).ravel()
        shape = (len(self.weights), len(self.weights))
        return scipy.sparse.coo_array((local.ravel(), (rows, columns)), shape=shape).tocsr()

    def slowness(self, times: Floats) -> tuple[Floats, Floats]:
        """Return d grad T (m, 3) and sqrt(grad T . d grad T) (m,) of the triangles."""
        corners = times[self.triangles]
        gradient = np.einsum("mai,ma->mi", self.hats, corners)
        flux = np.einsum("mai,ma->mi", self.fluxes, corners)
        return flux, np.sqrt(np.maximum(np.einsum("mi,mi->m", gradient, flux), 1e-20))


def curved_arrival(
    conductor: Conductor, sources: Sources, speed: float, *, factor: float = 1.0
) -> CurvedArrival:
    """Return when a front arrives whose speed is c0 sqrt(d) - g d K in isotropic tissue.

    It is meant for fronts with d K well below c0, in tissue that changes over more than d/c0
    (5 su). Close to the critical curvature and where fronts meet, speeds are held between 0.3 and
    2.5 c0, and at a jump of d the divergence is a delta, whose effect depends on the mesh. The
    times at the sources hold, so they should be those of a front that is large enough to go on
    (radius above 5 su, not a point).

    Parameters
    ----------
    conductor : Conductor
        The triangles and their diffusivity.
    sources : Sources
        Where it starts, and when.
    speed : float
        c0, in su/tu.
    factor : float
        g, how much a curvature slows a front down, relative to the diffusivity
        (``curvature_factor``).

    Raises
    ------
    InputError
        As ``arrival`` does; or the factor is not positive.
    """
    if not 0.0 < factor < np.inf:
        raise InputError("factor", f"{factor}", "a positive number", "arrival has no curvature")
    straight = arrival(conductor, sources, speed).times
    reached = np.isfinite(straight)
    elements = _Elements.of(conductor, reached, sources.vertices, factor)
    free = elements.weights > 0.0
    free[sources.vertices] = False
    times = np.where(reached, straight, 0.0)
    # without curvature another source may have come first
    times[sources.vertices] = sources.times
    span = max(float(np.ptp(times[reached])), 1e-300)
    # the first steps without w: from rays to the smooth solution of the eikonal-diffusion equation
    flat, change, rounds = np.zeros(len(times)), np.inf, 0
    for _ in range(3):
        times, _ = _newton(elements, times, flat, free, speed)
    mixer = _Mixer([], [])
    w = _log_slowness(elements, times, speed)
    while rounds < ROUNDS and change > ENOUGH * span:
        rounds += 1
        times, change = _newton(elements, times, w, free, speed)
        w = mixer.next(w, _log_slowness(elements, times, speed))
    return CurvedArrival(np.where(reached, times, np.nan), straight, rounds, change)


def _newton(
    elements: _Elements, times: Floats, w: Floats, free: Mask, speed: float
) -> tuple[Floats, float]:
    """Return the times after a Newton step with w (n,) held, and how far it went."""
    flux, slow = elements.slowness(times)
    drift = elements.factor * np.einsum("mai,ma->mi", elements.fluxes, w[elements.triangles])
    gradient = np.einsum("mai,ma->mi", elements.hats, times[elements.triangles])
    rest = speed * slow + np.einsum("mi,mi->m", gradient, drift) - 1.0
    local = np.einsum("mab,mb->ma", elements.stiffness, times[elements.triangles])
    residual = elements.summed(local + (elements.areas * rest / 3.0)[:, None])
    along = speed * flux / slow[:, None] + drift
    advection = np.einsum("mi,mbi->mb", along, elements.hats)
    advection *= (elements.areas / 3.0)[:, None]
    matrix = elements.matrix(elements.stiffness + advection[:, None, :])
    step = np.zeros(len(times))
    if not free.any():
        return times, 0.0
    # its pattern is symmetric and its diagonal strong: half the work of the default ordering
    factors = scipy.sparse.linalg.splu(
        matrix[free][:, free].tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.001,
        options={"SymmetricMode": True},
    )
    step[free] = factors.solve(-residual[free])
    return times + step, float(np.sqrt(np.mean(step[free] ** 2)))


def _log_slowness(elements: _Elements, times: Floats, speed: float) -> Floats:
    """Return log(c0 sqrt(q)), the log of c0 over the speed, averaged at the vertices, (n,)."""
    slow = np.clip(speed * elements.slowness(times)[1], 1.0 / FASTEST, 1.0 / SLOWEST)
    shares = np.repeat((elements.areas / 3.0 * np.log(slow))[:, None], 3, axis=1)
    return elements.summed(shares) / np.maximum(elements.weights, 1e-300)


@dataclass(frozen=True)
class _Mixer:
    """Anderson's mixing: the fixed point of what the last rounds' steps say, were they linear."""

    images: list[Floats]
    steps: list[Floats]

    def next(self, given: Floats, image: Floats) -> Floats:
        """Return the next guess after ``given`` was mapped to ``image``."""
        self.images.append(image)
        self.steps.append(image - given)
        del self.images[:-MEMORY], self.steps[:-MEMORY]
        if len(self.steps) == 1:
            return image
        turns = np.stack([self.steps[-1] - step for step in self.steps[:-1]], axis=1)
        weights = np.linalg.lstsq(turns, self.steps[-1], rcond=1e-8)[0]
        for weight, earlier in zip(weights, self.images[:-1], strict=True):
            image = image - weight * (self.images[-1] - earlier)
        return image
