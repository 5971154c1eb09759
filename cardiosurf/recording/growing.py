"""Tables that grow a row, or a block of rows, at a time."""

import numpy as np

from cardiosurf.arrays import Floats

FIRST_ROWS = 1024


class GrowingTable:
    """Rows of float64 numbers, in memory that doubles when it is full.

    Parameters
    ----------
    width : int
        Numbers in a row.
    """

    def __init__(self, width: int) -> None:
        self._rows: Floats = np.empty((FIRST_ROWS, width))
        self._count = 0

    def __len__(self) -> int:
        """Return the number of rows."""
        return self._count

    def append(self, block: Floats) -> None:
        """Add one row (width,) or a block of rows (k, width)."""
        block = np.atleast_2d(block)
        end = self._count + len(block)
        if end > len(self._rows):
            larger = np.empty((max(2 * len(self._rows), end), self._rows.shape[1]))
            larger[: self._count] = self._rows[: self._count]
            self._rows = larger
        self._rows[self._count : end] = block
        self._count = end

    def rows(self) -> Floats:
        """Return a copy of the rows, (count, width)."""
        return self._rows[: self._count].copy()

    def replace(self, rows: Floats) -> None:
        """Forget all rows and take these, (k, width), instead."""
        self._count = 0
        self.append(rows)
