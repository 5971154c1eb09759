"""Kinetics for the compiled loops: the law of a model, chosen by the type of its constants."""

from typing import Any

from numba.extending import overload, register_jitable

from cardiosurf.kinetics import COMPILED

_LAWS = {constants: register_jitable(law) for constants, law in COMPILED.values()}


def rates(constants: Any, u: float, v: float) -> tuple[float, float]:
    """Return f and g of the model that the constants belong to, at one node."""
    f, g = _LAWS[type(constants)](constants, u, v)
    return f, g


@overload(rates)
def _rates(constants: Any, u: Any, v: Any) -> Any:
    """Return what stands for ``rates`` in machine code."""
    law = _LAWS[constants.instance_class]

    def compiled(constants: Any, u: Any, v: Any) -> Any:
        return law(constants, u, v)

    return compiled


def constants_of(kinetics: Any) -> Any:
    """Return the constants of a model as its named tuple, or None for a foreign model."""
    if type(kinetics) not in COMPILED:
        return None
    constants, _ = COMPILED[type(kinetics)]
    return constants(**{name: float(getattr(kinetics, name)) for name in constants._fields})
