"""The frames in a recording's file: two large datasets, and a view of each frame for XDMF."""

import h5py
import numpy as np
from h5py import h5d, h5p, h5s, h5t
from numpy.typing import NDArray

from cardiosurf.recording.signals import HeldSignals

FRAMES = ("frames/u", "frames/v")
SLAB = 2**24
"""Frames are copied in slabs of so many bytes: they may be in a file larger than memory."""


def view_of(name: str, number: str) -> str:
    """Return the view of a frame of one of ``FRAMES``; ``number`` as ``numbered`` gives it."""
    return f"frames/by_time/{name[-1]}_{number}"


def numbered(index: int) -> str:
    """Return a frame's number as it stands in the name of its view."""
    return f"{index:05d}"


def write_frames(
    file: h5py.File, name: str, frames: NDArray[np.float32], held: HeldSignals
) -> h5py.Dataset:
    """Write frames (k, n), uncompressed: gzip takes 15 times as long and saves a quarter.

    Parameters
    ----------
    file : h5py.File
        The recording.
    name : str
        One of ``FRAMES``.
    frames : (k, n) float32
        Possibly still in a file.
    held : HeldSignals
        Heeded between two slabs.
    """
    dataset = file.create_dataset(name, shape=frames.shape, dtype=np.float32)
    rows = max(1, SLAB // max(1, 4 * frames.shape[1]))
    for first in range(0, len(frames), rows):
        held.heed()
        dataset[first : first + rows] = frames[first : first + rows]
    return dataset


def write_views(file: h5py.File, held: HeldSignals) -> None:
    """Give each frame a dataset of its own without storing it twice (XDMF refers to these).

    It goes through h5py's lower level, eight times faster than a ``VirtualLayout`` a frame.

    Parameters
    ----------
    file : h5py.File
        The recording, with its frames.
    held : HeldSignals
        Heeded between two views.
    """
    links = h5p.create(h5p.LINK_CREATE)
    links.set_create_intermediate_group(True)
    for name in FRAMES:
        count, nodes = file[name].shape
        whole, one = h5s.create_simple((count, nodes)), h5s.create_simple((nodes,))
        for index in range(count):
            held.heed()
            whole.select_hyperslab((index, 0), (1, nodes))
            source = h5p.create(h5p.DATASET_CREATE)
            source.set_virtual(one, b".", f"/{name}".encode(), whole)
            view = view_of(name, numbered(index)).encode()
            h5d.create(file.id, view, h5t.IEEE_F32LE, one, source, links)
