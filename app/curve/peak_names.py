"""The names of the peaks, the valleys and the stop band of the curve from rest, which the page shows as buttons.

Each name follows from a computation at its place. The extrema are those that stand out from both neighbours by 20 %
(`steady/curve/resonance.py`). At each of them, the chain is settled once more and its driver's pushes are counted. A
peak is named after these: 1:3 for one strong push in three periods. A valley is an anti-resonance if every period has
one push. The stop band begins after the last peak, at the frequency above which less than 15 % of the input force
arrives.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from functools import partial
from typing import Any

import numpy as np

from granchain_core import CurvePoint, Scene, settle
from granchain_core.execution.stop import Stop
from granchain_core.experiment import Feature
from granchain_core.steady.curve.resonance import (
    STOP_BAND_FRACTION,
    Place,
    peaks_and_valleys,
    place_words,
    push_words,
    pushes,
)

from ..frames import samples_for
from ..serve.computing.shared import Shared
from ..serve.computing.turns import TurnFlag
from ..serve.computing.worker_pools import ANALYSES, CURVE_WORK
from ..session.host import WorkHost
from ..session.scene_facts import without_frequency
from ..session.task import Job, Task, report_nothing

#: Smallest number of points in a stop band.
_FEWEST_BAND_POINTS = 3


def extreme_points(points: Sequence[CurvePoint]) -> list[tuple[str, CurvePoint]]:
    """Return "peak" or "valley", and the point, for each extremum that stands out; frequencies ascend."""
    peaks, valleys = peaks_and_valleys(np.array([point.max_output_force for point in points]))
    return [("peak" if i in peaks else "valley", points[i]) for i in sorted([*peaks, *valleys])]


def stop_band(points: Sequence[CurvePoint]) -> tuple[CurvePoint, CurvePoint] | None:
    """Return the first and last points of the stop band of a curve in ascending frequency; None if there is none."""
    peaks = [point.frequency for kind, point in extreme_points(points) if kind == "peak"]
    if not peaks:
        return None
    beyond = [point for point in points if point.frequency > peaks[-1]]
    passing = [i for i, point in enumerate(beyond)
               if point.max_output_force >= STOP_BAND_FRACTION * point.max_input_force]
    band = beyond[passing[-1] + 1 if passing else 0:]
    return (band[0], band[-1]) if len(band) >= _FEWEST_BAND_POINTS else None


def extremum_name(kind: str, point: CurvePoint, scene: Scene, stop: Stop | None = None) -> dict[str, Any] | None:
    """Return the name of an extremum, found from the motion there; None if it gives none. Raises `Cancelled`."""
    at = scene.evolve(f=round(point.frequency, 1))
    pushed = pushes(settle(at, samples=samples_for(at), stop=stop).run)
    if pushed is None or (kind == "valley" and pushed != (1, 1)):
        return None
    words = f"{place_words(pushed, Place(kind, point.frequency, point.regime.period))}: {push_words(pushed)}"
    return {"kind": kind, "name": f"{pushed[0]}:{pushed[1]}" if kind == "peak" else "anti-resonance", "words": words,
            "f": at.f, "force": point.max_output_force}


def band_name(band: tuple[CurvePoint, CurvePoint]) -> dict[str, Any]:
    """Return the name of the stop band, placed at its middle."""
    first, last = band
    return {"kind": "band", "name": "stop band", "words": f"stop band from {first.frequency:.0f} Hz",
            "f": round(0.5 * (first.frequency + last.frequency), 1), "force": max(first.max_output_force,
                                                                                  last.max_output_force)}


def stated_name(feature: Feature) -> dict[str, Any]:
    """Return the name of a peak or valley stated in the paper, at its frequency: "1:1", or "1:1 anti" for a valley."""
    ratio = feature.kind.split()[0]
    return {"kind": "stated", "name": ratio if feature.is_resonance else f"{ratio} anti", "f": feature.frequency,
            "words": f"stated in the paper: {feature.kind} at {feature.frequency:g} Hz, {feature.repeats} repeats"}


def _extremum_names(extremes: Sequence[tuple[str, CurvePoint]], scene: Scene,
                    stop: TurnFlag) -> Iterator[dict[str, Any] | None]:
    """Yield the names of the extrema, one after another. Raises `Cancelled`."""
    for kind, point in extremes:
        yield extremum_name(kind, point, scene, stop)


#: Names for all sessions: when a class of students looks at one curve, its dozen extrema are settled only once, which
#: takes a second.
NAMES_SHARED: Shared[dict[str, Any] | None] = Shared(CURVE_WORK, 2_000_000, lambda name: 1000, turns=False)


class PeakNames:
    """Names the places of a complete curve in the background; `show` is called with all names at once."""

    def __init__(self, host: WorkHost, show: Callable[[list[dict[str, Any]]], None]) -> None:
        self._host = host
        self._show = show
        self._task = Task(host, ANALYSES, report_nothing, "Naming the peaks of the curve", report_to_host=True)

    def forget(self) -> None:
        """Remove the names, because the curve has changed."""
        self._task.cancel()
        self._show([])

    def name(self, points: Sequence[CurvePoint], scene: Scene) -> None:
        """Name the places of this curve of `scene`, whose points are in ascending frequency."""

        def work(job: Job) -> None:
            band = stop_band(points)
            places = [] if band is None else [band_name(band)]
            extremes = extreme_points(points)
            key = without_frequency(scene), tuple((kind, point.frequency) for kind, point in extremes)
            with closing(NAMES_SHARED.follow(key, partial(_extremum_names, extremes, scene), job.stop)) as names:
                for name in names:
                    job.give_way(lambda: self._host.busy)
                    job.stop.check()
                    places += [name] if name else []
            job.next_tick(self._show, sorted(places, key=lambda place: float(place["f"])))

        self._task.start(work)
