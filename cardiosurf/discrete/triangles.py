"""The triangles of a surface as units: each faces the three across its edges."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.arrays import Floats, Mask
from cardiosurf.discrete.network import Network, link_factors, linked
from cardiosurf.geometry.surface import Surface
from cardiosurf.tissue.tensor import Tissue


@dataclass(frozen=True)
class Units:
    """The triangles of a surface as units.

    Attributes
    ----------
    network : Network
        Links across shared edges, in both directions.
    refuse : (m,) bool
        Triangles that cannot be excited.
    spacing : float
        Mean distance between the centroids of neighbours, in su.
    """

    network: Network
    refuse: Mask
    spacing: float


def units_of(surface: Surface, tissue: Tissue, *, loads: bool = True) -> Units:
    """Return the triangles of a surface as units of Appendix B's model.

    A link's diffusivity is that along the line between the centroids, on either triangle; its speed
    goes with sqrt(d) and with how much shorter that line is than the mean.

    Parameters
    ----------
    surface : Surface
        The mesh.
    tissue : Tissue
        Diffusivity and excitability of its triangles.
    loads : bool
        As in ``link_factors``.
    """
    sides = np.sort(surface.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    owners = np.repeat(np.arange(len(surface.triangles)), 3)
    order = np.lexsort(sides.T)
    sides, owners = sides[order], owners[order]
    shared = np.flatnonzero((sides[1:] == sides[:-1]).all(axis=1))
    one, other = owners[shared], owners[shared + 1]
    source, target = np.concatenate([one, other]), np.concatenate([other, one])
    middles = surface.points[surface.triangles].mean(axis=1)
    step = middles[target] - middles[source]
    length = np.linalg.norm(step, axis=1)
    spacing = float(length.mean())
    along = [_along(tissue.tensor[end], surface.frame[end], step) for end in (source, target)]
    speeds, costs = link_factors(along[0], along[1], loads=loads)
    pairs = np.stack([source, target], axis=1)
    network = linked(len(surface.triangles), pairs, speeds * spacing / length, costs)
    return Units(network, ~tissue.excitable, spacing)


def _along(tensor: Floats, frame: Floats, step: Floats) -> Floats:
    """Return the diffusivity along steps, (e,), as they lie in each triangle's own plane."""
    within = np.einsum("eai,ei->ea", frame, step)
    along = np.einsum("ei,eij,ej->e", step, tensor, step)
    return np.asarray(along / (within**2).sum(axis=1))
