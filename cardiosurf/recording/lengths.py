"""Whether the arrays of a recording fit together."""

from cardiosurf.recording.recording import Recording


def check_lengths(recording: Recording) -> None:
    """Refuse arrays that do not fit together, before an analysis trips over them.

    Parameters
    ----------
    recording : Recording
        As it was read.

    Raises
    ------
    ValueError
        If arrays over the same triangles, vertices or events differ in length, or a vertex number
        is out of range.
    """
    surface, tissue = recording.surface, recording.tissue
    n, m = len(surface.points), len(surface.triangles)
    of_triangles = (
        surface.part_of,
        surface.frame,
        surface.net,
        tissue.tensor,
        tissue.excitable,
        tissue.patch_of,
        *surface.regions.values(),
        *recording.targets.values(),
    )
    pairs = [(len(array), m) for array in of_triangles]
    pairs += [(len(pulse.profile), n) for pulse in recording.pulses]
    events = (recording.activations, recording.repolarisations)
    pairs += [(len(of.times), len(of.nodes)) for of in events]
    if any(length != wanted for length, wanted in pairs):
        msg = "arrays in it do not fit together"
        raise ValueError(msg)
    for numbers in (surface.triangles, *(of.nodes for of in events)):
        if numbers.size and not 0 <= numbers.min() <= numbers.max() < n:
            msg = "vertex numbers in it are out of range"
            raise ValueError(msg)
