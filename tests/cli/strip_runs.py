"""A config small enough for a run of less than a second."""

STRIP = """\
name: strip
geometry: {kind: plane, x: [0, 80], y: [0, 10]}
mesh: {edge_length: 2.5}
stimulus:
  - {shape: edge, edge: left}
time: {end: 900, step: 1}
record:
  frames_every: 50
  probes: [{name: middle, at: [40, 5, 0]}]
targets:
  - {name: far, region: {box: {x: [60, 80]}}}
"""
QUICK = ("--set", "mesh.edge_length=5", "--set", "time.step=3")
