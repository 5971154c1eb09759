"""Recordings as HDF5 files: written whole, readable by hand, checked when they are read."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.errors import InputError
from cardiosurf.geometry.surface import Surface
from cardiosurf.recording.frame_sets import FRAMES, write_frames, write_views
from cardiosurf.recording.layout import DATASETS, SCHEMA
from cardiosurf.recording.lengths import check_lengths
from cardiosurf.recording.meta import describe, read_meta, write_meta
from cardiosurf.recording.recording import (
    Events,
    FrameSeries,
    ProbeTraces,
    Recording,
)
from cardiosurf.recording.signals import HeldSignals, held_signals
from cardiosurf.recording.steady_file import SteadyFile
from cardiosurf.recording.whole_file import whole_file
from cardiosurf.tissue.stimuli import Pulse
from cardiosurf.tissue.tensor import Tissue, main_directions

SMALL = 256
"""Arrays of fewer numbers are not worth compressing."""
COMPRESSION = {"compression": "gzip", "compression_opts": 1, "shuffle": True}


def write_recording(path: Path, recording: Recording, *, synced: bool = True) -> None:
    """Write a recording; the file appears complete or not at all.

    Ctrl-C and SIGTERM wait until HDF5 can be left: between two datasets, or two slabs of frames.

    Parameters
    ----------
    path : Path
        The file, usually ``recording.h5``; one that is there already is replaced.
    recording : Recording
        What to write.
    synced : bool
        Whether the file is on the disk at the end (``whole_file``).

    Raises
    ------
    InputError
        The folder cannot be written to, or the disk is full.
    KeyboardInterrupt
        A signal came; the file is complete or not there.
    """
    with (
        held_signals() as held,
        whole_file(path, synced=synced) as partial,
        SteadyFile(partial) as steady,
        h5py.File(steady, "w") as file,
    ):
        for name, value in _values(recording).items():
            held.heed()
            _write(file, name, value, held)
        write_views(file, held)
        file["config/text"].attrs["sha256"] = recording.config_sha256
        write_meta(file.create_group("meta"), recording.meta)
        file.attrs["schema"] = SCHEMA
        file.attrs["name"] = recording.name
        file.attrs["end_time"] = recording.end_time
        file.attrs["stop_reason"] = recording.stop_reason
        since = recording.quiescent_at
        file.attrs["quiescent_at"] = np.nan if since is None else since
        file.attrs["complete"] = True


def read_recording(path: Path, *, with_frames: bool = True) -> Recording:
    """Read a recording.

    Parameters
    ----------
    path : Path
        A file that ``write_recording`` wrote.
    with_frames : bool
        Whether the frames are there too; they are most of the file, and read from it as they are
        used.

    Raises
    ------
    InputError
        No such file, not an HDF5 file, another schema, not complete, or something missing.
    """
    if not path.is_file():
        raise InputError(str(path), "no such file", "a recording.h5 that a run wrote")
    try:
        with h5py.File(path, "r") as file:
            _check(path, file)
            recording = _read(file, with_frames=with_frames)
            check_lengths(recording)
            return recording
    except KeyError as error:
        raise InputError(
            where=str(path),
            problem=f"the recording lacks something: {error.args[0]}",
            allowed="a recording as a run wrote it",
            hint="run the config again",
        ) from error
    # what h5py and numpy raise on a file that is cut, changed or of another kind; a ValueError may
    # be a text that is not UTF-8, a MemoryError a length that is not true
    except (
        OSError,
        TypeError,
        ValueError,
        RuntimeError,
        IndexError,
        AttributeError,
        OverflowError,
        MemoryError,
    ) as error:
        raise InputError(
            where=str(path),
            problem=f"cannot be read as HDF5: {error}",
            allowed="a recording.h5 that a run wrote",
            hint="if a run wrote it, it is damaged: run the config again",
        ) from error


def _values(recording: Recording) -> Mapping[str, ArrayLike]:
    """Return what goes into each dataset of the layout."""
    surface, tissue, pulses = recording.surface, recording.tissue, recording.pulses
    frames, probes = recording.frames, recording.probes
    edges = list(surface.edges.values())
    d11, d22 = np.einsum("mai,mai->am", surface.frame @ tissue.tensor, surface.frame)
    return {
        "mesh/points": surface.points,
        "mesh/triangles": surface.triangles,
        "mesh/parts": surface.parts,
        "mesh/part_of": surface.part_of,
        "mesh/axes": surface.axes,
        "mesh/frame": surface.frame,
        "mesh/net": surface.net,
        "mesh/edge_names": tuple(surface.edges),
        "mesh/edge_vertices": np.concatenate([np.zeros((0, 2), dtype=np.int64), *edges]),
        "mesh/edge_of": np.repeat(np.arange(len(edges)), [len(edge) for edge in edges]),
        "mesh/region_names": tuple(surface.regions),
        "mesh/region_triangles": _stack(surface.regions, len(surface.triangles)),
        "tissue/tensor": tissue.tensor,
        "tissue/d11": d11,
        "tissue/d22": d22,
        "tissue/fibre": main_directions(surface, tissue.tensor),
        "tissue/excitable": tissue.excitable.astype(np.int64),
        "tissue/names": tissue.names,
        "tissue/patch_of": tissue.patch_of,
        "targets/names": tuple(recording.targets),
        "targets/triangles": _stack(recording.targets, len(surface.triangles)),
        "pulses/times": [pulse.time for pulse in pulses],
        "pulses/durations": [pulse.duration for pulse in pulses],
        "pulses/labels": tuple(pulse.label for pulse in pulses),
        "pulses/profiles": np.array([pulse.profile for pulse in pulses]).reshape(
            -1, recording.node_count
        ),
        "activation/nodes": recording.activations.nodes,
        "activation/times": recording.activations.times,
        "activation/first": recording.first_activation,
        "activation/last": recording.last_activation,
        "activation/count": recording.activation_count,
        "repolarisation/nodes": recording.repolarisations.nodes,
        "repolarisation/times": recording.repolarisations.times,
        "repolarisation/first": recording.first_repolarisation,
        "frames/times": frames.times,
        "frames/u": frames.u,
        "frames/v": frames.v,
        "probes/names": probes.names,
        "probes/positions": probes.positions,
        "probes/times": probes.times,
        "probes/u": probes.u,
        "probes/v": probes.v,
        "config/text": recording.config,
    }


def _stack(masks: Mapping[str, Mask], length: int) -> NDArray[np.uint8]:
    """Return masks (m,) as the rows of one array of 0 and 1."""
    rows = [mask.astype(np.uint8) for mask in masks.values()]
    return np.array(rows, dtype=np.uint8).reshape(-1, length)


def _write(file: h5py.File, name: str, value: ArrayLike, held: HeldSignals) -> None:
    """Write one dataset of the layout, compressed when that is worth it."""
    entry = DATASETS[name]
    if isinstance(value, str):
        dataset = file.create_dataset(name, data=value)
    elif isinstance(value, tuple):
        text = np.array(value, dtype=object)
        dataset = file.create_dataset(name, data=text, dtype=h5py.string_dtype())
    elif name in FRAMES:
        dataset = write_frames(file, name, np.asanyarray(value), held)
    else:
        data = np.asarray(value)
        options = COMPRESSION if entry.packed and data.size > SMALL else {}
        dataset = file.create_dataset(name, data=data, **options)
    describe(dataset, entry.units, entry.description)


def _check(path: Path, file: h5py.File) -> None:
    """Refuse what is no complete recording of this schema."""
    schema = file.attrs.get("schema")
    if schema != SCHEMA:
        problem = "no recording of cardiosurf" if schema is None else f"has the schema {schema!r}"
        raise InputError(str(path), problem, f"schema {SCHEMA!r}", "run the config again")
    if not file.attrs.get("complete", False):
        raise InputError(str(path), "is not complete", hint="run the config again")


def _read(file: h5py.File, *, with_frames: bool) -> Recording:
    surface, tissue = _read_surface(file), _read_tissue(file)
    nodes = len(surface.points)
    return Recording(
        name=str(file.attrs["name"]),
        surface=surface,
        tissue=tissue,
        targets=_masks(_text(file, "targets/names"), file["targets/triangles"][()]),
        pulses=_read_pulses(file),
        activations=_read_events(file, "activation"),
        repolarisations=_read_events(file, "repolarisation"),
        frames=_read_frames(file) if with_frames else FrameSeries.none(nodes),
        probes=ProbeTraces(
            names=_text(file, "probes/names"),
            positions=file["probes/positions"][()],
            times=file["probes/times"][()],
            u=file["probes/u"][()],
            v=file["probes/v"][()],
        ),
        end_time=float(file.attrs["end_time"]),
        stop_reason=str(file.attrs["stop_reason"]),
        config=str(file["config/text"].asstr()[()]),
        config_sha256=str(file["config/text"].attrs["sha256"]),
        meta=read_meta(file["meta"]),
        quiescent_at=_read_quiescence(file),
    )


def _read_quiescence(file: h5py.File) -> float | None:
    # older recordings lack it; one that stopped at rest began to rest there
    at_rest = file.attrs["stop_reason"] == "rest"
    since = float(file.attrs.get("quiescent_at", file.attrs["end_time"] if at_rest else np.nan))
    return None if np.isnan(since) else since


def _text(file: h5py.File, name: str) -> tuple[str, ...]:
    return tuple(file[name].asstr()[()])


def _masks(names: Sequence[str], rows: NDArray[np.uint8]) -> Mapping[str, Mask]:
    return {name: row.astype(np.bool_) for name, row in zip(names, rows, strict=True)}


def _read_surface(file: h5py.File) -> Surface:
    edge_of: Ints = file["mesh/edge_of"][()]
    edges: Ints = file["mesh/edge_vertices"][()]
    return Surface(
        points=file["mesh/points"][()],
        triangles=file["mesh/triangles"][()],
        parts=_text(file, "mesh/parts"),
        part_of=file["mesh/part_of"][()],
        axes=tuple((str(a), str(b)) for a, b in file["mesh/axes"].asstr()[()]),
        frame=file["mesh/frame"][()],
        net=file["mesh/net"][()],
        edges={
            name: edges[edge_of == index]
            for index, name in enumerate(_text(file, "mesh/edge_names"))
        },
        regions=_masks(_text(file, "mesh/region_names"), file["mesh/region_triangles"][()]),
    )


def _read_tissue(file: h5py.File) -> Tissue:
    return Tissue(
        tensor=file["tissue/tensor"][()],
        excitable=file["tissue/excitable"][()].astype(np.bool_),
        names=_text(file, "tissue/names"),
        patch_of=file["tissue/patch_of"][()],
    )


def _read_events(file: h5py.File, group: str) -> Events:
    return Events(nodes=file[f"{group}/nodes"][()], times=file[f"{group}/times"][()])


def _read_frames(file: h5py.File) -> FrameSeries:
    times: Floats = file["frames/times"][()]
    return FrameSeries(times=times, u=_mapped(file["frames/u"]), v=_mapped(file["frames/v"]))


def _mapped(dataset: h5py.Dataset) -> NDArray[np.float32]:
    """Return a dataset, left in the file where it lies there in one piece: it may exceed memory."""
    offset = dataset.id.get_offset()
    if offset is None:
        whole: NDArray[np.float32] = dataset[()]
        return whole
    return np.memmap(dataset.file.filename, dataset.dtype, "r", offset, dataset.shape)


def _read_pulses(file: h5py.File) -> tuple[Pulse, ...]:
    columns = zip(
        file["pulses/times"][()],
        file["pulses/durations"][()],
        _text(file, "pulses/labels"),
        file["pulses/profiles"][()],
        strict=True,
    )
    return tuple(
        Pulse(time=float(time), duration=float(duration), label=label, profile=profile)
        for time, duration, label, profile in columns
    )
