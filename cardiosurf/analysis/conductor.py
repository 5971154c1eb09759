"""What a wave runs over: the excitable triangles, each with the metric of its travel times."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.analysis.neighbours import triangles_around
from cardiosurf.arrays import Floats, Ints
from cardiosurf.errors import InputError
from cardiosurf.geometry.surface import Surface
from cardiosurf.geometry.topology import edge_vectors
from cardiosurf.tissue.tensor import Tissue


@dataclass(frozen=True)
class Conductor:
    """Triangles that a wave can run over, with their diffusivity.

    Attributes
    ----------
    points : (n, 3) float
        Vertices, in su.
    triangles : (m, 3) int
        Vertex numbers.
    tensor : (m, 3, 3) float
        Diffusivity d, in su^2/tu; only its tangential part counts.
    """

    points: Floats
    triangles: Ints
    tensor: Floats

    @classmethod
    def of(cls, surface: Surface, tissue: Tissue) -> "Conductor":
        """Return the excitable part of a surface; scar is a hole to a front."""
        excitable = tissue.excitable
        return cls(surface.points, surface.triangles[excitable], tissue.tensor[excitable])

    @classmethod
    def isotropic(cls, points: Floats, triangles: Ints) -> "Conductor":
        """Return triangles with d = 1 everywhere."""
        return cls(points, triangles, np.broadcast_to(np.eye(3), (len(triangles), 3, 3)))

    def planes(self) -> Floats:
        """Return an orthonormal pair of vectors in each triangle, (m, 2, 3)."""
        sides = edge_vectors(self.points, self.triangles)
        first = sides[:, 0] / np.linalg.norm(sides[:, 0], axis=1, keepdims=True)
        second = sides[:, 1] - np.einsum("mi,mi->m", sides[:, 1], first)[:, None] * first
        second /= np.linalg.norm(second, axis=1, keepdims=True)
        return np.stack([first, second], axis=1)

    def tangential(self) -> Floats:
        """Return the part of d that lies in the triangles, (m, 3, 3), in su^2/tu."""
        planes = self.planes()
        across = planes.transpose(0, 2, 1)
        return np.asarray(across @ (planes @ self.tensor @ across) @ planes)

    def metric(self) -> Floats:
        """Return the inverse of d in each triangle's plane, (m, 3, 3), in tu/su^2.

        A vector x takes the time sqrt(x . metric x)/c0.

        Raises
        ------
        InputError
            The diffusivity of a triangle is not positive.
        """
        planes = self.planes()
        across = planes.transpose(0, 2, 1)
        within = planes @ self.tensor @ across
        determinant = within[:, 0, 0] * within[:, 1, 1] - within[:, 0, 1] * within[:, 1, 0]
        wrong = ~((determinant > 0.0) & (within[:, 0, 0] > 0.0))
        if wrong.any():
            raise InputError(
                "tissue",
                f"the diffusivity of {int(wrong.sum())} triangles is not positive",
                "tensors that are positive in the surface",
            )
        other = np.empty_like(within)
        other[:, 0, 0], other[:, 1, 1] = within[:, 1, 1], within[:, 0, 0]
        other[:, 0, 1], other[:, 1, 0] = -within[:, 0, 1], -within[:, 1, 0]
        other /= determinant[:, None, None]
        return np.asarray(across @ other @ planes)

    def hat_gradients(self) -> tuple[Floats, Floats]:
        """Return the hat functions' gradients, (m, 3, 3), in 1/su, and areas, (m,), in su^2."""
        sides = edge_vectors(self.points, self.triangles)
        normal = np.cross(sides[:, 0], sides[:, 1])
        twice = np.linalg.norm(normal, axis=1)
        hats = np.cross(normal[:, None], sides) / (twice * twice)[:, None, None]
        return hats, 0.5 * twice

    def corners_around(self) -> tuple[Ints, Ints]:
        """Return corners 3 t + i by vertex, (3 m,), and where each vertex begins, (n + 1,)."""
        around = triangles_around(self.triangles, len(self.points))
        owner = np.repeat(np.arange(len(self.points)), around.counts)
        of_vertex = self.triangles[around.items] == owner[:, None]
        corners = 3 * around.items + np.argmax(of_vertex, axis=1)
        return corners, np.append(around.starts, len(corners))
