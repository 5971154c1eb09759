"""Compile the march now, so that no run has to: ``python -m cardiosurf.stepping.compiled``.

``make install`` does it. Without it the first run takes some seconds more, once.
"""

import sys

import numpy as np
from scipy.sparse import csr_array, diags_array

from cardiosurf.fem.operators import Operators
from cardiosurf.kinetics.rogers_mcculloch import RogersMcCulloch
from cardiosurf.stepping.compiled.engine import Engine
from cardiosurf.stepping.schemes import SCHEMES


def main() -> int:
    """March a line of ten nodes with the default kinetics."""
    n = 10
    line = diags_array([2.0, -1.0, -1.0], offsets=[0, 1, -1], shape=(n, n))
    mass, stiffness = csr_array(diags_array(np.ones(n))), csr_array(line)
    engine = Engine(
        Operators(mass, mass, stiffness),
        RogersMcCulloch(),
        SCHEMES["sbdf2"],
        tolerance=1e-7,
        watch=np.zeros(0, dtype=np.int64),
        threads=1,
    )
    rest = np.zeros((2, n))
    engine.load((rest, rest))
    engine.go(np.arange(3.0), 1.0, None, pending=False)
    return 0


if __name__ == "__main__":
    sys.exit(main())
