"""What is drawn on a map: colours, isochrones, patches, targets, stimulus sites."""

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
import scipy
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Patch as Swatch
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline
from matplotlib.tri import Triangulation

from cardiosurf.arrays import Floats, Mask
from cardiosurf.recording.recording import Recording
from cardiosurf.report.canvas import INK, NEVER, STIMULUS
from cardiosurf.report.views import View, outlines, seen
from cardiosurf.tissue.tensor import main_directions

COLOURS = "viridis"
SPACINGS = (1.0, 2.5, 5.0, 10.0, 25.0, 50.0, 100.0, 250.0, 500.0, 1000.0, 2500.0)
MOST_ISOCHRONES = 14
NAME_SHAPE = np.array([1.5, 0.5])
"""A name is wider than it is high: names above each other may be closer."""
NAME_ROOM = np.array([0.07, 0.035])
"""Half the room that a name takes, in parts of a view's width and height."""
# a plate and no halo: text with a halo is no text any more in an SVG
PLATE = {"boxstyle": "round,pad=0.12", "facecolor": "white", "edgecolor": "none", "alpha": 0.75}

Spots: TypeAlias = dict[str, Floats]
"""Where the names of regions stand on a view."""


def isochrone_levels(lat: Floats) -> Floats:
    """Return the times at which isochrones are drawn: round, evenly spaced, at most 14.

    Parameters
    ----------
    lat : (n,) float
        Local activation times, in tu; NaN = never.
    """
    if not np.isfinite(lat).any():
        return np.zeros(0)
    low, high = float(np.nanmin(lat)), float(np.nanmax(lat))
    fitting = [step for step in SPACINGS if (high - low) / step <= MOST_ISOCHRONES]
    step = fitting[0] if fitting else SPACINGS[-1]
    levels = step * np.arange(np.ceil(low / step), np.floor(high / step) + 1)
    return levels[(levels > low) & (levels < high)]


def draw_never(axes: Axes, view: View, values: Floats) -> Mask:
    """Draw in grey where a field (n,) is NaN; return the view's other triangles, (t,) bool."""
    whole = np.isfinite(values[view.vertex_of])[view.triangles].all(axis=1)
    axes.add_collection(
        PolyCollection(
            view.points[view.triangles[~whole]].tolist(),
            facecolors=NEVER,
            edgecolors=NEVER,
            linewidths=0.5,
            antialiaseds=False,
            rasterized=True,
        )
    )
    return np.asarray(whole)


def draw_field(
    axes: Axes, view: View, values: Floats, norm: Normalize, colours: str = COLOURS
) -> bool:
    """Colour a view by a smooth field (n,); grey where it is NaN. Returns whether any is grey."""
    whole = draw_never(axes, view, values)
    if whole.any():
        axes.tripcolor(
            _triangulation(view, hidden=np.logical_not(whole)),
            np.nan_to_num(values[view.vertex_of]),
            shading="gouraud",
            cmap=colours,
            norm=norm,
            rasterized=True,
        )
    return not bool(whole.all())


def draw_counts(axes: Axes, view: View, counts: Floats, norm: Normalize) -> bool:
    """Colour a view by whole numbers (n,), one a triangle: its corners' median; else as above."""
    whole = draw_never(axes, view, counts)
    if whole.any():
        middle = np.nanmedian(counts[view.vertex_of][view.triangles[whole]], axis=1)
        mesh = Triangulation(view.points[:, 0], view.points[:, 1], view.triangles[whole])
        axes.tripcolor(mesh, facecolors=middle, cmap=COLOURS, norm=norm, rasterized=True)
    return not bool(whole.all())


def draw_isochrones(axes: Axes, view: View, lat: Floats, spots: Spots) -> None:
    """Draw isochrones of a LAT map (n,), in tu, labelled where nothing else is written."""
    known = np.isfinite(lat[view.vertex_of])
    whole = known[view.triangles].all(axis=1)
    levels = isochrone_levels(lat[view.vertex_of])
    if not (whole.any() and len(levels)):
        return
    mesh = _triangulation(view, hidden=np.logical_not(whole))
    filled = np.where(known, lat[view.vertex_of], 0.0)
    lines = axes.tricontour(mesh, filled, levels=levels, colors=INK, linewidths=0.6)
    middle, half = view.limits.mean(axis=1), np.ptp(view.limits, axis=1) / 2
    for text in axes.clabel(lines, fmt="%g", fontsize=6.5, inline=False):
        text.set_bbox(PLATE)
        place = np.asarray(text.get_position())
        outside = bool((np.abs(place - middle) > 0.95 * half).any())
        taken = any((np.abs(place - spot) < 2 * half * NAME_ROOM).all() for spot in spots.values())
        if outside or taken:
            text.remove()


def region_outline(view: View, mask: Mask) -> Outline | None:
    """Return the outline of a region, a mask of the mesh's triangles (m,); None: not in view."""
    loops = outlines(seen(view, mask))
    if not loops:
        return None
    return Outline.make_compound_path(
        *(Outline(view.points[np.append(loop, loop[0])], closed=True) for loop in loops)
    )


def draw_border(axes: Axes, view: View) -> None:
    """Draw the open edges of the surface, and the cut of an unrolled map."""
    outline = region_outline(view, np.ones(int(view.triangle_of.max()) + 1, dtype=np.bool_))
    if outline is not None:
        axes.add_patch(PathPatch(outline, facecolor="none", edgecolor=INK, linewidth=0.8))


