"""Reaction kinetics: one file a model, each a frozen dataclass with its constants and ``rates``."""

from typing import Protocol, TypeAlias

from cardiosurf.arrays import Floats
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
