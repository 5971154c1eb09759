"""XDMF files beside a recording: ParaView and meshio open mesh, frames and maps through them.

They hold no numbers, only references into the HDF5 file by its bare name, so the folder can be
moved. Each frame is a dataset of its own (a view), because not every reader knows hyperslabs.
"""

from pathlib import Path
from xml.etree import ElementTree as ET

import h5py

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
}
"""What both files show, and where it is."""
KINDS = {"f": "Float", "i": "Int", "u": "UInt"}


def write_xdmf(recording: Path) -> tuple[Path, ...]:
    """Write the XDMF files of a recording beside it.

    Parameters
    ----------
    recording : Path
        The HDF5 file, ``<name>.h5``.

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
            _save(series, _series(file, recording.name, times))
            written.append(series)
        maps = recording.with_name(f"{recording.stem}_maps.xdmf")
        grid = _grid(file, recording.name, "maps")
        _save(maps, grid)
        written.append(maps)
    return tuple(written)


def _save(path: Path, grid: ET.Element) -> None:
    root = ET.Element("Xdmf", Version="3.0")
    ET.SubElement(root, "Domain").append(grid)
    ET.indent(root)
    with whole_file(path) as partial:
        ET.ElementTree(root).write(partial, encoding="utf-8", xml_declaration=True)


def _series(file: h5py.File, source: str, times: list[float]) -> ET.Element:
    collection = ET.Element("Grid", Name="frames", GridType="Collection", CollectionType="Temporal")
    for index, time in enumerate(times):
        grid = _grid(file, source, f"frame {index}")
        ET.SubElement(grid, "Time", Value=repr(float(time)))
        for variable in ("u", "v"):
            view = f"frames/by_time/{variable}_{index:05d}"
            _attribute(grid, variable, "Node", _item(file, source, view))
        collection.append(grid)
    return collection


def _grid(file: h5py.File, source: str, name: str) -> ET.Element:
    """Return the mesh with all maps on it."""
    grid = ET.Element("Grid", Name=name, GridType="Uniform")
    triangles, points = "mesh/triangles", "mesh/points"
    count = str(len(file[triangles]))
    topology = ET.SubElement(grid, "Topology", TopologyType="Triangle", NumberOfElements=count)
    topology.append(_item(file, source, triangles))
    ET.SubElement(grid, "Geometry", GeometryType="XYZ").append(_item(file, source, points))
    for label, (centre, dataset) in MAPS.items():
        _attribute(grid, label, centre, _item(file, source, dataset))
    return grid


def _attribute(grid: ET.Element, name: str, centre: str, item: ET.Element) -> None:
    ET.SubElement(grid, "Attribute", Name=name, AttributeType="Scalar", Center=centre).append(item)


def _item(file: h5py.File, source: str, dataset: str) -> ET.Element:
    """Return the reference to a dataset."""
    stored = file[dataset]
    item = ET.Element(
        "DataItem",
        DataType=KINDS[stored.dtype.kind],
        Precision=str(stored.dtype.itemsize),
        Dimensions=" ".join(str(length) for length in stored.shape),
        Format="HDF",
    )
    item.text = f"{source}:/{dataset}"
    return item
