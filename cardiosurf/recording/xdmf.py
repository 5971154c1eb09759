"""XDMF files beside a recording: ParaView and meshio open mesh, frames and maps through them.

They hold no numbers, only references into the HDF5 file by its bare name, so the folder can be
moved. Each frame is a dataset of its own (a view), because not every reader knows hyperslabs.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

import h5py

from cardiosurf.recording.frame_sets import FRAMES, numbered, view_of
from cardiosurf.recording.whole_file import whole_file

MAPS = {
    "LAT [tu]": ("Node", "activation/first"),
    "last LAT [tu]": ("Node", "activation/last"),
    "activations": ("Node", "activation/count"),
    "repolarisation [tu]": ("Node", "repolarisation/first"),
    "part": ("Cell", "mesh/part_of"),
    "patch": ("Cell", "tissue/patch_of"),
    "excitable": ("Cell", "tissue/excitable"),
    "d11 [su^2 per tu]": ("Cell", "tissue/d11"),
    "d22 [su^2 per tu]": ("Cell", "tissue/d22"),
    "fibre": ("Cell", "tissue/fibre"),
}
"""What both files show, and where it is."""
FRAME, TIME, VIEW = "\ue000", "\ue001", "\ue002"
"""Stand for what differs from frame to frame: private characters, which no name has."""
KINDS = {"f": "Float", "i": "Int", "u": "UInt"}


def write_xdmf(recording: Path, *, synced: bool = True) -> tuple[Path, ...]:
    """Write the XDMF files of a recording beside it.

    Parameters
    ----------
    recording : Path
        The HDF5 file, ``<name>.h5``.
    synced : bool
        Whether the files are on the disk at the end (``whole_file``).

    Returns
    -------
    tuple of Path
        ``<name>.xdmf`` with the frames as a time series (if there are any) and
        ``<name>_maps.xdmf`` with the activation maps alone; both hold mesh, patches, diffusivity.

    Raises
    ------
    InputError
        The folder cannot be written to, or the disk is full.
    """
    written = []
    with h5py.File(recording, "r") as file:
        times = file["frames/times"][()]
        if len(times):
            series = recording.with_suffix(".xdmf")
            _save(series, _series(file, recording.name, times), synced=synced)
            written.append(series)
        maps = recording.with_name(f"{recording.stem}_maps.xdmf")
        _save(maps, [_text(_grid(file, recording.name, "maps"), level=2)], synced=synced)
        written.append(maps)
    return tuple(written)


def _save(path: Path, grids: Iterable[str], *, synced: bool) -> None:
    """Write the file around the text of its grids."""
    with (
        whole_file(path, synced=synced) as partial,
        partial.open("w", encoding="utf-8") as file,
    ):
        file.write("<?xml version='1.0' encoding='utf-8'?>\n")
        file.write('<Xdmf Version="3.0">\n  <Domain>\n')
        file.writelines(grids)
        file.write("  </Domain>\n</Xdmf>")


def _text(grid: ET.Element, level: int) -> str:
    """Return an element as lines of text, indented to ``level``."""
    ET.indent(grid, level=level)
    return f"{'  ' * level}{ET.tostring(grid, encoding='unicode')}\n"


def _series(file: h5py.File, source: str, times: Sequence[float]) -> Iterator[str]:
    """Yield the text of a grid for each frame.

    All frames show the same mesh and maps, so one is built and the others are copies of its text
    with another number, time and view.
    """
    grid = _grid(file, source, f"frame {FRAME}")
    ET.SubElement(grid, "Time", Value=TIME)
    for name in FRAMES:
        item = _item(file[name], source, view_of(name, VIEW), file[name].shape[1:])
        _attribute(grid, name[-1], "Node", item)
    one = _text(grid, level=3)
    yield '    <Grid Name="frames" GridType="Collection" CollectionType="Temporal">\n'
    # cut once at all places where frames differ
    pieces = re.split(f"([{FRAME}{TIME}{VIEW}])", one)
    for index, time in enumerate(times):
        words = {FRAME: str(index), TIME: repr(float(time)), VIEW: numbered(index)}
        yield "".join([words.get(piece, piece) for piece in pieces])
    yield "    </Grid>\n"


def _grid(file: h5py.File, source: str, name: str) -> ET.Element:
    """Return the mesh with all maps on it."""
    grid = ET.Element("Grid", Name=name, GridType="Uniform")
    triangles, points = file["mesh/triangles"], file["mesh/points"]
    count = str(len(triangles))
    topology = ET.SubElement(grid, "Topology", TopologyType="Triangle", NumberOfElements=count)
    topology.append(_item(triangles, source, "mesh/triangles", triangles.shape))
    geometry = ET.SubElement(grid, "Geometry", GeometryType="XYZ")
    geometry.append(_item(points, source, "mesh/points", points.shape))
    for label, (centre, name_of_map) in MAPS.items():
        stored = file[name_of_map]
        _attribute(grid, label, centre, _item(stored, source, name_of_map, stored.shape))
    return grid


def _attribute(grid: ET.Element, name: str, centre: str, item: ET.Element) -> None:
    # one number a node or triangle, or three
    kind = "Vector" if " " in item.attrib["Dimensions"] else "Scalar"
    ET.SubElement(grid, "Attribute", Name=name, AttributeType=kind, Center=centre).append(item)


def _item(stored: h5py.Dataset, source: str, name: str, shape: tuple[int, ...]) -> ET.Element:
    """Return the reference to a dataset ``name`` of this shape, of the same type as ``stored``."""
    item = ET.Element(
        "DataItem",
        DataType=KINDS[stored.dtype.kind],
        Precision=str(stored.dtype.itemsize),
        Dimensions=" ".join(str(length) for length in shape),
        Format="HDF",
    )
    item.text = f"{source}:/{name}"
    return item
