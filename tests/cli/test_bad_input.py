"""Bad input ends with exit code 2 and a message that helps; it leaves nothing behind."""

import errno
import subprocess
import sys
from pathlib import Path

import click
import pytest

from cardiosurf.cli.errors import end
from cardiosurf.cli.main import main
from cardiosurf.errors import InputError, NumericalError

# coarse, so that commands that build the mesh are quick
GOOD = """\
geometry: {kind: plane, x: [-50, 50], y: [-50, 50]}
mesh: {edge_length: 10}
tissue:
  patches:
    - name: block
      region: {box: {x: [-20, 20], y: [-20, 20]}}
      anisotropy: {x: 10}
stimulus:
  - {shape: point, centre: [40, 0, 0]}
time: {end: 20}
record:
  probes: [{name: middle, at: [0, 0, 0]}]
targets:
  - {name: block, region: {patch: block}}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "good.yaml").write_text(GOOD)
    return tmp_path


def called(capsys, *arguments: str) -> tuple[int, str, str]:
    code = main(arguments)
    captured = capsys.readouterr()
    return code, captured.out, captured.err


# what is wrong: the file's bytes or text, the command's words, what the message must say
CASES = {
    "missing file": (None, ["run", "goood.yaml"], ["goood.yaml: no such file", "'good.yaml'?"]),
    "folder": (None, ["run", "."], [".: is a folder", "good.yaml"]),
    "not YAML": ("a: [1\nb: 2\n", ["run", "bad.yaml"], ["bad.yaml:2", "not YAML"]),
    "tab": ("time:\n\tend: 3\n", ["run", "bad.yaml"], ["bad.yaml:2", "tab", "spaces"]),
    "not text": (b"\x89HDF\r\n\x1a\n", ["run", "bad.yaml"], ["bad.yaml:1", "0x89", "UTF-8"]),
    "empty": ("", ["run", "bad.yaml"], ["bad.yaml", "empty", "geometry, stimulus and time"]),
    "python tag": (
        "name: !!python/object/apply:os.mkdir [harm]\n",
        ["run", "bad.yaml"],
        ["bad.yaml:1: name", "!!python/object/apply:os.mkdir", "runs no code"],
    ),
    "duplicate key": (
        GOOD + "mesh: {edge_length: 5}\n",
        ["run", "bad.yaml"],
        ["bad.yaml:15: mesh", "twice, first on line 2"],
    ),
    "wrong key": (
        GOOD.replace("edge_length", "edgelength"),
        ["run", "bad.yaml"],
        ["bad.yaml:2: mesh.edgelength", "did you mean 'edge_length'?", "order, mass"],
    ),
    "wrong type": (
        GOOD.replace("end: 20", "end: soon"),
        ["run", "bad.yaml"],
        ["bad.yaml:10: time.end: 'soon' is not a number", "a number from 1e-06 to 1e+07"],
    ),
    "NaN": (
        GOOD.replace("[40, 0, 0]", "[.nan, 0, 0]"),
        ["run", "bad.yaml"],
        ["bad.yaml:9: stimulus.0.centre.0: .nan is not a finite number"],
    ),
    "infinite": (
        GOOD.replace("end: 20", "end: 1e999"),
        ["run", "bad.yaml"],
        ["bad.yaml:10: time.end: .inf is not a finite number"],
    ),
    "negative edge length": (
        GOOD.replace("edge_length: 10", "edge_length: -10"),
        ["mesh", "bad.yaml", "-o", "out.vtu"],
        ["bad.yaml:2: mesh.edge_length: -10", "from 0.1 to 50"],
    ),
    "tensor not positive": (
        GOOD.replace("{x: 10}", "{x: 0}"),
        ["run", "bad.yaml"],
        ["bad.yaml:7: tissue.patches.block.anisotropy.x: 0 is not above 0"],
    ),
    "patch off the surface": (
        GOOD.replace("x: [-20, 20]", "x: [60, 70]"),
        ["validate", "--mesh", "bad.yaml"],
        ["bad.yaml:6: tissue.patches.block.region: {box: {x: [60, 70]", "x: [-50, 50]"],
    ),
    "empty target": (
        GOOD.replace("{patch: block}}", "{all: [{patch: block}, {not: {patch: block}}]}}"),
        ["mesh", "bad.yaml", "-o", "out.vtu"],
        ["bad.yaml:14: targets.block", "no part of the surface"],
    ),
    "stimulus off the surface": (
        GOOD.replace("[40, 0, 0]", "[40, 0, 70]"),
        ["validate", "--mesh", "bad.yaml"],
        ["bad.yaml:9: stimulus.0.centre", "70 su away", "radius (10 su)", "[40, 0, 0]"],
    ),
    "probe off the surface": (
        GOOD.replace("at: [0, 0, 0]", "at: [0, 0, 99]"),
        ["validate", "--mesh", "bad.yaml"],
        ["bad.yaml:12: record.probes.middle", "99"],
    ),
    "unknown edge": (
        GOOD.replace("shape: point, centre: [40, 0, 0]", "shape: edge, edge: rigth"),
        ["run", "bad.yaml"],
        ["bad.yaml:9: stimulus.0.edge", "no open edge 'rigth'", "'right'?", "left"],
    ),
    "axis of another surface": (
        GOOD.replace("{x: 10}", "{theta: 10}"),
        ["run", "bad.yaml"],
        ["bad.yaml:7: tissue.patches.block.anisotropy.theta", "x, y"],
    ),
    "--set of a wrong key": (
        None,
        ["run", "good.yaml", "--set", "mesh.edge_lenght=4"],
        ["--set mesh.edge_lenght=4", "did you mean 'edge_length'?"],
    ),
    "--set of a wrong item": (
        None,
        ["run", "good.yaml", "--set", "tissue.patches.blok.anisotropy=4"],
        ["--set tissue.patches.blok.anisotropy=4", "did you mean 'block'?"],
    ),
    "--set of a wrong value": (
        None,
        ["validate", "--mesh", "good.yaml", "--set", "stimulus.0.centre=[40,0,70]"],
        ["--set stimulus.0.centre=[40,0,70]", "70 su away"],
    ),
    "--set without a value": (None, ["run", "good.yaml", "--set", "time.end"], ["key.path=value"]),
    "unknown mesh format": (
        None,
        ["mesh", "good.yaml", "-o", "out.vtx"],
        ["-o out.vtx", "'.vtx'", ".vtu", ".ply"],
    ),
    "mesh into no folder": (
        None,
        ["mesh", "good.yaml", "-o", "nowhere/out.vtu"],
        ["nowhere/out.vtu", "no folder nowhere"],
    ),
    "mesh onto a file": (None, ["mesh", "good.yaml", "-o", "good.yaml"], ["-o good.yaml"]),
}


@pytest.mark.parametrize("case", CASES)
def test_bad_input_is_refused_in_words_and_leaves_nothing(case, folder, capsys):
    content, arguments, says = CASES[case]
    if content is not None:
        raw = content if isinstance(content, bytes) else content.encode()
        (folder / "bad.yaml").write_bytes(raw)
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    code, out, err = called(capsys, *arguments)
    assert code == 2
    assert err.startswith("error: ")
    assert "Traceback" not in out + err
    for words in says:
        assert words in err
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


# numbers that no tissue has: the --set option, what the message must say
BEYOND = {
    "diffusivity": ("tissue.diffusivity=1e308", "is above 1e+06"),
    "anisotropy": ("tissue.patches.block.anisotropy=1e200", "is above 1e+06"),
    "frame scaling": (
        "tissue.patches.0={name: a, region: {surface: plane}, frame_scaling: 1e5}",
        "a factor of 1e+10 on the diffusivity",
    ),
    "diffusivity times factor": ("tissue.diffusivity=1e6", "1e+06 times the factor 10 is 1e+07"),
    "kinetics": ("kinetics.b2=1e308", "is above 1e+06"),
    "amplitude": ("stimulus.0.amplitude=20", "is above 10"),
    "centre": ("stimulus.0.centre=[1e300, 0, 0]", "from -1e+06 to 1e+06"),
    "probe": ("record.probes.0.at=[1e300, 0, 0]", "far from any surface"),
    "frames": ("record.frames_every=1e-320", "is below 1e-06"),
    "too many frames": ("record.frames_every=1e-5", "2e+06 frames"),
    "step": ("time.step=1e-300", "is below 1e-06"),
    "end": ("time.end=1e9", "is above 1e+07"),
    "too many steps": ("kinetics.c1=1e6", "at most 1e+07 steps"),
    "thin": ("geometry.x=[0, 0.001]", "less than one mesh edge of 10 su"),
    "far": ("geometry.x=[1e15, 1.0000000000001e15]", "is above 1e+06"),
    "small sphere": ("geometry={kind: sphere, radius: 4}", "at least mesh.edge_length (10)"),
    "normal": (
        "targets.0.region={half_space: {normal: [1e-300, 0, 0]}}",
        "has no direction",
    ),
    "empty target": ("targets.0.region={box: {x: [200, 300]}}", "x: [200, 300]"),
    "target in a scar": ("tissue.patches.block.excitable=false", "not excitable"),
    "superscript as index": ("targets.².name=x", "no item '²'"),
    "endless index": ("targets." + "9" * 5000 + ".name=x", "no item"),
    "half a character": ('name="\\ud800"', "half a character"),
}


@pytest.mark.parametrize("case", BEYOND)
def test_numbers_beyond_all_use_are_refused_at_their_option(case, folder, capsys, recwarn):
    option, says = BEYOND[case]
    code, out, err = called(capsys, "validate", "--mesh", "good.yaml", "--set", option)
    assert (code, out) == (2, "")
    assert says in err
    assert "Traceback" not in err
    # what the other sections say of another shape comes with it; the step is no option of its own
    if "problems" not in err and case not in {"too many steps", "target in a scar"}:
        assert case == "diffusivity times factor" or f"--set {option}" in err
    assert not recwarn.list


def test_a_long_file_name_makes_a_name_that_is_allowed(folder, capsys):
    (folder / f"{'n' * 200}.yaml").write_text(GOOD)
    code, out, _ = called(capsys, "validate", f"{'n' * 200}.yaml")
    assert code == 0
    assert f"{'n' * 100}: plane" in out


def test_a_name_too_long_for_the_disk_is_refused(folder, capsys):
    for words in (["mesh", "good.yaml", "-o", "o" * 300 + ".vtu"], ["analyze", "o" * 300]):
        code, _, err = called(capsys, *words)
        assert code == 2
        assert "too long" in err.lower()


@pytest.mark.parametrize("closed", [">&-", "1</dev/null", ">&- 2>&-"])
def test_closed_output_is_output_that_nobody_reads(closed):
    script = f"'{sys.executable}' -m cardiosurf.cli.main schema {closed}"
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_the_good_config_is_good(folder, capsys):
    code, out, err = called(capsys, "validate", "--mesh", "good.yaml")
    assert (code, err) == (0, "")
    assert out.startswith("ok  good.yaml  good: plane")


def test_a_message_stands_alone_on_stderr(folder):
    done = subprocess.run(
        [sys.executable, "-m", "cardiosurf.cli.main", "run", "good.yaml", "--set", "time.end=-1"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == (
        "error: --set time.end=-1: -1 is not above 0\n  allowed: a number from 1e-06 to 1e+07\n"
    )


@pytest.mark.parametrize(
    ("error", "code", "says"),
    [
        (InputError("a.yaml:3: mesh", "wrong", "right", "that"), 2, "a.yaml:3: mesh: wrong"),
        (NumericalError("blow-up at step 3", "a smaller step"), 3, "blow-up at step 3"),
        (MemoryError(), 3, "memory"),
        (OSError(errno.ENOSPC, "No space left", "out.h5"), 2, "out.h5: the disk is full"),
        (PermissionError(errno.EACCES, "denied", "out.h5"), 2, "out.h5: permission denied"),
        (OSError(errno.EROFS, "read-only", "/mnt/a"), 2, "/mnt/a: the file system is read-only"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (click.Abort(), 130, "interrupted"),
        (ZeroDivisionError("oops"), 70, "please report"),
    ],
)
def test_exit_codes(error, code, says, capsys):
    assert end(error) == code
    err = capsys.readouterr().err
    assert says in err
    # only what nobody foresaw shows a traceback
    assert ("oops" in err) == (code == 70)


def test_output_that_nobody_reads_ends_quietly():
    script = (
        f"'{sys.executable}' -m cardiosurf.cli.main schema | head -c 10; echo ${{PIPESTATUS[0]}}"
    )
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=False)
    # the schema is larger than a pipe's buffer need not be: either it fitted, or the pipe broke
    assert done.stdout[10:].strip() in {"0", "141"}
    assert done.stderr == ""


def test_a_full_disk_is_named(folder, capsys, monkeypatch):
    def full(self: Path, target: Path) -> Path:
        raise OSError(errno.ENOSPC, "No space left on device", str(self))

    monkeypatch.setattr(Path, "replace", full)
    code, _, err = called(capsys, "mesh", "good.yaml", "-o", "out.vtu")
    assert code == 2
    assert "out.vtu: cannot be written: No space left on device" in err
    assert sorted(path.name for path in folder.iterdir()) == ["good.yaml"]
