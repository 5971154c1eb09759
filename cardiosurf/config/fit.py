"""What the sections say about the surface must be there on it: parts, edges, axes."""

from collections.abc import Iterable, Iterator

from cardiosurf.config.region_paths import leaves, regions_in
from cardiosurf.config.sections import Config
from cardiosurf.errors import InputError
from cardiosurf.geometry.regions import Part, Polar
from cardiosurf.spelling import did_you_mean
from cardiosurf.tissue.patches import patch_key
from cardiosurf.tissue.stimuli import EdgeStimulus, stimulus_key


def check_fit(config: Config, edge_length: float) -> Iterator[InputError]:
    """Yield an error for each part, open edge or net axis that the shape does not have."""
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
                    "polar on a vein or a sphere",
                    "{box: {x: [...], y: [...]}}",
                )
    for number, stimulus in enumerate(config.stimulus):
        if isinstance(stimulus, EdgeStimulus) and stimulus.edge not in sheet.edge_names:
            where = f"{stimulus_key(number)}.edge"
            yield _unknown(where, "open edge", stimulus.edge, sheet.edge_names, kind)
    for where, axis in _named_axes(config):
        if axis not in axes:
            yield _unknown(where, "axis", axis, axes, kind)


def _named_axes(config: Config) -> Iterator[tuple[str, str]]:
    """Yield the key path and the name of each net axis that a patch names."""
    for patch in config.tissue.patches:
        if isinstance(patch.anisotropy, dict):
            for axis in patch.anisotropy:
                yield f"{patch_key(patch.name)}.anisotropy.{axis}", axis
        if isinstance(patch.frame_scaling, dict):
            for axis in patch.frame_scaling:
                yield f"{patch_key(patch.name)}.frame_scaling.{axis}", axis


def _unknown(where: str, what: str, name: str, known: Iterable[str], kind: str) -> InputError:
    guess = did_you_mean(name, known)
    return InputError(
        where,
        f"a {kind} has no {what} {name!r}" + (f", {guess}" if guess else ""),
        ", ".join(known) or f"none: a {kind} has no {what}",
    )
