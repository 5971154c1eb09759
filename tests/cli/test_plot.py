import pytest

from cardiosurf.cli.main import main

CONFIG = """\
name: little
geometry: {kind: plane, x: [-20, 20], y: [-10, 10]}
mesh: {edge_length: 5}
kinetics: {model: rogers_mcculloch}
tissue:
  patches:
    - {name: scar, region: {box: {x: [5, 15], y: [-5, 5]}}, excitable: false}
stimulus:
  - {shape: edge, edge: left}
time: {end: 150}
record: {probes: [{name: middle, at: [0, 0, 0]}]}
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plot")
    (folder / "little.yaml").write_text(CONFIG)
    assert main(["run", str(folder / "little.yaml"), "-o", str(folder / "run")]) == 0
    return folder / "run"


def test_figures_appear_beside_the_recording_and_are_printed(run, capsys):
    assert main(["plot", str(run)]) == 0
    printed = capsys.readouterr().out.splitlines()
    expected = [
        str(run / f"{name}.{kind}")
        for name in ("activation_map", "probe_traces")
        for kind in ("png", "svg")
    ]
    assert printed == expected
    assert all((run / line).stat().st_size > 1000 for line in expected)
    assert "scar (scar)" in (run / "activation_map.svg").read_text()


def test_output_folder_and_format_can_be_chosen(run, tmp_path, capsys):
    words = ["plot", str(run / "recording.h5"), "-o", str(tmp_path / "new"), "--format", "svg"]
    assert main(words) == 0
    assert sorted(path.name for path in (tmp_path / "new").iterdir()) == [
        "activation_map.svg",
        "probe_traces.svg",
    ]
    assert "verdict:" in (tmp_path / "new" / "activation_map.svg").read_text()
    assert str(tmp_path / "new" / "probe_traces.svg") in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("", "holds no recording.h5"),
        ("none.h5", "no such file"),
        ("text.h5", "cannot be read as HDF5"),
    ],
)
def test_what_is_no_recording_ends_with_exit_code_2(tmp_path, capsys, name, message):
    (tmp_path / "text.h5").write_text("no recording")
    assert main(["plot", str(tmp_path / name)]) == 2
    shown = capsys.readouterr()
    assert message in shown.err
    assert str(tmp_path / name) in shown.err
    assert shown.out == ""
