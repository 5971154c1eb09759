"""Writing a surface's mesh to the formats that hold triangles on a surface."""

from collections.abc import Mapping
from pathlib import Path

import meshio
import numpy as np

from cardiosurf.arrays import Floats, Ints
from cardiosurf.errors import InputError
from cardiosurf.geometry.surface import Surface

# every ending of meshio's that holds a surface and can be read back -> endings of the files that
# are written beside it; the others need packages that are not here, or lose triangles or digits
FORMATS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys((".xdmf", ".xmf"), (".h5",)),
    **dict.fromkeys(
        (".vtu", ".vtk", ".msh", ".ply", ".stl", ".off", ".obj", ".mesh", ".meshb", ".inp"), ()
    ),
    **dict.fromkeys((".med", ".hmf", ".mdpa", ".avs", ".vol"), ()),
    **dict.fromkeys((".post", ".dato", ".dat", ".tec", ".h5m", ".xml"), ()),
}
BARE = (".h5m", ".xml")
"""Endings of formats that meshio writes without cell data only."""


def written_files(path: Path) -> tuple[Path, ...]:
    """Return every file that writing a mesh to ``path`` makes, ``path`` first.

    Raises
    ------
    InputError
        If the ending names none of the formats.
    """
    ending = path.suffix.lower()
    if ending not in FORMATS:
        given = f"the ending {path.suffix!r}" if path.suffix else "a name without an ending"
        raise InputError(
            str(path),
            f"{given} names no mesh format",
            " ".join(FORMATS),
            f"{path.stem}.vtu",
        )
    return (path, *(path.with_suffix(beside) for beside in FORMATS[ending]))


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
        File to write; its ending, one of ``FORMATS``, names the format.

    Raises
    ------
    InputError
        If the ending names none of the formats, or the format cannot hold the surface.
    OSError
        If the file cannot be written.
    """
    path = Path(path)
    written_files(path)
    data = {
        "part": [surface.part_of.astype(np.int32)],
        "e1": [np.ascontiguousarray(surface.frame[:, 0])],
        "e2": [np.ascontiguousarray(surface.frame[:, 1])],
        **{f"region_{name}": [mask.astype(np.int32)] for name, mask in surface.regions.items()},
    }
    if path.suffix.lower() in BARE:
        data = {}
    cells = [("triangle", surface.triangles)]
    try:
        meshio.write(path, meshio.Mesh(surface.points, cells, cell_data=data))
    except meshio.WriteError:
        try:
            meshio.write(path, meshio.Mesh(surface.points, cells))
        except (meshio.WriteError, KeyError, ValueError) as problem:
            raise _unwritable(path, problem) from problem
    except (KeyError, ValueError, meshio.ReadError) as problem:
        raise _unwritable(path, problem) from problem


def write_fields(
    surface: Surface, path: Path, fields: Mapping[str, Floats], cells: Mapping[str, Ints | Floats]
) -> None:
    """Write a mesh with fields on it as VTU, which ParaView and meshio open.

    Parameters
    ----------
    surface : Surface
        The mesh.
    path : Path
        File to write, whatever its ending.
    fields : mapping of str to (n,) float
        Vertex fields by their names; NaN where there is no value.
    cells : mapping of str to (m,) int or float
        Triangle fields by their names.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    cell_data = {name: [np.asarray(values)] for name, values in cells.items()}
    triangles = [("triangle", surface.triangles)]
    mesh = meshio.Mesh(surface.points, triangles, point_data=dict(fields), cell_data=cell_data)
    meshio.write(path, mesh, file_format="vtu")


def _unwritable(path: Path, problem: Exception) -> InputError:
    return InputError(
        str(path),
        f"the mesh cannot be written in this format: {problem}",
        "another format: " + " ".join(FORMATS),
    )
