"""What the sections must agree on with each other, after each is right by itself."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Protocol

from cardiosurf.config.accuracy import edge_choice
from cardiosurf.config.document import is_index
from cardiosurf.config.fit import check_fit
from cardiosurf.config.region_paths import leaves, regions_in
from cardiosurf.config.sections import Config
from cardiosurf.errors import InputError
from cardiosurf.geometry import check_size
from cardiosurf.geometry.regions import PatchReference, Region, resolve
from cardiosurf.sections import LARGEST
from cardiosurf.spelling import did_you_mean
from cardiosurf.tissue.patches import check_diffusivity, factors_of
from cardiosurf.tissue.stimuli import RegionStimulus, beat_times, check_timing, stimulus_key

_MOST_FRAMES = 1e6
USUAL_EDGE = 2.5
_ITEM_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_ -]*")


class _Named(Protocol):
    @property
    def name(self) -> str: ...


def check(config: Config) -> list[InputError]:
    """Return everything in which the sections contradict each other; ``where`` is a key path."""
    edge = _edge(config)
    shape = list(_raised(config.geometry.check)) or list(
        _raised(lambda: check_size(config.geometry, edge))
    )
    return [
        *(shape or check_fit(config, edge)),
        *_names("tissue.patches", config.tissue.patches),
        *_names("record.probes", config.record.probes),
        *_names("targets", config.targets),
        *_patches(config),
        *_record(config),
        *_references(config),
        *_stimuli(config),
        *_times(config),
    ]


def _edge(config: Config) -> float:
    """Return the mesh edges, and a usual length where a wrong tissue tells no automatic one."""
    try:
        return edge_choice(config).edge_length
    except InputError:
        return USUAL_EDGE


def resolved(config: Config) -> Config:
    """Return the config with each reference to a patch replaced by the patch's region.

    Raises
    ------
    KeyError
        If a reference names no earlier patch; ``check`` says so in words.
    """
    regions: dict[str, Region] = {}
    for patch in config.tissue.patches:
        regions[patch.name] = resolve(patch.region, regions)
    patches = tuple(replace(p, region=regions[p.name]) for p in config.tissue.patches)
    return replace(
        config,
        tissue=replace(config.tissue, patches=patches),
        targets=tuple(replace(t, region=resolve(t.region, regions)) for t in config.targets),
        stimulus=tuple(
            replace(s, region=resolve(s.region, regions)) if isinstance(s, RegionStimulus) else s
            for s in config.stimulus
        ),
    )


def _names(where: str, items: Sequence[_Named]) -> Iterator[InputError]:
    first: dict[str, int] = {}
    for number, item in enumerate(items):
        place = f"{where}.{number}.name"
        if not _ITEM_NAME.fullmatch(item.name):
            yield InputError(
                place,
                f"{item.name!r} cannot be a name",
                "letters, digits, spaces, - and _, so that --set can use it",
            )
        elif is_index(item.name):
            yield InputError(
                place, f"the name {item.name!r} would be taken for an index", "a word as a name"
            )
        elif item.name in first:
            yield InputError(
                place,
                f"{item.name!r} is also the name of {where}.{first[item.name]}",
                f"names that differ within {where}",
            )
        first.setdefault(item.name, number)


def _patches(config: Config) -> Iterator[InputError]:
    wrong = False
    for patch in config.tissue.patches:
        for error in _raised(lambda patch=patch: factors_of(patch)):  # type: ignore[misc]
            wrong = True
            yield error
    if not wrong:
        yield from _raised(lambda: check_diffusivity(config.tissue))


def _record(config: Config) -> Iterator[InputError]:
    every = config.record.frames_every
    if every is not None and config.time.end / every > _MOST_FRAMES:
        yield InputError(
            "record.frames_every",
            f"{config.time.end / every:.3g} frames of {every:g} tu up to time.end",
            f"at most {_MOST_FRAMES:.0e} frames",
            "a larger record.frames_every, or null for none",
        )
    for number, probe in enumerate(config.record.probes):
        if max(map(abs, probe.at)) > LARGEST:
            yield InputError(
                f"record.probes.{number}.at",
                f"{list(probe.at)} is far from any surface",
                f"coordinates from {-LARGEST:g} to {LARGEST:g}",
            )


def _stimuli(config: Config) -> Iterator[InputError]:
    for number, stimulus in enumerate(config.stimulus):
        key = stimulus_key(number)
        yield from _raised(lambda s=stimulus, k=key: check_timing(s, k))  # type: ignore[misc]
        last = beat_times(stimulus)[-1]
        if last >= config.time.end:
            yield InputError(
                f"{key}.at",
                f"the last beat comes at {last:g} tu, but the run ends at {config.time.end:g} tu",
                f"beats before time.end ({config.time.end:g})",
                f"time.end: {last + 1000:g}",
            )


def _times(config: Config) -> Iterator[InputError]:
    step = config.time.step
    if step != "auto" and step >= config.time.end:
        yield InputError(
            "time.step",
            f"a step of {step:g} tu is as long as the run of {config.time.end:g} tu",
            "auto, or a number well below time.end",
            "step: auto",
        )


def _raised(checked: Callable[[], object]) -> Iterator[InputError]:
    try:
        checked()
    except InputError as error:
        yield error


def _references(config: Config) -> Iterator[InputError]:
    order = [patch.name for patch in config.tissue.patches]
    for place, region in regions_in(config):
        section, number = place.split(".")[:2]
        # a patch refers to earlier patches; what is not a patch refers to any
        known = order[: int(place.split(".")[2])] if (section, number) == _PATCHES else order
        for where, leaf in leaves(region, place):
            if isinstance(leaf, PatchReference) and leaf.patch not in known:
                yield _unknown_patch(f"{where}.patch", leaf.patch, known, order)


_PATCHES = ("tissue", "patches")


def _unknown_patch(where: str, name: str, known: Sequence[str], order: Sequence[str]) -> InputError:
    if name in order:
        problem = f"patch {name!r} is not before this one; a patch refers to earlier patches only"
    else:
        guess = did_you_mean(name, known)
        problem = f"unknown patch {name!r}" + (f", {guess}" if guess else "")
    nothing = f"nothing: {'no patch comes before this one' if order else 'there are no patches'}"
    return InputError(where, problem, ", ".join(known) or nothing)
