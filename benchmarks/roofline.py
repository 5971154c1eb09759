"""How near the compiled march comes to what the core's memory can do: ``make roofline``.

Counts the bytes of every pass of a step from the arrays themselves, marches a train of waves over
sheets of 10^4 to 10^6 nodes, and compares with copying in the level of the memory that the arrays
fit into. Also: two threads against one, and the memory that a march takes. Prints a table and
writes benchmarks/results/roofline.json.
"""

import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from time import perf_counter

import numpy as np
from results import write
from sheets import operators_of, sheet

from cardiosurf.fem.operators import Operators
from cardiosurf.kinetics import RogersMcCulloch
from cardiosurf.stepping.compiled.engine import Engine
from cardiosurf.stepping.schemes import SCHEMES

HERE = Path(__file__).parent
NODES = (10_000, 40_000, 160_000, 1_000_000)
THREADED, HELD = 100_000, 160_000
EDGE, STEP, TOLERANCE = 2.0, 1.0, 1e-7
SECONDS = 6.0
FIXED = 3.0
"""Iterations a step that costs are compared at."""


def cache(index: int, default: int) -> int:
    """Return the size of a cache, in bytes."""
    path = Path(f"/sys/devices/system/cpu/cpu0/cache/index{index}/size")
    return int(path.read_text().strip().rstrip("K")) * 1024 if path.exists() else default


LEVELS = {"L2": cache(2, 2**20), "L3": cache(3, 2**25)}


def level(size: float) -> str:
    """Return the level of the memory that a working set lies in."""
    return next((name for name, room in LEVELS.items() if size <= room), "DRAM")


