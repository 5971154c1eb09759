"""The step of a run, before anything is built."""

from cardiosurf.config import Config
from cardiosurf.stepping.schemes import SCHEMES
from cardiosurf.stepping.step_rule import auto_step


def step_of(config: Config) -> float:
    """Return the longest step of a config in tu, ``auto`` resolved; it does not depend on the mesh.

    Parameters
    ----------
    config : Config
        A decoded config.

    Raises
    ------
    InputError
        If ``auto`` is not known for the scheme.
    """
    step = config.time.step
    if step != "auto":
        return step
    return auto_step(SCHEMES[config.time.scheme], config.kinetics, config.accuracy).step
