"""IMEX multistep schemes, each one written as its coefficients, its order and its source."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Scheme:
    """A multistep scheme that takes diffusion implicitly and the reaction explicitly.

    With step dt, state w_k, diffusion L and reaction F, a step solves

        sum_j a_j w_(k+1-j) / dt = sum_j b_j L w_(k+1-j) + sum_j c_j F(w_(k-j)),   j = 0, 1, ...

    Attributes
    ----------
    name : str
        Name in the config.
    order : int
        Order of accuracy in time, the starting step included.
    state : tuple of float
        a_j, of the states at the new time and backwards.
    implicit : tuple of float
        b_j, of the diffusion at the new time and backwards.
    explicit : tuple of float
        c_j, of the reaction at the present time and backwards.
    citation : str
        Where it comes from.
    """

    name: str
    order: int
    state: tuple[float, ...]
    implicit: tuple[float, ...]
    explicit: tuple[float, ...]
    citation: str

    @property
    def depth(self) -> int:
        """How many past states a step needs."""
        return max(len(self.state) - 1, len(self.implicit) - 1, len(self.explicit))


_ASCHER = "Ascher, Ruuth and Wetton, SIAM J Numer Anal 32:797 (1995)"

SCHEMES: dict[str, Scheme] = {
    scheme.name: scheme
    for scheme in (
        Scheme("imex_euler", 1, (1.0, -1.0), (1.0,), (1.0,), _ASCHER),
        Scheme("cnab2", 2, (1.0, -1.0), (0.5, 0.5), (1.5, -0.5), _ASCHER),
        Scheme("sbdf2", 2, (1.5, -2.0, 0.5), (1.0,), (2.0, -1.0), _ASCHER),
    )
}
