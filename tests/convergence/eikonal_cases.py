"""Waves of the model beside what the eikonal equations say of them.

``python tests/convergence/eikonal_cases.py`` prints the table of docs/theory.md.
"""

import sys
from dataclasses import dataclass

import numpy as np

from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.eikonal import arrival
from cardiosurf.analysis.eikonal_curvature import curved_arrival
from cardiosurf.analysis.planar_speed import curvature_factor, planar_speed
from cardiosurf.analysis.sources import Sources, stimulus_sources
from cardiosurf.fem.operators import assemble
from cardiosurf.geometry import Plane, Sphere, Torus, Vein, build_surface
from cardiosurf.geometry.regions import Box, BoxLimits, Part, Polar, PolarLimits
from cardiosurf.kinetics import RogersMcCulloch
from cardiosurf.recording.observers import Activation
from cardiosurf.stepping.controls import Controls
from cardiosurf.stepping.march import Problem, march
from cardiosurf.stepping.schemes import SCHEMES
from cardiosurf.stepping.solvers import choose_solver
from cardiosurf.stepping.step_rule import StepChoice
from cardiosurf.tissue.patches import Patch, TissueSection, patch_key
from cardiosurf.tissue.stimuli import EdgeStimulus, PointStimulus, build_pulses
from cardiosurf.tissue.tensor import build_tissue

KINETICS = RogersMcCulloch()
SETTLED = 20.0
"""How far from a stimulus (su) a front has grown up: 20 su at d = 1."""
QUARTER = float(np.pi / 4)
CENTRE, POLE = (0.0, 0.0, 0.0), (0.0, 0.0, 50.0)

PLANE, SPHERE = Plane(x=(-75.0, 75.0), y=(-75.0, 75.0)), Sphere(radius=50.0)
TORUS, OUTSIDE = Torus(ring_radius=60.0, tube_radius=25.0), (-85.0, 0.0, 0.0)
VEIN = Vein(root_radius=70.0, tip_radius=35.0, half_width=110.0)


@dataclass(frozen=True)
class Case:
    """A shape, a patch on it with a factor along one axis, and a stimulus."""

    name: str
    shape: object
    stimulus: object
    region: object = None
    anisotropy: object = None


CASES = (
    Case("plane, point", PLANE, PointStimulus(centre=CENTRE)),
    Case(
        "plane, point, x 4 everywhere",
        PLANE,
        PointStimulus(centre=CENTRE),
        Box(BoxLimits()),
        {"x": 4.0},
    ),
    Case(
        "plane, plane wave, block of x 4",
        PLANE,
        EdgeStimulus(edge="right"),
        Box(BoxLimits(x=(-30.0, 30.0), y=(-30.0, 30.0))),
        {"x": 4.0},
    ),
    Case("sphere, point", SPHERE, PointStimulus(centre=POLE)),
    Case(
        "sphere, point, theta 2 on a belt",
        SPHERE,
        PointStimulus(centre=POLE),
        Polar(PolarLimits(theta=(QUARTER, 3 * QUARTER))),
        {"theta": 2.0},
    ),
    Case("torus, point", TORUS, PointStimulus(centre=OUTSIDE)),
    Case(
        "torus, point, phi 4 everywhere",
        TORUS,
        PointStimulus(centre=OUTSIDE),
        Box(BoxLimits()),
        {"phi": 4.0},
    ),
    Case("vein, plane wave", VEIN, EdgeStimulus(edge="right")),
    Case("vein, plane wave, phi 4", VEIN, EdgeStimulus(edge="right"), Part("vein"), {"phi": 4.0}),
    Case(
        "vein, plane wave, theta 4", VEIN, EdgeStimulus(edge="right"), Part("vein"), {"theta": 4.0}
    ),
)


@dataclass(frozen=True)
class Comparison:
    """What a case shows, over the vertices that the front reaches after it has settled.

    Attributes
    ----------
    last : float
        Latest LAT, in tu.
    reached : float
        Share of the vertices that the march activates.
    start : (3,) tuple of float
        Mean error of arrivals from the stimulus, in tu: without curvature, with c = c0 - d K, and
        with c = c0 - g d K.
    mean, rms : (3,) tuple of float
        The same from where the front has settled, where all are given its LAT.
    """

    last: float
    reached: float
    start: tuple[float, float, float]
    mean: tuple[float, float, float]
    rms: tuple[float, float, float]


def simulated(case, edge, step=0.5):
    """Surface, tissue, pulses and LAT of a case."""
    patches, regions = (), {}
    if case.region is not None:
        patches = (Patch("patch", case.region, anisotropy=case.anisotropy),)
        regions = {patch_key("patch"): case.region}
    surface = build_surface(case.shape, edge, regions)
    tissue = build_tissue(surface, TissueSection(1.0, patches))
    operators = assemble(surface.points, surface.triangles, tissue.tensor, tissue.excitable)
    pulses, seen = build_pulses(surface, (case.stimulus,)), Activation()
    solver = choose_solver(len(surface.points), wanted="cg")
    controls = Controls(SCHEMES["sbdf2"], StepChoice(step, "test"), 3000.0, solver)
    march(Problem(operators, KINETICS, pulses), controls, (seen,))
    return surface, tissue, pulses, seen.activations().first(len(surface.points))


def compare(case, edge):
    """March a case and hold both eikonal equations against its LAT."""
    surface, tissue, pulses, lat = simulated(case, edge)
    speed = planar_speed(KINETICS)
    conductor = Conductor.of(surface, tissue)
    sources = stimulus_sources(conductor, pulses, speed)
    factors = (1.0, curvature_factor(KINETICS))
    straight = arrival(conductor, sources, speed).times
    curved = [curved_arrival(conductor, sources, speed, factor=g).times for g in factors]
    away, reached = speed * straight, np.isfinite(lat)
    seen = reached & (away > SETTLED)
    start = [(times - lat)[seen] for times in (straight, *curved)]
    # what is held makes no wave earlier: without curvature the front starts at the rim alone
    held = np.flatnonzero(reached & (away <= SETTLED))
    rim = held[away[held] > SETTLED - 2.0 * edge]
    settled = Sources.at(held, lat[held])
    straight = arrival(conductor, Sources.at(rim, lat[rim]), speed).times
    curved = [curved_arrival(conductor, settled, speed, factor=g).times for g in factors]
    errors = [(times - lat)[seen] for times in (straight, *curved)]
    return Comparison(
        last=float(np.nanmax(lat)),
        reached=float(reached.mean()),
        start=tuple(float(error.mean()) for error in start),
        mean=tuple(float(error.mean()) for error in errors),
        rms=tuple(float(np.sqrt(np.mean(error**2))) for error in errors),
    )


def rows(case, edges=(2.0, 1.4)):
    """The case's rows of the table."""
    for edge in edges:
        c = compare(case, edge)
        cells = [", ".join(f"{one:.1f}" for one in each) for each in (c.start, c.mean, c.rms)]
        yield f"| {case.name} | {edge:g} | {c.last:.0f} | {' | '.join(cells)} |\n"


if __name__ == "__main__":
    for each in CASES:
        sys.stdout.writelines(rows(each))
        sys.stdout.flush()
