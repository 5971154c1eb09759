"""What the sections say about the surface must be there on it: parts, edges, axes."""

from collections.abc import Iterable, Iterator

from cardiosurf.config.region_paths import leaves, regions_in
from cardiosurf.config.sections import Config
from cardiosurf.errors import InputError
from cardiosurf.geometry.regions import Part, Polar
from cardiosurf.spelling import did_you_mean
from cardiosurf.tissue.fibres import ACROSS, ALONG, AngleField, check_names
from cardiosurf.tissue.patches import Patch, patch_key
from cardiosurf.tissue.stimuli import EdgeStimulus, stimulus_key


def check_fit(config: Config, edge_length: float) -> Iterator[InputError]:
    """Yield an error for each part, open edge, net axis or coordinate the shape does not have."""
    sheet = config.geometry.sheet(edge_length)
    kind = config.geometry.kind
    axes = sorted({axis for pair in sheet.axes for axis in pair})
    for place, region in regions_in(config):
        for where, leaf in leaves(region, place):
            if isinstance(leaf, Part) and leaf.surface not in sheet.parts:
                yield _unknown(f"{where}.surface", "part", leaf.surface, sheet.parts, kind)
            if isinstance(leaf, Polar) and "theta" not in axes:
                yield InputError(
                    f"{where}.polar",
                    f"a {kind} has no angles theta and phi",
                    "polar on a vein, a sphere, a torus or an atrium",
                    "{box: {x: [...], y: [...]}}",
                )
    for number, stimulus in enumerate(config.stimulus):
        if isinstance(stimulus, EdgeStimulus) and stimulus.edge not in sheet.edge_names:
            where = f"{stimulus_key(number)}.edge"
            yield _unknown(where, "open edge", stimulus.edge, sheet.edge_names, kind)
    for patch in config.tissue.patches:
        yield from _directions(patch, tuple(axes), kind)


def _directions(patch: Patch, axes: tuple[str, ...], kind: str) -> Iterator[InputError]:
    """Yield an error for each net axis or coordinate of a patch that the shape does not have."""
    key = patch_key(patch.name)
    if isinstance(patch.fibres, AngleField):
        try:
            check_names(patch.fibres.angle, axes, f"{key}.fibres.angle", f"a {kind}")
        except InputError as error:
            yield error
    if patch.fibres is not None:
        return
    for word in ("anisotropy", "frame_scaling"):
        factors = getattr(patch, word)
        for axis in factors if isinstance(factors, dict) else ():
            if axis in {ALONG, ACROSS}:
                yield InputError(
                    f"{key}.{word}.{axis}",
                    f"{axis!r} is an axis of fibres, and the patch has none",
                    ", ".join(axes),
                    "add fibres: {angle: 0} for fibres along the first of these axes",
                )
            elif axis not in axes:
                yield _unknown(f"{key}.{word}.{axis}", "axis", axis, axes, kind)


def _unknown(where: str, what: str, name: str, known: Iterable[str], kind: str) -> InputError:
    guess = did_you_mean(name, known)
    return InputError(
        where,
        f"a {kind} has no {what} {name!r}" + (f", {guess}" if guess else ""),
        ", ".join(known) or f"none: a {kind} has no {what}",
    )
