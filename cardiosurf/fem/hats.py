"""Hat functions as our forms need them: scikit-fem hands a form much that ours do not ask for."""

from typing import Any

from skfem import CellBasis, ElementTriP1
from skfem.element import DiscreteField
from skfem.mapping import Mapping

from cardiosurf.arrays import Floats, Ints


class HatValues(ElementTriP1):  # type: ignore[misc]  # scikit-fem carries no types
    """Linear elements without gradients, for forms of values alone."""

    def gbasis(
        self, mapping: Mapping, X: Floats, i: int, tind: Ints | None = None
    ) -> tuple[DiscreteField]:
        """Return hat function i at the reference points X (2, q), as (1, q): on all triangles."""
        value, _ = self.lbasis(X, i)
        return (DiscreteField(value=value[None]),)


class Hats(CellBasis):  # type: ignore[misc]
    """A basis whose forms are told neither the places of quadrature points nor mesh sizes."""

    def default_parameters(self) -> dict[str, Any]:
        """Return nothing."""
        return {}
