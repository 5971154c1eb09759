"""Write benchmarks/README.md from what the benchmarks measured (benchmarks/results/*.json)."""

from pathlib import Path
from typing import Any

from compare import table
from results import machine, read
from runners import CARDIOSURF, PEERS

HERE = Path(__file__).resolve().parent
TITLES = {runner.name: runner.title for runner in (CARDIOSURF, *PEERS)}
BARS = (
    ("B", "torchcor", 20.0),
    ("A", "torchcor", 7.0),
    ("B", "fenicsx", 10.0),
    ("A", "fenicsx", 4.0),
    ("A", "finitewave", 8.0),
    ("B", "fenicsx_blended", 1.5),
    ("A", "fenicsx_blended", 1.5),
)
"""What is aimed at: how many times sooner cardiosurf is to 0.5 % of LAT."""


def main() -> None:
    """Write the page, whole or not at all."""
    lines = [
        "# Benchmarks",
        "",
        "Written by `make bench` from `results/*.json`. Ratios within one run are what counts; seconds",
        "depend on the machine.",
    ]
    for name, section in SECTIONS.items():
        found = read(name)
        if found is not None:
            lines += ["", *section(found)]
    beside = HERE / ".README.md"
    beside.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")
    beside.replace(HERE / "README.md")


def head(title: str, found: dict[str, Any]) -> list[str]:
    """Return the heading of a section and where it was measured."""
    where = [str(found[key]) for key in ("date", "processor", "software") if key in found]
    return [f"## {title}", "", *([f"*{', '.join(where)}*", ""] if where else [])]


def everyday(found: dict[str, Any]) -> list[str]:
    """Return what commands and the stages of a run take."""
    yardstick = found["commands"][2][1]
    lines = [
        *head("Everyday commands", found),
        "Whole processes on one core, medians (`check`: once, on two cores); the third row is the yardstick of the ratios.",
        "",
        "| what | seconds | ratio |",
        "|---|---|---|",
        *(f"| {what} | {took:.3f} | {took / yardstick:.2f} |" for what, took in found["commands"]),
        "",
        "Stages, seconds. *Cold* makes the mesh, *warm* reads it back, as every run after the first on a",
        "mesh does; the shares are of the whole process, warm.",
        "",
        "| run | vertices | steps | set-up cold | warm | share | march | judging | recording | share | whole |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for what, s in found["stages"].items():
        lines.append(
            f"| {what} | {s['vertices']} | {s['steps']} | {s['set_up_cold']:.2f}"
            f" | {s['set_up_warm']:.3f} | {s['set_up_warm'] / s['whole']:.1%}"
            f" | {s['march_in_run']:.2f} | {s['judge']:.3f} | {s['record']:.3f}"
            f" | {s['record'] / s['whole']:.1%} | {s['whole']:.2f} |"
        )
    scipys, ours = found["solves"]["scipy"], found["solves"]["ours"]
    return [
        *lines,
        "",
        f"One diffusion solve at 12,424 nodes with `scipy.sparse.linalg.cg`: {scipys * 1e3:.2f} ms;"
        f" with the NumPy loop of `--no-jit`: {ours * 1e3:.2f} ms ({ours / scipys:.2f} times).",
    ]


def peers(found: dict[str, Any]) -> list[str]:
    """Return the comparison with other codes, and the bars."""
    lines = [
        *head("Other codes", machine()),
        f"Versions: {versions(found)}.",
        "",
        "Seconds of one core until the LAT map is within 1, 0.5 and 0.1 % (root mean square) of the",
        "converged one, time loop only (`compare.py`). *Cheapest* is the fastest run whose error is below the",
        "target, be it by errors that cancel; *assured* asks that the next finer mesh, the next shorter step",
        "and all measured runs finer in both are below it as well.",
        "",
        *table(found, TITLES),
        "",
        "How many times sooner cardiosurf is to 0.5 %, like against like:",
        "",
        "| problem | code | bar | cheapest | assured |",
        "|---|---|---|---|---|",
    ]
    for problem, code, bar in BARS:
        cells = [ratio(found, problem, code, kind) for kind in ("cheapest", "assured")]
        lines.append(f"| {problem} | {TITLES[code]} | {bar:g} | {' | '.join(cells)} |")
    return lines


def versions(found: dict[str, Any]) -> str:
    """Return the codes that were measured, with their versions."""
    known = {run["code"]: run["version"] for run in found["runs"] if "version" in run}
    return ", ".join(f"{TITLES[code]} {known[code]}" for code in TITLES if code in known)


def ratio(found: dict[str, Any], problem: str, code: str, kind: str) -> str:
    """Return how many times as long another code takes to 0.5 %."""
    seconds = {
        one["code"]: one["run"]["loop_seconds"]
        for one in found["best"]
        if (one["problem"], one["kind"], one["target"]) == (problem, kind, 0.005) and one["run"]
    }
    if "cardiosurf" not in seconds:
        return "not measured"
    if code not in seconds:
        return "it never gets there"
    return f"{seconds[code] / seconds['cardiosurf']:.1f}"


def accuracy(found: dict[str, Any]) -> list[str]:
    """Return what the automatic mesh and step achieve."""
    lines = [
        *head("What `auto` achieves", found),
        f"LAT of every shipped config with automatic edges and steps against edges {found['finer']:g}"
        f" and steps {found['shorter']:g} times as short (`accuracy.py`); *expected* is what the rules allow for.",
        "",
        "| config | accuracy | edge | step | vertices | expected | error |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {row['config']} | {row['accuracy']:.1%} | {row['edge']:g} | {row['step']:g}"
        f" | {row['vertices']} | {row['expected']:.2%} | {row['error']:.3%} |"
        for row in found["rows"]
    ]
    missed = sum(not row["kept"] for row in found["rows"])
    return [*lines, "", f"{missed} of {len(found['rows'])} above their accuracy."]


def roofline(found: dict[str, Any]) -> list[str]:
    """Return how near the march comes to the machine's bounds."""
    copy = ", ".join(f"{level} {speed:.0f}" for level, speed in found["copying, GB/s"].items())
    lines = [
        *head("The machine's bounds", found),
        f"Copying on one core, GB/s read and written: {copy} (`make roofline`). Bytes are counted array by",
        "array; the bound is a copy in as many bytes as a step works on, measured beside it.",
        "",
        "| nodes | iterations a step | ns a node and step | at 3 iterations | bytes | GB/s | copy, GB/s | level | share of the bound |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {size['nodes']} | {size['iterations a step']:.2f} | {size['ns a node and step']:.1f}"
        f" | {size['ns a node at 3 iterations']:.1f} | {size['bytes a node and step']:.0f}"
        f" | {size['GB/s']:.0f} | {size['copy, GB/s']:.0f} | {size['level']} | {size['share of the bound']:.0%} |"
        for size in found["sizes"]
    ]
    threads, memory = found["threads"], found["memory"]
    return [
        *lines,
        "",
        f"Cost at equal iterations from the smallest to the largest: {found['growth']:.2f} times.",
        f"Two threads at {threads['nodes']} nodes: {threads['ratio']:.2f} times one.",
        f"Memory of a march at {memory['nodes']} nodes: {memory['peak']:.0f} bytes a node at its peak, of",
        f"which {memory['handed over']:.0f} are the matrices and the stimulus that it is handed.",
    ]


SECTIONS = {"everyday": everyday, "peers": peers, "accuracy": accuracy, "roofline": roofline}


if __name__ == "__main__":
    main()
