"""What is where in a recording's HDF5 file: one line a dataset, with its unit and meaning.

n nodes, m triangles, e events, k frames, s steps, p probes. docs/recording.md says the same in
prose; the file carries these words as attributes of the datasets.
"""

from dataclasses import dataclass

SCHEMA = "cardiosurf/recording/1"


@dataclass(frozen=True)
class Entry:
    """A dataset.

    Attributes
    ----------
    units, description : str
        Unit and meaning; ``units`` is empty for numbers that have none.
    packed : bool
        Whether it is compressed: masks, labels and what repeats shrink to some per cent, other
        numbers take long and hardly do.
    """

    units: str
    description: str
    packed: bool = False


DATASETS = {
    "mesh/points": Entry("su", "vertices (n, 3)"),
    "mesh/triangles": Entry("", "vertex numbers (m, 3), consistently oriented"),
    "mesh/parts": Entry("", "names of the surface's parts"),
    "mesh/part_of": Entry("", "index into parts, a triangle (m,)", packed=True),
    "mesh/axes": Entry("", "names of the two net axes of each part"),
    "mesh/frame": Entry("", "unit vectors e1, e2 of the net in each triangle (m, 2, 3)"),
    "mesh/net": Entry("su or rad", "net coordinates of each triangle's centroid (m, 2)"),
    "mesh/edge_names": Entry("", "names of the open edges"),
    "mesh/edge_vertices": Entry("", "pairs of vertex numbers along the open edges"),
    "mesh/edge_of": Entry("", "index into edge_names, a pair", packed=True),
    "mesh/region_names": Entry("", "regions whose edges the mesh resolves"),
    "mesh/region_triangles": Entry(
        "", "1 where a triangle is in the region (regions, m)", packed=True
    ),
    "tissue/tensor": Entry("su^2/tu", "diffusivity tensor of each triangle (m, 3, 3)"),
    "tissue/d11": Entry("su^2/tu", "diffusivity along the first net axis (m,)"),
    "tissue/d22": Entry("su^2/tu", "diffusivity along the second net axis (m,)"),
    "tissue/fibre": Entry(
        "", "unit vector along the greatest diffusivity, 0 where there is none (m, 3)", packed=True
    ),
    "tissue/excitable": Entry("", "1 where the tissue is excitable, 0 in scar (m,)", packed=True),
    "tissue/names": Entry("", "names of the patches, in the order of the config"),
    "tissue/patch_of": Entry(
        "", "patch that rules in a triangle, -1 = ambient tissue (m,)", packed=True
    ),
    "targets/names": Entry("", "targets of the config, in its order"),
    "targets/triangles": Entry("", "1 where a triangle is in the target (targets, m)", packed=True),
    "pulses/times": Entry("tu", "start of each pulse"),
    "pulses/durations": Entry("tu", "its duration; 0 = u was set at once"),
    "pulses/labels": Entry("", "stimulus of the config and beat"),
    "pulses/profiles": Entry(
        "", "its strength at each node (pulses, n): of u, or with a duration in 1/tu", packed=True
    ),
    "activation/nodes": Entry("", "vertex of each activation, in the order of time (e,)"),
    "activation/times": Entry("tu", "time at which u rises through 0.5 (e,)"),
    "activation/first": Entry("tu", "LAT: first activation of each node, NaN = never (n,)"),
    "activation/last": Entry("tu", "last activation of each node, NaN = never (n,)"),
    "activation/count": Entry("", "how often each node was activated (n,)", packed=True),
    "repolarisation/nodes": Entry("", "vertex of each repolarisation, in the order of time (e,)"),
    "repolarisation/times": Entry("tu", "time at which u falls through 0.5 (e,)"),
    "repolarisation/first": Entry("tu", "first repolarisation of each node, NaN = never (n,)"),
    "frames/times": Entry("tu", "times of the frames (k,)"),
    "frames/u": Entry("", "potential u, 0 = rest, about 1 = excited (k, n)"),
    "frames/v": Entry("", "recovery variable v (k, n)"),
    "probes/names": Entry("", "names of the probes"),
    "probes/positions": Entry("su", "places of the probes on the surface (p, 3)"),
    "probes/times": Entry("tu", "times of all steps (s,)"),
    "probes/u": Entry("", "potential u at the probes (s, p)"),
    "probes/v": Entry("", "recovery variable v at the probes (s, p)"),
    "config/text": Entry("", "the resolved config, YAML"),
}
"""Every dataset but the frames under frames/by_time, which are views of frames/u and frames/v."""
