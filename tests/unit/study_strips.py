"""Runs of a tenth of a second, and a scenario made of them."""

BASE = """\
name: strip
geometry: {kind: plane, x: [0, 80], y: [0, 10]}
mesh: {edge_length: 5}
stimulus: [{shape: edge, edge: left}]
time: {end: 900, step: 3}
record: {frames_every: null, probes: [{name: middle, at: [40, 5, 0]}]}
targets: [{name: far, region: {box: {x: [60, 80]}}}]
"""
WALL = "{patches: [{name: wall, region: {box: {x: [25, 55]}}, excitable: false}]}"
SCENARIO = f"""\
name: strips
base: base.yaml
cases:
  - name: free
    published: conduction
    expect: {{verdict: conduction, far: conduction}}
  - name: walled
    set: {{tissue: {WALL}}}
    published: block
    expect: {{verdict: block, far: block}}
pairs:
  - {{name: both, forward: free, backward: walled, target: far, expect: unidirectional}}
grid: {{mesh.edge_length: [4, 5]}}
"""


def write_scenario(folder, text=SCENARIO, base=BASE):
    """Write a scenario and its base; return the scenario's path."""
    folder.mkdir(exist_ok=True)
    (folder / "base.yaml").write_text(base)
    path = folder / "scenario.yaml"
    path.write_text(text)
    return path
