"""cardiosurf itself, with the interface of its peers: set_up and march, LAT the only observer."""

import sys
from dataclasses import replace
from pathlib import Path

from common import Stopwatch, arguments, report

from cardiosurf import __version__
from cardiosurf.recording.observers import Activation
from cardiosurf.stepping.march import march
from cardiosurf.stepping.rest import never
from cardiosurf.study.setup import set_up

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from problems import config_of, initial_u


def main() -> None:
    """Run the problem of the command line."""
    watch = Stopwatch()
    problem, given = arguments(__doc__)
    # the file tells which problem at which edge; the mesh is the same, made again
    setup = set_up(config_of(problem.problem, problem.edge, f"time.step={given.dt:g}"))
    surface = setup.surface
    start = initial_u(problem.problem, surface.points, surface.triangles)
    pulses = (replace(setup.pulses[0], profile=start),)
    # numba and the machine code are loaded, as the peers' are before their loops
    # handed over for one march, the matrices are taken here for two
    problem_set_up = replace(setup.problem, operators=setup.problem.take())
    march(problem_set_up, replace(setup.controls, end=5.0 * given.dt), [Activation()])
    activation = Activation()
    watch.start()
    march(replace(problem_set_up, pulses=pulses), setup.controls, [activation], stop=never)
    lat = activation.activations().first(len(surface.points))
    watch.stop()
    mesh = surface.points, surface.triangles
    report(given, problem, "cardiosurf", __version__, watch, lat, mesh=mesh)


if __name__ == "__main__":
    main()
