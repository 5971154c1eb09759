"""A config, written as YAML and read again, is the same config."""

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cardiosurf.config import Config, dump_config, load_text
from cardiosurf.geometry.plane import Plane
from cardiosurf.geometry.regions import (
    All,
    AnyOf,
    Ball,
    BallLimits,
    Box,
    BoxLimits,
    HalfSpace,
    HalfSpaceLimits,
    Not,
    Part,
    Polar,
    PolarLimits,
)
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.kinetics.fitzhugh_nagumo import FitzHughNagumo
from cardiosurf.kinetics.rogers_mcculloch import RogersMcCulloch
from cardiosurf.recording.sections import ProbeSection, RecordSection
from cardiosurf.stepping.controls import TimeSection
from cardiosurf.tissue.fibres import AngleField, Circles, Winding
from cardiosurf.tissue.patches import Patch, TissueSection
from cardiosurf.tissue.stimuli import S1S2, EdgeStimulus, PointStimulus, RegionStimulus, Train

number = st.floats(-1e6, 1e6, allow_nan=False)
positive = st.floats(1e-3, 1e6)
factor = st.floats(0.1, 30.0)
vector = st.tuples(number, number, number)
ranges = st.tuples(number, number).filter(lambda r: r[0] != r[1]).map(lambda r: (min(r), max(r)))
wide = ranges.filter(lambda r: r[1] - r[0] >= 2.5)
# words that YAML could take for something else are the interesting names
names = st.sampled_from(["no", "null", "true", "1e3", "0x1F", "on", "a b", "x", "y", "_", "pi"])


def regions(part: str, *, angles: bool) -> st.SearchStrategy:
    some = st.none() | ranges
    turn = st.none() | ranges.map(lambda r: (r[0] / 1e5, r[1] / 1e5)).filter(lambda r: r[0] < r[1])
    leaves = [
        st.builds(BoxLimits, some, some, some).map(Box),
        st.builds(BallLimits, vector, positive).map(Ball),
        st.builds(HalfSpaceLimits, vector.filter(lambda n: max(map(abs, n)) > 1e-6), number).map(
            HalfSpace
        ),
        st.just(Part(part)),
    ]
    if angles:
        leaves.append(st.builds(PolarLimits, turn, turn).map(Polar))
    return st.recursive(
        st.one_of(leaves),
        lambda inner: st.one_of(
            st.lists(inner, min_size=1, max_size=3).map(lambda r: All(tuple(r))),
            st.lists(inner, min_size=1, max_size=3).map(lambda r: AnyOf(tuple(r))),
            inner.map(Not),
        ),
        max_leaves=4,
    )


rules = st.builds(Winding, vector, st.floats(-100.0, 100.0)).map(Circles) | st.sampled_from(
    ["0", "1e-3", "45 deg", "x", "-y", "- y", "sin(x/10)\n + pi", "atan2(y, x)"]
).map(AngleField)
along = factor | st.dictionaries(st.sampled_from(["along", "across"]), factor, min_size=1)


@st.composite
def configs(draw: st.DrawFn) -> Config:
    plane = draw(st.booleans())
    axes = ("x", "y") if plane else ("theta", "phi")
    region = regions("plane" if plane else "sphere", angles=not plane)
    factors = st.none() | factor | st.dictionaries(st.sampled_from(axes), factor, min_size=1)
    patch_names = draw(st.lists(names, unique=True, max_size=2))
    fibres = [draw(st.none() | rules) for _ in patch_names]
    patches = [
        Patch(
            name,
            draw(region),
            rule,
            **{
                draw(st.sampled_from(["anisotropy", "frame_scaling"])): draw(
                    factors if rule is None else along
                )
            },
            diffusivity=draw(st.none() | factor),
            excitable=draw(st.booleans()),
        )
        for name, rule in zip(patch_names, fibres, strict=True)
    ]
    beats = [
        {},
        {"train": Train(3, draw(positive))},
        {"s1s2": S1S2(2, draw(positive), draw(positive))},
    ]
    timing = draw(st.sampled_from(beats))
    stimuli = [PointStimulus(centre=draw(vector), **timing), RegionStimulus(region=draw(region))]
    if plane:
        stimuli.append(EdgeStimulus(edge="left", position=draw(positive)))
    return Config(
        name=draw(st.sampled_from(["a", "no", "1e3", "plane-0.5"])),
        geometry=Plane(x=draw(wide)) if plane else Sphere(radius=draw(st.floats(2.5, 1e6))),
        kinetics=draw(
            st.builds(RogersMcCulloch, a=positive) | st.builds(FitzHughNagumo, c2=positive)
        ),
        tissue=TissueSection(draw(factor), tuple(patches)),
        stimulus=tuple(draw(st.permutations(stimuli))),
        time=TimeSection(end=1e7, step=draw(st.just("auto") | positive)),
        record=RecordSection(
            frames_every=draw(st.none() | st.floats(10.0, 1e6)),
            probes=tuple(ProbeSection(name, draw(vector)) for name in patch_names),
        ),
    )


# building the nested strategies is slow on a shared machine, the property itself is not
@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(configs())
def test_a_config_survives_being_written_and_read(config):
    text = dump_config(config)
    loaded = load_text(text)
    assert loaded.config == config
    assert loaded.text == text
