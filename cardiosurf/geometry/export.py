"""Writing a surface's mesh to any format meshio knows."""

from pathlib import Path

import meshio
import numpy as np

from cardiosurf.errors import InputError
from cardiosurf.geometry.surface import Surface


def write_mesh(surface: Surface, path: Path | str) -> None:
    """Write the mesh with its parts, regions and net frame as cell data.

    The parts are written as the number of the part (data "part"), each region as 0 or 1
    ("region_" and its name), the frame as the vectors "e1" and "e2". A format that holds no cell
    data gets the mesh alone.

    Parameters
    ----------
    surface : Surface
        What to write.
    path : Path or str
        File to write; its ending names the format (vtu, vtk, ply, stl, msh, off, obj, xdmf ...).

    Raises
    ------
    InputError
        If the ending names no format meshio can write, or the file cannot be written.
    """
    data = {
        "part": [surface.part_of.astype(np.int32)],
        "e1": [np.ascontiguousarray(surface.frame[:, 0])],
        "e2": [np.ascontiguousarray(surface.frame[:, 1])],
        **{f"region_{name}": [mask.astype(np.int32)] for name, mask in surface.regions.items()},
    }
    cells = [("triangle", surface.triangles)]
    try:
        meshio.write(path, meshio.Mesh(surface.points, cells, cell_data=data))
    except meshio.WriteError:
        try:
            meshio.write(path, meshio.Mesh(surface.points, cells))
        except (meshio.WriteError, KeyError, ValueError) as problem:
            raise _unwritable(path, problem) from problem
    except (OSError, KeyError, ValueError, meshio.ReadError) as problem:
        raise _unwritable(path, problem) from problem


def _unwritable(path: Path | str, problem: Exception) -> InputError:
    return InputError(
        str(path),
        f"the mesh cannot be written: {problem}",
        "an ending that meshio knows: .vtu, .vtk, .ply, .stl, .msh, .off, .obj, .xdmf",
    )
