"""validate, mesh and schema: what they print and write."""

import json
from pathlib import Path

import jsonschema
import meshio
import numpy as np
import pytest

from cardiosurf.cli.main import main
from cardiosurf.geometry.export import FORMATS, written_files

CONFIGS = Path(__file__).parents[2] / "configs"
GOOD = """\
geometry: {kind: plane, x: [-50, 50], y: [-50, 50]}
mesh: {edge_length: 10}
tissue:
  patches:
    - {name: block, region: {box: {x: [-20, 20], y: [-10, 20]}}, anisotropy: {x: 10}}
stimulus:
  - {shape: edge, edge: right}
time: {end: 20}
targets:
  - {name: block, region: {patch: block}}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "good.yaml").write_text(GOOD)
    (tmp_path / "bad.yaml").write_text(GOOD.replace("plane", "plan"))
    return tmp_path


def test_validate_prints_one_line_a_file(capsys):
    files = sorted(str(path) for path in CONFIGS.glob("*.yaml"))
    assert main(["validate", *files]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[:2] for line in lines] == [["ok", file] for file in files]


def test_validate_checks_all_files_before_it_ends(folder, capsys):
    assert main(["validate", "bad.yaml", "nosuch.yaml", "good.yaml"]) == 2
    captured = capsys.readouterr()
    assert captured.out.startswith("ok  good.yaml")
    assert "bad.yaml:1: geometry.kind" in captured.err
    assert "nosuch.yaml: no such file" in captured.err
    assert captured.err.endswith("2 of 3 files are wrong\n")


def test_validate_builds_the_mesh_when_asked(folder, capsys):
    empty = "tissue.patches.block.region={box: {x: [70, 80]}}"
    assert main(["validate", "good.yaml", "--set", empty]) == 0
    assert main(["validate", "--mesh", "good.yaml", "--set", empty]) == 2
    assert "tissue.patches.block" in capsys.readouterr().err


# meshio's STL reader multiplies a 32-bit count to tell binary files from text
@pytest.mark.filterwarnings("ignore:overflow encountered:RuntimeWarning:meshio")
@pytest.mark.parametrize("suffix", [ending[1:] for ending in FORMATS])
def test_mesh_writes_what_meshio_reads_back(suffix, folder, capsys):
    assert main(["mesh", "good.yaml", "-o", f"out.{suffix}"]) == 0
    assert f"written to out.{suffix}" in capsys.readouterr().out
    mesh = meshio.read(f"out.{suffix}")
    triangles = mesh.cells_dict["triangle"]
    corners = mesh.points[triangles][:, :, :2]
    (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    # .ply and .stl may hold single precision
    assert 0.5 * np.abs(ax * by - ay * bx).sum() == pytest.approx(100.0 * 100.0, rel=1e-5)
    made = {path.name for path in written_files(Path(f"out.{suffix}"))}
    assert {path.name for path in folder.iterdir()} == {"good.yaml", "bad.yaml"} | made


def test_mesh_replaces_no_file_that_goes_with_it(folder, capsys):
    (folder / "out.h5").write_text("mine")
    assert main(["mesh", "good.yaml", "-o", "out.xdmf"]) == 2
    assert "out.h5, which goes with it, is there already" in capsys.readouterr().err
    assert (folder / "out.h5").read_text() == "mine"
    assert not (folder / "out.xdmf").exists()


@pytest.mark.parametrize("suffix", ["e", "ex2", "bdf", "su2", "ele", "vol.gz", "f3grid"])
def test_mesh_refuses_formats_that_hold_no_surface(suffix, folder, capsys):
    assert main(["mesh", "good.yaml", "-o", f"out.{suffix}"]) == 2
    assert "names no mesh format" in capsys.readouterr().err


def test_mesh_carries_parts_and_regions(folder):
    assert main(["mesh", "good.yaml", "-o", "out.vtu"]) == 0
    mesh = meshio.read("out.vtu")
    inside = mesh.cell_data_dict["region_tissue.patches.block"]["triangle"].astype(bool)
    corners = mesh.points[mesh.cells_dict["triangle"]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    # the block is 40 by 30, and mesh lines follow its edges: exact up to rounding
    assert 0.5 * np.linalg.norm(normal[inside], axis=1).sum() == pytest.approx(1200.0, rel=1e-9)
    assert "part" in mesh.cell_data_dict


def test_mesh_reports_quality_without_writing(folder, capsys):
    assert main(["mesh", "good.yaml", "--set", "mesh.edge_length=8"]) == 0
    text = capsys.readouterr().out
    for words in (
        "smallest, largest angle",
        "asked for 8",
        "10000 su^2",
        "1200 su^2",
        "0 is right",
    ):
        assert words in text
    assert {path.name for path in folder.iterdir()} == {"good.yaml", "bad.yaml"}


def test_mesh_replaces_a_file_only_when_told(folder, capsys):
    (folder / "out.vtu").write_text("mine")
    assert main(["mesh", "good.yaml", "-o", "out.vtu"]) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert (folder / "out.vtu").read_text() == "mine"
    assert main(["mesh", "good.yaml", "-o", "out.vtu", "--overwrite"]) == 0
    assert meshio.read("out.vtu").points.shape[1] == 3


@pytest.mark.parametrize("what", [[], ["config"], ["verdict"]])
def test_schema_prints_a_json_schema(what, capsys):
    assert main(["schema", *what]) == 0
    schema = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator.check_schema(schema)
    assert schema["properties"]