def copied(size: int) -> float:
    """Return the bandwidth of copying in so many bytes, read and written, in GB/s."""
    source, target = np.ones((2, size // 16))
    repeats = max(1, 2**24 // size)
    took = []
    for _ in range(100 if size < LEVELS["L3"] // 2 else 20):
        begun = perf_counter()
        for _ in range(repeats):
            np.copyto(target, source)
        took.append((perf_counter() - begun) / repeats)
    return 2 * source.nbytes / min(took) / 1e9


def copying() -> dict[str, float]:
    """Return the bandwidth of copying in each level, in GB/s."""
    sizes = {"L2": LEVELS["L2"] // 2, "L3": LEVELS["L3"] // 2, "DRAM": 16 * LEVELS["L3"]}
    return {name: copied(size) for name, size in sizes.items()}


def passes(engine: Engine) -> dict[str, float]:
    """Return the bytes a node that each pass of a step reads and writes (sbdf2, no current)."""
    rows, work = engine._arrangement.rows, engine._work
    n = len(engine._arrangement.vertex)
    number, single = work.fields.itemsize, work.direction.itemsize
    columns = (rows.start.nbytes + rows.window.nbytes + rows.place.nbytes) / n
    mass, stiffness, system = (
        values.nbytes / n for values in (rows.mass, rows.stiffness, rows.system)
    )
    return {
        # u0 u1 u2 u3 v0 v1, lumped, D^-1/2, active in; guess, v, the two of ``pairs`` out
        "prepare": 12 * number + work.active.itemsize,
        # both matrices, their columns, the pairs, lumped, D^-1/2 in; the direction out
        "residual": mass + stiffness + columns + 4 * number + single,
        # the matrix, its columns, p in, q out; r from the second iteration on
        "first multiply": system + columns + 2 * single,
        "multiply": system + columns + 3 * single,
        # p, q in; p, r, x out
        "first update": 5 * single,
        # p, r, q, x in; p, r, x out
        "update": 7 * single,
        # p, x, u, D^-1/2, the state before in; u out
        "finish": 4 * number + 2 * single,
    }


def of_a_step(each: dict[str, float], iterations: float) -> float:
    """Return the bytes a node of a step with so many iterations."""
    more = max(iterations - 1.0, 0.0)
    once = each["prepare"] + each["residual"] + each["finish"]
    first = min(iterations, 1.0) * each["first multiply"]
    # the last iteration has no update, so the first one comes with the second iteration
    updates = min(more, 1.0) * each["first update"] + max(more - 1.0, 0.0) * each["update"]
    return once + first + more * each["multiply"] + updates


def held(engine: Engine) -> float:
    """Return the bytes that a step works on."""
    rows, work = engine._arrangement.rows, engine._work
    vectors = (work.fields, work.pairs, work.direction, work.active)
    return sum(a.nbytes for a in rows) + sum(vector.nbytes for vector in vectors)


def waves(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return two equal states with a front every 100 su."""
    near = np.abs(points[:, 0] % 100.0 - 20.0) - 8.0
    u = 1.0 / (1.0 + np.exp(np.clip(near / 1.5, -99.0, 99.0)))
    state = np.array((u, np.zeros_like(u)))
    return state, state


def marched(points: np.ndarray, operators: Operators, threads: int) -> tuple[Engine, list]:
    """March the waves for some seconds; return the engine and (seconds, iterations) a step."""
    engine = Engine(
        operators,
        RogersMcCulloch(),
        SCHEMES["sbdf2"],
        tolerance=TOLERANCE,
        watch=np.zeros(0, dtype=np.int64),
        threads=threads,
    )
    engine.load(waves(points))
    count = int(np.clip(2e5 / len(points), 4, 64))
    time, found, begun = 0.0, [], perf_counter()
    while len(found) < 12 or (perf_counter() - begun < SECONDS and time < 400.0):
        leg = engine.go(time + STEP * np.arange(count + 1), STEP, None, pending=True)
        time += STEP * leg.steps
        # the first strides find their way from the made-up state
        if time > 10.0 * STEP:
            found.append((leg.marching / leg.steps, leg.iterations / leg.steps))
    return engine, found


def measure(nodes: int) -> dict[str, float | str | int]:
    """Return what a step costs on a sheet of about so many nodes.

    The bound is that of a copy in as many bytes as the step works on: caches are shared with
    others, and one that a working set fits into by its size need not hold it.
    """
    points, triangles = sheet(nodes, EDGE)
    operators = operators_of(points, triangles)
    n = len(points)
    neighbours = np.diff(operators.stiffness.indptr) - 1
    engine, found = marched(points, operators, 1)
    each = passes(engine)
    seconds, iterations = min(found, key=lambda f: f[0] / of_a_step(each, f[1]))
    size, where = held(engine), level(held(engine))
    bound = copied(int(size))
    size_of_step = of_a_step(each, iterations)
    speed = size_of_step * n / seconds / 1e9
    return {
        "nodes": n,
        "with six neighbours": float((neighbours == 6).mean()),
        "ns a node and step": seconds / n * 1e9,
        "iterations a step": iterations,
        "bytes a node and step": size_of_step,
        "ns a node at 3 iterations": seconds / n * 1e9 * of_a_step(each, FIXED) / size_of_step,
        "GB/s": speed,
        "working set, MB": size / 1e6,
        "level": where,
        "copy, GB/s": bound,
        "share of the bound": speed / bound,
        "bytes a node of each pass": each,
    }


def threads_ratio() -> dict[str, float]:
    """Return how much sooner two threads have done a step than one."""
    points, triangles = sheet(THREADED, EDGE)
    operators = operators_of(points, triangles)

    def best_of(points: np.ndarray, operators: Operators, threads: int) -> float:
        engine, found = marched(points, operators, threads)
        each = passes(engine)
        # as if all steps had taken the same number of iterations
        fixed = [f[0] * of_a_step(each, FIXED) / of_a_step(each, f[1]) for f in found]
        return min(fixed)

    # turn by turn, as what else the machine does comes and goes
    turns = [[best_of(points, operators, k) for k in (1, 2)] for _ in range(3)]
    best = dict(zip((1, 2), np.min(turns, axis=0).tolist(), strict=True))
    # what the machine gives at all: its cores may share arithmetic, caches and memory
    points, triangles = sheet(THREADED // 2, EDGE)
    half = operators_of(points, triangles)
    with ThreadPoolExecutor(2) as pool:
        both = [pool.submit(best_of, points, half, 1) for _ in range(2)]
        apart = [march.result() for march in both]
    return {
        "nodes": operators.mass.shape[0],
        "one, ms": 1e3 * best[1],
        "two, ms": 1e3 * best[2],
        "ratio": best[1] / best[2],
        "ratio of two halves at once": best[1] / max(apart),
    }


def memory() -> dict[str, float]:
    """Return the memory of a march, measured in a process of its own."""
    done = subprocess.run(
        [sys.executable, str(HERE / "memory.py"), str(HELD)],
        check=True,
        capture_output=True,
        text=True,
    )
    return json.loads(done.stdout)


def main() -> None:
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(cores)})
    copy = copying()
    print("copying, GB/s:", ", ".join(f"{k} {v:.0f}" for k, v in copy.items()))
    sizes = []
    for nodes in NODES:
        found = measure(nodes)
        if not sizes:
            each = found["bytes a node of each pass"]
            print("bytes a node:", ", ".join(f"{k} {v:.0f}" for k, v in each.items()))
            print("   nodes  ns/node  iterations  at 3  GB/s  copy     MB  level  share")
        sizes.append(found)
        print(
            f"{found['nodes']:8} {found['ns a node and step']:8.1f}"
            f" {found['iterations a step']:11.2f} {found['ns a node at 3 iterations']:5.1f}"
            f" {found['GB/s']:5.0f} {found['copy, GB/s']:5.0f} {found['working set, MB']:6.1f}"
            f"  {found['level']:5}"
            f" {100 * found['share of the bound']:5.0f} %",
            flush=True,
        )
    costs = [found["ns a node at 3 iterations"] for found in sizes]
    growth = costs[-1] / costs[0]
    print(f"cost from 10^4 to 10^6 nodes, at equal iterations: {growth:.2f} times")
    os.sched_setaffinity(0, cores)
    threads = threads_ratio() if len(cores) > 1 else {}
    if threads:
        print(f"two threads at {threads['nodes']} nodes: {threads['ratio']:.2f} times one")
        alone = threads["ratio of two halves at once"]
        print(f"  (two marches of half the size at once: {alone:.2f} times)")
    taken = memory()
    print(f"memory of a march, bytes a node: {taken['peak']:.0f} at its peak,")
    print(f"  of which it is handed {taken['handed over']:.0f} at the start")
    write(
        "roofline",
        {
            "copying, GB/s": copy,
            "sizes": sizes,
            "growth": growth,
            "threads": threads,
            "memory": taken,
        },
    )


if __name__ == "__main__":
    main()
