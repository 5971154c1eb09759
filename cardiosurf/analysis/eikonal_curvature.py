"""Arrival times of fronts whose speed depends on their curvature: c = c0 - D K.

With q = grad T . d grad T a front obeys c0 sqrt(q) - g sqrt(q) div(d grad T/sqrt(q)) = 1: in
isotropic tissue c = c0 sqrt(d) - g d K, K the geodesic curvature of the front. The factor g is 1
for a front alone and more for a pulse (``curvature_factor``). Written out,

    -g div(d grad T) + c0 sqrt(q) + g d grad T . grad log sqrt(q) = 1,

it is the eikonal-diffusion equation (Colli Franzone, Guerri and Rovida, J Math Biol 28:121, 1990)
with one term more, which takes back the diffusion along rays: without it a front that speeds up or
slows down is pulled along, at second order in d K/c0. Linear elements; w = log sqrt(q) is the mean
over the triangles of each vertex, carried from their middle to the vertex by its own gradient, and
at the rim of the sources carried on from the vertices before it. It is held while a Newton step is
made for T, and the next w is found by Anderson's mixing. The system of a step is solved to a third,
by iterations in the order of arrival (``compiled.incomplete``): the rounds correct what is left as
they go. Edges that resolve a front (c0 h < 2 sqrt(d)) need no upwinding. Second order.

Open edges are no-flux, as in the model: a front stands at right angles on them.
"""

from dataclasses import dataclass

import numpy as np

from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.curvature_system import System
from cardiosurf.analysis.eikonal import arrival
from cardiosurf.analysis.sources import Sources
from cardiosurf.arrays import Floats
from cardiosurf.errors import InputError

ROUNDS = 60
ENOUGH = 1e-4
MEMORY = 5
"""How many rounds Anderson's mixing looks back."""
FLAT = 3
"""Steps without w that come first: from rays to the smooth solution of eikonal and diffusion."""


@dataclass(frozen=True)
class CurvedArrival:
    """Arrival times of a front with c = c0 - D K.

    Attributes
    ----------
    times : (n,) float
        Arrival, in tu; NaN where no wave comes.
    straight : (n,) float
        What it began from: that of the eikonal equation without curvature, in tu.
    rounds : int
        Newton steps taken.
    change : float
        Root of the mean square of the last one, in tu.
    """

    times: Floats
    straight: Floats
    rounds: int
    change: float


def curved_arrival(
    conductor: Conductor,
    sources: Sources,
    speed: float,
    *,
    factor: float = 1.0,
    enough: float = ENOUGH,
    straight: Floats | None = None,
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
    enough : float
        Change of the times (root of the mean square) at which it is done, relative to the time that
        the wave takes in all. What is left then is one to eight times that.
    straight : (n,) float or None
        Arrival without curvature to begin from, in tu; None: of the first order, which will do.

    Raises
    ------
    InputError
        As ``arrival`` does; or the factor is not positive.
    """
    if not 0.0 < factor < np.inf:
        raise InputError("factor", f"{factor}", "a positive number", "arrival has no curvature")
    if straight is None:
        straight = arrival(conductor, sources, speed, order=1).times
    reached = np.isfinite(straight)
    system = System.of(conductor, straight, sources.vertices, (speed, factor))
    times = np.where(reached, straight, 0.0)
    # without curvature another source may have come first
    times[sources.vertices] = sources.times
    change, rounds = 0.0, 0
    if len(system.order):
        rounds, change = _settle(system, times, enough * float(np.ptp(times[reached])))
    return CurvedArrival(np.where(reached, times, np.nan), straight, rounds, change)


def _settle(system: System, times: Floats, enough: float) -> tuple[int, float]:
    """Change the times (n,) until a round changes them by little; return rounds and last change."""
    flat, change, rounds = np.zeros(len(times)), np.inf, 0
    for _ in range(FLAT):
        system.newton(times, flat)
    mixer = _Mixer([], [])
    w = system.log_slowness(times, flat)
    while rounds < ROUNDS and change > enough:
        rounds += 1
        change = system.newton(times, w)
        w = mixer.next(w, system.log_slowness(times, w))
    return rounds, change


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
