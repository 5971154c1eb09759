"""Which vertices and triangles meet: sorted by counting, as vertex numbers are small."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.arrays import Ints

_BITS = 16


def counting_order(numbers: Ints) -> Ints:
    """Return the order that sorts numbers from 0 to 2**32 - 1; equal ones stay as they are.

    numpy sorts 16-bit numbers by counting, several times faster than longer ones by comparison.
    """
    order = np.argsort(numbers.astype(np.uint16), kind="stable")
    if numbers.max(initial=0) >> _BITS:
        high = (numbers[order] >> _BITS).astype(np.uint16)
        order = order[np.argsort(high, kind="stable")]
    return order


@dataclass(frozen=True)
class Lists:
    """A list of numbers for each vertex.

    Attributes
    ----------
    items : (k,) int
        The lists, one vertex after another.
    starts, counts : (n,) int
        Where the list of each vertex begins, and how long it is.
    """

    items: Ints
    starts: Ints
    counts: Ints

    @classmethod
    def of(cls, vertices: Ints, items: Ints, count: int) -> "Lists":
        """Return the items by their vertices, (k,), which are sorted; ``count`` is n."""
        counts = np.bincount(vertices, minlength=count)
        return cls(items, np.cumsum(counts) - counts, counts)

    def at(self, vertices: Ints) -> tuple[Ints, Ints]:
        """Return the items of some vertices, and of each the place of its vertex among these."""
        counts = self.counts[vertices]
        shift = self.starts[vertices] - np.cumsum(counts) + counts
        owner = np.repeat(np.arange(len(vertices)), counts)
        return self.items[np.arange(len(owner)) + shift[owner]], owner


def triangles_around(triangles: Ints, count: int) -> Lists:
    """Return the triangles at each of ``count`` vertices."""
    corners = triangles.ravel()
    order = counting_order(corners)
    return Lists.of(corners[order], order // 3, count)


def neighbours(triangles: Ints, count: int) -> Lists:
    """Return the neighbours of each of ``count`` vertices, in the order of their numbers."""
    start = triangles[:, [0, 1, 2, 1, 2, 0]].ravel()
    end = triangles[:, [1, 2, 0, 0, 1, 2]].ravel()
    order = counting_order(end)
    order = order[counting_order(start[order])]
    start, end = start[order], end[order]
    # an edge of two triangles was met twice
    first = np.ones(len(start), dtype=np.bool_)
    first[1:] = (start[1:] != start[:-1]) | (end[1:] != end[:-1])
    return Lists.of(start[first], end[first], count)


def pieces(triangles: Ints, count: int) -> Ints:
    """Return for each of ``count`` vertices the lowest number in its connected piece, (n,)."""
    lowest = np.arange(count)
    while True:
        corners = lowest[triangles]
        least = corners.min(axis=1)
        apart = (corners != least[:, None]).any(axis=1)
        if not apart.any():
            return lowest
        # the names of pieces that meet give way to the lower one, and so do all who bear them
        np.minimum.at(lowest, corners[apart].ravel(), np.repeat(least[apart], 3))
        while not np.array_equal(further := lowest[lowest], lowest):
            lowest = further
