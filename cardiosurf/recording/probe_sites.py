"""Where on the surface the probes of a config are."""

from collections.abc import Sequence

import numpy as np

from cardiosurf.errors import InputError
from cardiosurf.geometry.nearest import nearest_point
from cardiosurf.geometry.surface import Surface
from cardiosurf.recording.observers import Probes
from cardiosurf.recording.sections import ProbeSection

FARTHEST = 10.0
"""A probe farther from the surface than this, in su, is taken for a mistake."""


def place_probes(surface: Surface, sections: Sequence[ProbeSection]) -> Probes:
    """Return the observer that records at the surface points nearest to the probes.

    Parameters
    ----------
    surface : Surface
        The triangulated surface.
    sections : sequence of ProbeSection
        The config's probes.

    Raises
    ------
    InputError
        A probe lies farther than 10 su from the surface, or two have the same name.
    """
    names = tuple(section.name for section in sections)
    sites = []
    for number, section in enumerate(sections):
        where = f"record.probes.{section.name}"
        if section.name in names[:number]:
            raise InputError(where, "another probe has this name", hint="give each its own name")
        site = nearest_point(surface, np.array(section.at))
        if site.distance > FARTHEST:
            raise InputError(
                where=f"{where}.at",
                problem=f"{list(section.at)} is {site.distance:.4g} su away from the surface",
                allowed=f"a point within {FARTHEST:g} su of the surface",
                hint=f"the nearest point is {[round(float(x), 3) for x in site.point]}",
            )
        sites.append(site)
    return Probes(
        names,
        np.array([site.point for site in sites]).reshape(-1, 3),
        np.array([surface.triangles[site.triangle] for site in sites], dtype=np.int64).reshape(
            -1, 3
        ),
        np.array([site.weights for site in sites]).reshape(-1, 3),
    )
