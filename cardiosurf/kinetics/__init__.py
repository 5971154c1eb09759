"""Reaction kinetics: one file a model, each a frozen dataclass with its constants and ``rates``.

A model's equations are written once, as a plain function ``law(c, u, v)`` of its constants, which
serves arrays (``rates``) and the compiled march, which takes one node at a time (``COMPILED``).
"""

from collections.abc import Callable
from typing import Any, Protocol, TypeAlias

from cardiosurf.arrays import Floats
from cardiosurf.kinetics import fitzhugh_nagumo, rogers_mcculloch
from cardiosurf.kinetics.fitzhugh_nagumo import FitzHughNagumo
from cardiosurf.kinetics.rogers_mcculloch import RogersMcCulloch


class Kinetics(Protocol):
    """What the time loop needs of a model: the rates of the potential u and the recovery v."""

    def rates(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Return the reaction terms (f, g) of u and v, each (n,), in 1/tu."""
        ...


AnyKinetics: TypeAlias = RogersMcCulloch | FitzHughNagumo

KINETICS: dict[str, type[AnyKinetics]] = {
    "rogers_mcculloch": RogersMcCulloch,
    "fitzhugh_nagumo": FitzHughNagumo,
}

COMPILED: dict[type[Any], tuple[type[Any], Callable[..., Any]]] = {
    RogersMcCulloch: (rogers_mcculloch.RogersMcCullochConstants, rogers_mcculloch.law),
    FitzHughNagumo: (fitzhugh_nagumo.FitzHughNagumoConstants, fitzhugh_nagumo.law),
}
"""For each model that the compiled march knows: a named tuple of its constants, and its law.

numba tells the tuples apart by their names, so no two may have the same.
"""
