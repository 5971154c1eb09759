"""Phase singularities followed in time."""

from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.analysis.singularities import Singularities
from cardiosurf.arrays import Floats, Ints


@dataclass(frozen=True)
class Track:
    """One phase singularity from its birth to its death.

    Attributes
    ----------
    chirality : int
        1: the wave rotates counterclockwise about it, -1: clockwise (see ``Singularities``).
    times : (k,) float
        When it was seen, in tu.
    points : (k, 3) float
        Where, in su.
    triangles : (k,) int
        In which triangle.
    at_start, at_end : bool
        Whether it was there in the first frame, and in the last: then birth or death are not known.
    """

    chirality: int
    times: Floats
    points: Floats
    triangles: Ints
    at_start: bool
    at_end: bool

    @property
    def born(self) -> float:
        """Time of the first frame that shows it, in tu."""
        return float(self.times[0])

    @property
    def died(self) -> float | None:
        """Time of the last frame that shows it, in tu; None if that is the last of all."""
        return None if self.at_end else float(self.times[-1])

    @property
    def lifetime(self) -> float:
        """From the first to the last frame that shows it, in tu."""
        return float(self.times[-1] - self.times[0])

    @property
    def path_length(self) -> float:
        """How far it went, from frame to frame, in su."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())

    def core(self, duration: float) -> tuple[Floats, float]:
        """Return the mean position (3,) in its last ``duration`` tu, and the mean distance from it.

        For a rotor and one cycle these are the middle and the radius of the circle that its tip
        runs on, in su.
        """
        last = self.points[self.times > self.times[-1] - duration]
        middle = last.mean(axis=0)
        return middle, float(np.linalg.norm(last - middle, axis=1).mean())


def follow(singularities: Singularities, *, speed: float, slack: float) -> tuple[Track, ...]:
    """Follow phase singularities from frame to frame, the longest life first.

    Between two frames each goes on as the one of its own chirality that keeps the sum of all
    distances least, if that is no farther than ``speed`` times the time between them plus
    ``slack``. One that does not go on has died, and one that goes on from nothing is born.

    Parameters
    ----------
    singularities : Singularities
        Of all frames.
    speed : float
        How fast a singularity may move, in su/tu.
    slack : float
        By how much it may be off besides: an edge length or two, in su.
    """
    times, count = singularities.times, len(singularities.times)
    of_frame = np.split(np.arange(len(singularities.frames)), np.cumsum(singularities.counts)[:-1])
    ended: list[list[int]] = []
    open_tracks: list[list[int]] = []
    for frame in range(count):
        here = of_frame[frame]
        reach = slack + speed * (times[frame] - times[frame - 1]) if frame else 0.0
        there = np.array([track[-1] for track in open_tracks], dtype=np.int64)
        old, new = _matched(singularities, there, here, reach)
        for one, other in zip(old, new, strict=True):
            open_tracks[one].append(int(here[other]))
        going_on, fresh = set(old.tolist()), np.delete(here, new)
        ended += [track for number, track in enumerate(open_tracks) if number not in going_on]
        open_tracks = [open_tracks[number] for number in sorted(going_on)]
        open_tracks += [[int(one)] for one in fresh]
    tracks = [_track(singularities, np.array(rows)) for rows in (*ended, *open_tracks)]
    return tuple(sorted(tracks, key=lambda track: (-track.lifetime, track.born)))


def _matched(
    singularities: Singularities, there: Ints, here: Ints, reach: float
) -> tuple[Ints, Ints]:
    """Return which of those there go on as which of those here: places in the two lists."""
    nothing = np.empty(0, dtype=np.int64)
    if not (there.size and here.size):
        return nothing, nothing
    apart = singularities.points[there][:, None] - singularities.points[here][None]
    distance = np.linalg.norm(apart, axis=2)
    chirality = singularities.chiralities
    possible = (chirality[there][:, None] == chirality[here]) & (distance <= reach)
    # what is not possible costs more than all that is
    cost = np.where(possible, distance, (1.0 + reach) * (len(there) + len(here)))
    old, new = scipy.optimize.linear_sum_assignment(cost)
    taken = possible[old, new]
    return old[taken], new[taken]


def _track(singularities: Singularities, rows: Ints) -> Track:
    frames = singularities.frames[rows]
    return Track(
        chirality=int(singularities.chiralities[rows[0]]),
        times=singularities.times[frames],
        points=singularities.points[rows],
        triangles=singularities.triangles[rows],
        at_start=bool(frames[0] == 0),
        at_end=bool(frames[-1] == len(singularities.times) - 1),
    )