def draw_patches(axes: Axes, view: View, recording: Recording, spots: Spots) -> list[Artist]:
    """Hatch and name the patches; return what the legend says about them.

    Those with fibres have strokes (``report.strokes``) instead of a hatching. ``spots`` are the
    places of the names so far; the new ones are added.
    """
    scar = ~recording.tissue.excitable
    directed = np.any(main_directions(recording.surface, recording.tissue.tensor), axis=1)
    entries: list[Artist] = []
    for name, mask in recording.patches.items():
        outline = region_outline(view, mask)
        if outline is None:
            continue
        excitable = not bool(scar[mask].all())
        hatch = "xxxx" if not excitable else "" if directed[mask].mean() > 0.5 else "////"
        axes.add_patch(
            PathPatch(
                outline, hatch=hatch, facecolor="none", edgecolor=INK, linewidth=1.0, alpha=0.55
            )
        )
        _name(axes, view, mask, name, spots)
        kind = "patch" if excitable else "scar"
        entries.append(
            Swatch(hatch=hatch, facecolor="none", edgecolor=INK, label=f"{name} ({kind})")
        )
    return entries


def draw_targets(axes: Axes, view: View, recording: Recording, spots: Spots) -> list[Artist]:
    """Outline and name the targets; return what the legend says about them.

    ``spots`` are the places of the names so far; the new ones are added.
    """
    drawn = False
    for name, mask in recording.targets.items():
        outline = region_outline(view, mask)
        if outline is None:
            continue
        drawn = True
        for colour, width, dashes in (("white", 2.4, "-"), (INK, 1.2, (0, (4, 3)))):
            axes.add_patch(
                PathPatch(
                    outline, facecolor="none", edgecolor=colour, linewidth=width, linestyle=dashes
                )
            )
        _name(axes, view, mask, name, spots)
    line = Line2D([], [], color=INK, linewidth=1.2, linestyle=(0, (4, 3)), label="target")
    return [line] if drawn else []


def draw_stimuli(axes: Axes, view: View, profiles: Sequence[Floats]) -> list[Artist]:
    """Mark where stimuli were given: half of their greatest strength, and their middle."""
    drawn = False
    mesh = _triangulation(view)
    for profile in profiles:
        strength = profile[view.vertex_of] / profile.max()
        if strength.max() < 0.5:
            continue
        drawn = True
        if strength.min() < 0.5:
            axes.tricontour(mesh, strength, levels=[0.5], colors=STIMULUS, linewidths=1.4)
        for middle in middles(view, strength):
            axes.plot(*middle, marker="*", markersize=11, color=STIMULUS, markeredgecolor="white")
    star = Line2D(
        [],
        [],
        marker="*",
        markersize=9,
        color=STIMULUS,
        linewidth=1.4,
        label="stimulus (half strength)",
    )
    return [star] if drawn else []


def middles(view: View, strength: Floats) -> list[Floats]:
    """Return the middle (2,) of each piece of the view where the strength (k,) is above half.

    A stimulus on the seam of an unrolled map lies at both sides of it: the middle of both is
    nowhere near.
    """
    strong = strength >= 0.5
    sides = np.concatenate([view.triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    sides = sides[strong[sides].all(axis=1)]
    shape = (len(strength), len(strength))
    links = scipy.sparse.coo_array((np.ones(len(sides)), (sides[:, 0], sides[:, 1])), shape=shape)
    _, piece = scipy.sparse.csgraph.connected_components(links, directed=False)
    return [
        np.average(view.points[inside], axis=0, weights=strength[inside])
        for inside in (strong & (piece == one) for one in np.unique(piece[strong]))
    ]


def stimulus_profiles(recording: Recording) -> list[Floats]:
    """Return the different profiles among the pulses, in the order they were first given."""
    profiles: list[Floats] = []
    for pulse in recording.pulses:
        known = any(np.array_equal(pulse.profile, profile) for profile in profiles)
        if not known and pulse.profile.max() > 0:
            profiles.append(pulse.profile)
    return profiles


def never_swatch() -> Artist:
    """Return the legend's entry for tissue that was never activated."""
    return Swatch(facecolor=NEVER, edgecolor="none", label="never activated")


def _triangulation(view: View, *, hidden: Mask | None = None) -> Triangulation:
    """Return a view's triangles as matplotlib draws them, without the hidden ones."""
    return Triangulation(view.points[:, 0], view.points[:, 1], view.triangles, hidden)


def _name(axes: Axes, view: View, mask: Mask, name: str, spots: Spots) -> None:
    """Write a region's name where it has most room, unless it stands there already."""
    if name in spots:
        return
    spot = roomiest_spot(view, mask, list(spots.values()))
    spots[name] = spot
    axes.text(
        float(spot[0]),
        float(spot[1]),
        name,
        fontsize=8,
        weight="bold",
        ha="center",
        va="center",
        bbox=PLATE,
    )


def roomiest_spot(view: View, mask: Mask, taken: Sequence[Floats]) -> Floats:
    """Return the point of a region (a triangle's middle) farthest from its edge and from ``taken``.

    Distances are measured in parts of the view's width and height.
    """
    inside = seen(view, mask)
    middles = view.points[inside].mean(axis=1)
    edge = view.points[np.concatenate(outlines(inside))]
    scale = np.ptp(view.limits, axis=1)
    room = [np.asarray(scipy.spatial.cKDTree(edge / scale).query(middles / scale)[0])]
    room += [np.linalg.norm((middles - spot) / (scale * NAME_SHAPE), axis=1) for spot in taken]
    visible = (np.abs(middles - view.limits.mean(axis=1)) < scale / 2).all(axis=1)
    return np.asarray(middles[np.argmax(np.where(visible, np.min(room, axis=0), -1.0))])
