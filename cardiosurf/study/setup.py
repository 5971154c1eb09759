"""From a config to all that a march needs."""

from dataclasses import dataclass

from cardiosurf.arrays import Mask
from cardiosurf.config.accuracy import EdgeChoice, edge_choice
from cardiosurf.config.sections import Config, regions_of, target_key
from cardiosurf.errors import InputError
from cardiosurf.fem.operators import assemble
from cardiosurf.geometry.surface import Surface
from cardiosurf.stepping.controls import Controls, Execution, decide
from cardiosurf.stepping.march import Handover, Problem
from cardiosurf.study.edges import anisotropy, edge_of
from cardiosurf.study.surface_cache import surface_of
from cardiosurf.tissue.stimuli import Pulse, build_pulses
from cardiosurf.tissue.tensor import Tissue, build_tissue


@dataclass(frozen=True)
class Setup:
    """A simulation before its first step.

    Attributes
    ----------
    surface : Surface
        The mesh, with lines along the edges of every region.
    edge : EdgeChoice
        The length of its edges, and why.
    tissue : Tissue
        Diffusivity and excitability of each triangle.
    pulses : tuple of Pulse
        Every beat of every stimulus, in the order of time.
    problem : Problem
        Matrices, kinetics and these pulses.
    controls : Controls
        Scheme, step, end and linear solver, each "auto" decided.
    """

    surface: Surface
    edge: EdgeChoice
    tissue: Tissue
    pulses: tuple[Pulse, ...]
    problem: Problem
    controls: Controls

    def targets(self, config: Config) -> dict[str, Mask]:
        """Return the triangles of each target of the config, (m,) bool, in its order."""
        regions = self.surface.regions
        return {target.name: regions[target_key(target.name)] for target in config.targets}


def set_up(config: Config, execution: Execution | None = None) -> Setup:
    """Build surface, tissue and operators of a config.

    Parameters
    ----------
    config : Config
        A decoded config.
    execution : Execution, optional
        How the machine is used.

    Raises
    ------
    InputError
        If a region is empty, a stimulus or an axis does not fit the surface, a target has no
        excitable tissue, ...
    """
    edge = edge_of(config)
    surface = surface_of(config.geometry, edge.edge_length, regions_of(config))
    tissue = build_tissue(surface, config.tissue)
    if config.mesh.edge_length != "auto":
        edge = edge_choice(config, anisotropy(surface, tissue.tensor))
    pulses = build_pulses(surface, config.stimulus)
    check_targets(config, surface, tissue)
    operators = assemble(
        surface.points,
        surface.triangles,
        tissue.tensor,
        tissue.excitable,
        mass=config.mesh.mass,
    )
    controls = decide(
        config.time,
        config.kinetics,
        operators,
        accuracy=config.accuracy,
        execution=execution,
    )
    problem = Problem(Handover(operators), config.kinetics, pulses)
    return Setup(surface, edge, tissue, pulses, problem, controls)


def check_targets(config: Config, surface: Surface, tissue: Tissue) -> None:
    """Refuse targets that no wave could ever activate.

    Parameters
    ----------
    config : Config
        A decoded config.
    surface : Surface
        Its surface, which resolves the targets' regions.
    tissue : Tissue
        The tissue on it.

    Raises
    ------
    InputError
        If a target lies wholly in tissue that is not excitable.
    """
    for target in config.targets:
        inside = surface.regions[target_key(target.name)]
        if not (inside & tissue.excitable).any():
            raise InputError(
                f"targets.{target.name}.region",
                "the target lies wholly in tissue that is not excitable",
                "a target with excitable tissue",
                "move the target, or set excitable: true on the patch it lies in",
            )
