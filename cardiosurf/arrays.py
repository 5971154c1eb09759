"""Names for the arrays that travel between the modules.

Points are (n, 3), triangles (m, 3), tensors (m, 3, 3), the state (2, n): n vertices, m triangles.
"""

from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Floats: TypeAlias = NDArray[np.float64]
Singles: TypeAlias = NDArray[np.float32]
Ints: TypeAlias = NDArray[np.int64]
Mask: TypeAlias = NDArray[np.bool_]
# scipy takes as long to import as all the rest, and most commands meet no matrix
Matrix: TypeAlias = "csr_array[Any, Any]"
