"""The rule behind ``step: auto``: the largest step whose LAT error stays in its share."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.errors import InputError, NumericalError
from cardiosurf.kinetics import Kinetics
from cardiosurf.stepping.schemes import Scheme
from cardiosurf.stepping.stability import largest_stable

ACCURACY = 0.005
"""Relative LAT error that a run stays below unless it is told otherwise."""

SHARE = 0.5
"""The part of the accuracy that is left to the time step; the rest is the mesh's."""

# relative error of LAT = C (rate * dt)^order: the largest C measured on planar waves of different
# kinetics (docs/numerics.md); recovery makes it smaller, so it is that of the bistable front
ERROR_COEFFICIENTS = {"imex_euler": 0.115, "cnab2": 0.0137, "sbdf2": 0.0285}

# steps that are easily read, no two neighbours further apart than a third
TIDY_STEPS = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)


@dataclass(frozen=True)
class StepChoice:
    """A step, and why it was taken.

    Attributes
    ----------
    step : float
        In tu.
    reason : str
        One line for the record.
    lat_error : float
        Relative LAT error of a planar wave that the rule expects; NaN for a foreign scheme.
    """

    step: float
    reason: str
    lat_error: float = float("nan")


def reaction_rate(kinetics: Kinetics) -> float:
    """Return the fastest rate of the reaction, in 1/tu: max |df/du|, |dg/dv| at v = 0, 0 <= u <= 1.

    For the shipped models it is c1 (1 - a), at u = 1.
    """
    u, v, shift = np.linspace(0.0, 1.0, 201), np.zeros(201), 1e-6
    of_u = kinetics.rates(u + shift, v)[0] - kinetics.rates(u - shift, v)[0]
    of_v = kinetics.rates(u, v + shift)[1] - kinetics.rates(u, v - shift)[1]
    return float(max(np.abs(of_u).max(), np.abs(of_v).max()) / (2.0 * shift))


def auto_step(scheme: Scheme, kinetics: Kinetics, accuracy: float = ACCURACY) -> StepChoice:
    """Return the largest tidy step with C (rate dt)^order <= 0.5 accuracy.

    C is the measured coefficient of the scheme (docs/numerics.md), rate that of the reaction.

    Parameters
    ----------
    scheme : Scheme
        The time integration.
    kinetics : Kinetics
        The reaction.
    accuracy : float
        Relative LAT error that the run is to stay below.

    Raises
    ------
    InputError
        The scheme has no measured coefficient.
    """
    if scheme.name not in ERROR_COEFFICIENTS:
        raise InputError(
            "time.step",
            f"auto is not known for the scheme {scheme.name}",
            f"auto with {', '.join(ERROR_COEFFICIENTS)}",
            "a number, in tu",
        )
    rate = reaction_rate(kinetics)
    coefficient = ERROR_COEFFICIENTS[scheme.name]
    largest = (SHARE * accuracy / coefficient) ** (1.0 / scheme.order) / rate
    decade = 10.0 ** np.floor(np.log10(largest))
    step = float(f"{max(t for t in TIDY_STEPS if t * decade <= largest) * decade:g}")
    error = expected_lat_error(scheme, kinetics, step)
    return StepChoice(
        step,
        f"{scheme.name} at a reaction rate of {rate:.3g}/tu: "
        f"LAT error {error:.2%}, at most {SHARE * accuracy:.2%}",
        error,
    )


def expected_lat_error(scheme: Scheme, kinetics: Kinetics, step: float) -> float:
    """Return the relative LAT error of a planar wave, C (rate dt)^order; NaN for unknown C.

    Parameters
    ----------
    scheme : Scheme
        The time integration.
    kinetics : Kinetics
        The reaction.
    step : float
        In tu.
    """
    coefficient = ERROR_COEFFICIENTS.get(scheme.name, float("nan"))
    return float(coefficient * (reaction_rate(kinetics) * step) ** scheme.order)


def asked_step(scheme: Scheme, kinetics: Kinetics, step: float) -> StepChoice:
    """Return a step that the user asks for, with the error to expect of it.

    Parameters
    ----------
    scheme : Scheme
        The time integration.
    kinetics : Kinetics
        The reaction.
    step : float
        In tu.

    Raises
    ------
    NumericalError
        The explicit reaction is unstable at this step. Such a run need not blow up: it may as
        well die at once, and look like a stimulus that does not capture.
    """
    largest = largest_stable(scheme) / reaction_rate(kinetics)
    if step > largest:
        raise NumericalError(
            f"the reaction is unstable at step 1, t = {step:g} tu: a step of {step:g} tu is longer"
            f" than the {largest:.3g} tu up to which {scheme.name} is stable",
            "time.step: auto",
        )
    error = expected_lat_error(scheme, kinetics, step)
    return StepChoice(step, f"asked for: LAT error {error:.2%}", error)
