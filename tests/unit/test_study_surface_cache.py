import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields

import numpy as np
import pytest

from cardiosurf.errors import InputError
from cardiosurf.geometry import Plane, Sphere, TDomain, build_surface
from cardiosurf.geometry.regions import Ball, BallLimits, Box, BoxLimits
from cardiosurf.study import surface_cache
from cardiosurf.study.surface_cache import cache_folder, surface_of

PLANE = Plane(x=(-20.0, 20.0), y=(-10.0, 10.0))
REGIONS = {
    "block": Box(BoxLimits(x=(-5.0, 8.0))),
    "spot": Ball(BallLimits(centre=(0.0, 2.0, 0.0), radius=6.0)),
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A cache of the test's own."""
    monkeypatch.setenv("CARDIOSURF_CACHE", "on")
    monkeypatch.setenv("CARDIOSURF_CACHE_DIR", str(tmp_path / "kept"))
    return tmp_path / "kept"


@pytest.fixture
def builds(monkeypatch):
    """How often a surface was really made."""
    made = []

    def counted(*asked):
        made.append(asked)
        return build_surface(*asked)

    monkeypatch.setattr(surface_cache, "build_surface", counted)
    return made


def same(one, other):
    """Whether two surfaces agree bit for bit, and in the type of every array."""
    for field in fields(one):
        a, b = getattr(one, field.name), getattr(other, field.name)
        if isinstance(a, np.ndarray):
            a, b = {"": a}, {"": b}
        if not isinstance(a, dict):
            assert a == b
            continue
        assert list(a) == list(b)
        for name in a:
            assert (a[name].dtype, a[name].shape) == (b[name].dtype, b[name].shape)
            assert a[name].tobytes() == b[name].tobytes()
            assert b[name].flags.writeable
    return True


@pytest.mark.parametrize(
    ("shape", "edge", "regions"), [(PLANE, 2.0, REGIONS), (Sphere(), 9.0, {}), (TDomain(), 9.0, {})]
)
def test_a_surface_read_back_is_the_one_that_was_built(folder, builds, shape, edge, regions):
    built = build_surface(shape, edge, regions)
    assert same(surface_of(shape, edge, regions), built)
    assert same(surface_of(shape, edge, regions), built)
    assert len(builds) == 1
    assert [file.suffix for file in folder.iterdir()] == [".npz"]


def test_whatever_changes_the_mesh_makes_another(folder, builds):
    asked = [
        (PLANE, 2.0, REGIONS),
        (PLANE, 2.0 + 1e-12, REGIONS),
        (Plane(x=(-20.0, 20.0), y=(-10.0, 10.5)), 2.0, REGIONS),
        (PLANE, 2.0, {"block": REGIONS["block"]}),
        (PLANE, 2.0, {"other": REGIONS["block"], "spot": REGIONS["spot"]}),
    ]
    for one in asked:
        assert same(surface_of(*one), build_surface(*one))
    assert len(builds) == len(asked)


def test_another_geometry_code_finds_nothing(folder, builds, monkeypatch):
    surface_of(PLANE, 4.0, REGIONS)
    monkeypatch.setattr(surface_cache, "_code", lambda: "another")
    surface_of(PLANE, 4.0, REGIONS)
    assert len(builds) == 2


def test_a_spoiled_file_is_built_over(folder, builds):
    built = surface_of(PLANE, 4.0, REGIONS)
    file = next(folder.iterdir())
    whole = file.read_bytes()
    middle = len(whole) // 2
    flipped = whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :]
    for number, spoiled in enumerate([b"", whole[:middle], whole[:-1], b"PK" + whole, flipped]):
        file.write_bytes(spoiled)
        assert same(surface_of(PLANE, 4.0, REGIONS), built)
        assert len(builds) == 2 + number
        assert file.read_bytes() != spoiled


@pytest.mark.parametrize(
    "name", ["points", "triangles", "frame", "part_of", "edges.0", "regions.1"]
)
def test_arrays_that_do_not_fit_are_not_taken(folder, builds, name):
    built = surface_of(PLANE, 4.0, REGIONS)
    file = next(folder.iterdir())
    with np.load(file) as stored:
        arrays = dict(stored)
    for number, wrong in enumerate((arrays[name][:-1, None], arrays[name].astype(np.float32))):
        np.savez(file, **{**arrays, name: wrong})
        assert same(surface_of(PLANE, 4.0, REGIONS), built)
        assert len(builds) == 2 + number


def test_no_place_to_keep_is_no_error(tmp_path, monkeypatch, builds):
    monkeypatch.setenv("CARDIOSURF_CACHE", "on")
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("CARDIOSURF_CACHE_DIR", str(tmp_path / "file" / "kept"))
    for _ in range(2):
        assert len(surface_of(PLANE, 4.0, REGIONS).points) > 0
    assert len(builds) == 2


def test_errors_of_the_mesh_come_through_and_leave_nothing(folder):
    far = {"block": Box(BoxLimits(x=(50.0, 60.0)))}
    for _ in range(2):
        with pytest.raises(InputError, match="holds no part"):
            surface_of(PLANE, 4.0, far)
    assert not folder.exists()


def test_processes_that_make_the_same_surface_do_not_meet(folder):
    with ThreadPoolExecutor(4) as pool:
        surfaces = list(pool.map(lambda _: surface_of(PLANE, 4.0, REGIONS), range(8)))
    built = build_surface(PLANE, 4.0, REGIONS)
    assert all(same(one, built) for one in surfaces)
    assert len(list(folder.iterdir())) == 1


def test_those_not_used_for_longest_go_where_room_is_short(folder, builds, monkeypatch):
    for edge in (4.0, 4.1):
        surface_of(PLANE, edge, REGIONS)
    sizes = []
    for number, file in enumerate(folder.iterdir()):
        sizes.append(file.stat().st_size)
        os.utime(file, (1e9 + number, 1e9 + number))
    # read again, the first is newer than the second
    surface_of(PLANE, 4.0, REGIONS)
    monkeypatch.setattr(surface_cache, "_ROOM", 1.2 * sum(sizes))
    surface_of(PLANE, 4.2, REGIONS)
    assert len(builds) == 3
    assert len(list(folder.iterdir())) == 2
    surface_of(PLANE, 4.0, REGIONS)
    assert len(builds) == 3
    surface_of(PLANE, 4.1, REGIONS)
    assert len(builds) == 4


def test_what_a_killed_process_left_is_removed(folder):
    folder.mkdir()
    left, fresh = folder / "a.1.partial", folder / "a.2.partial"
    for file in (left, fresh):
        file.write_bytes(b"half")
    os.utime(left, (1e9, 1e9))
    surface_of(PLANE, 4.0, REGIONS)
    assert not left.exists()
    assert fresh.exists()


def test_where_surfaces_are_kept(monkeypatch, tmp_path):
    for name in ("CARDIOSURF_CACHE", "CARDIOSURF_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache_folder() == tmp_path / ".cache" / "cardiosurf" / "surfaces"
    monkeypatch.setenv("XDG_CACHE_HOME", "not/absolute")
    assert cache_folder() == tmp_path / ".cache" / "cardiosurf" / "surfaces"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache_folder() == tmp_path / "xdg" / "cardiosurf" / "surfaces"
    monkeypatch.setenv("CARDIOSURF_CACHE_DIR", str(tmp_path / "mine"))
    assert cache_folder() == tmp_path / "mine"
    monkeypatch.setenv("CARDIOSURF_CACHE", "OFF")
    assert cache_folder() is None
