"""Every region of a config, and every single word of it, with its key path."""

from collections.abc import Iterator

from cardiosurf.config.sections import Config
from cardiosurf.geometry.regions import (
    All,
    AnyOf,
    Ball,
    Box,
    HalfSpace,
    Not,
    Part,
    PatchReference,
    Polar,
    Region,
)
from cardiosurf.tissue.stimuli import RegionStimulus, stimulus_key

Leaf = Box | Ball | HalfSpace | Part | PatchReference | Polar


def regions_in(config: Config) -> Iterator[tuple[str, Region]]:
    """Yield the key path and the region of every patch, target and region stimulus."""
    for number, patch in enumerate(config.tissue.patches):
        yield f"tissue.patches.{number}.region", patch.region
    for number, target in enumerate(config.targets):
        yield f"targets.{number}.region", target.region
    for number, stimulus in enumerate(config.stimulus):
        if isinstance(stimulus, RegionStimulus):
            yield f"{stimulus_key(number)}.region", stimulus.region


def leaves(region: Region, where: str) -> Iterator[tuple[str, Leaf]]:
    """Yield the key path and the region of every word that is not made of other regions."""
    match region:
        case All(all=parts):
            for number, part in enumerate(parts):
                yield from leaves(part, f"{where}.all.{number}")
        case AnyOf(any=parts):
            for number, part in enumerate(parts):
                yield from leaves(part, f"{where}.any.{number}")
        case Not(not_=part):
            yield from leaves(part, f"{where}.not")
        case _:
            yield where, region
