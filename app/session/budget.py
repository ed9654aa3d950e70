"""Limits on one session's requests: the estimated time of a picture and of a curve."""

from __future__ import annotations

import functools

from granchain_core import BadInput, Scene
from granchain_core.runs.budget import picture_seconds, refuse_long_picture

from ..frames import PERIODS, samples_for
from .scene_facts import slider_range

#: Longest time of a first picture, unless the visitor asks for it anyway [s].
FIRST_PICTURE = 5.0
#: Processor time after which the search for a picture's steady state is given up [s].
WHOLE_PICTURE = 120.0
#: Longest time of a resonance curve that the page computes unasked [s].
UNASKED_CURVE = 120.0

#: Drive periods before and in the first picture.
_FIRST_PICTURE_PERIODS = 2 + PERIODS
#: Drive periods of all points of a curve: about 75 to 150 points of a hundred periods.
_CURVE_PERIODS = 10_000


def check_first_picture(scene: Scene) -> None:
    """Raise `OverBudget` if the first picture would take too long; the message says what would fit."""
    refuse_long_picture(scene, _FIRST_PICTURE_PERIODS, samples_for(scene), FIRST_PICTURE)


class RefusedPicture(BadInput):
    """The picture of a scene would take or took too long; the visitor may ask for it anyway."""

    def __init__(self, scene: Scene, sentence: str) -> None:
        super().__init__(sentence)
        self.scene = scene


class TooLong(BadInput):
    """The steady state was not found within the time of one picture."""

    def __init__(self) -> None:
        super().__init__(f"After {WHOLE_PICTURE:g} s of computing, this chain has not settled; the picture shows the "
                         "motion so far.")


@functools.lru_cache(maxsize=64)
def curve_affordable(scene: Scene) -> bool:
    """Return whether the scene has a curve that is short enough to be computed unasked.

    The time is estimated at the frequency in the middle of the range.
    """
    if not scene.is_driven:
        return False
    low, high = slider_range(scene, "f")
    return picture_seconds(scene.evolve(f=0.5 * (low + high)), _CURVE_PERIODS, 1) <= UNASKED_CURVE
