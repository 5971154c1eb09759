"""The mesh edges of a run, where the tissue has its say."""

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.config.accuracy import EdgeChoice, edge_choice
from cardiosurf.config.sections import Config, regions_of
from cardiosurf.errors import InputError
from cardiosurf.geometry.surface import Surface
from cardiosurf.study.surface_cache import surface_of
from cardiosurf.tissue.patches import factors_of
from cardiosurf.tissue.tensor import build_tissue

COARSER = 3.0
"""How much coarser than isotropic tissue allows a mesh may be to tell the patches' areas."""


def edge_of(config: Config) -> EdgeChoice:
    """Return the mesh edges of a config, ``auto`` resolved for its tissue (``edge_choice``).

    How much of the area is anisotropic is found on a coarse mesh.

    Parameters
    ----------
    config : Config
        A decoded config.

    Raises
    ------
    InputError
        If a patch's region is empty or one of its axes is not there.
    """
    isotropic = edge_choice(config)
    if config.mesh.edge_length != "auto" or not _is_anisotropic(config):
        return isotropic
    regions = regions_of(config)
    try:
        surface = surface_of(config.geometry, COARSER * isotropic.edge_length, regions)
    except InputError:
        # a shape too small for so coarse a mesh
        surface = surface_of(config.geometry, isotropic.edge_length, regions)
    tensor = build_tissue(surface, config.tissue).tensor
    return edge_choice(config, anisotropy(surface, tensor))


def anisotropy(surface: Surface, tensor: Floats) -> float:
    """Return the mean over the area of (ratio - 1) / d, in tu/su^2.

    Parameters
    ----------
    surface : Surface
        The mesh.
    tensor : (m, 3, 3) float
        Diffusivity of its triangles, in su^2/tu; d is the smaller of the two in the surface, ratio
        that of the larger to the smaller.
    """
    mean = 0.5 * np.trace(tensor, axis1=1, axis2=2)
    spread = np.sqrt(np.maximum(0.5 * np.einsum("mij,mij->m", tensor, tensor) - mean**2, 0.0))
    smaller, larger = mean - spread, mean + spread
    areas = surface.areas()
    # equal diffusivities differ by the root of rounding
    ratio = np.where(spread < 1e-6 * mean, 1.0, larger / smaller)
    return float(areas @ ((ratio - 1.0) / smaller) / areas.sum())


def _is_anisotropic(config: Config) -> bool:
    """Return whether a patch names net axes; both of them alike make no difference to the mesh."""
    return any(isinstance(factors_of(patch), dict) for patch in config.tissue.patches)
