"""What one picture shows: whole periods of a settled run, or the last periods of a live one."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from granchain_core import Run

SAMPLES = 96
"""Rows of a picture per drive period: smooth at 60 frames a second down to half a period a second."""

LIVE_PERIODS = 4
SETTLED_PERIODS = 3

_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"),
             (1e-12, "p"), (1e-15, "f"), (1e-18, "a"))


def prefixed(largest: float) -> tuple[float, str]:
    """The factor and letter of the SI prefix in which `largest` reads between 1 and 1000."""
    for factor, letter in _PREFIXES:
        if largest >= factor:
            return factor, letter
    return 1.0, ""


def round_up(value: float) -> float:
    """The next of 1, 1.5, 2, 3, 5, 7 times a power of ten: a scale that keeps still while a knob moves."""
    if not value > 0.0 or not np.isfinite(value):
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(next((step * power for step in (1.0, 1.5, 2.0, 3.0, 5.0, 7.0) if value <= step * power),
                      10.0 * power))


@dataclass(frozen=True)
class Frames:
    """Rows in time, equally spaced; `time` in seconds or, when live, in drive periods before now."""

    time: np.ndarray
    displacement: np.ndarray
    kinetic_energy: np.ndarray
    force: np.ndarray
    drive_displacement: np.ndarray
    input_force: np.ndarray
    output_force: np.ndarray
    output_force_elastic: np.ndarray

    @property
    def rows(self) -> int:
        """How many instants there are."""
        return len(self.time)

    @property
    def beads(self) -> int:
        """How many beads there are."""
        return self.displacement.shape[1]


_SERIES = tuple(field.name for field in fields(Frames) if field.name != "time")


def settled_frames(run: Run) -> Frames:
    """Whole periods from time 0, the orbit repeated until a travelling wave can be followed by eye."""
    rows = len(run.time)
    periods = max(1, round((rows - 1) / run.samples))
    copies = -(-SETTLED_PERIODS // periods)
    index = np.concatenate([np.arange(rows - 1) for _ in range(copies)] + [np.array([rows - 1])])
    time = np.arange(len(index)) / (run.samples * run.scene.knobs["f"])
    return Frames(time, **{name: getattr(run, name)[index] for name in _SERIES})


class LiveWindow:
    """The last few periods of a live run; every row knows how many drive periods ago it was."""

    def __init__(self, periods: int = LIVE_PERIODS, samples: int = SAMPLES) -> None:
        self._rows = periods * samples + 1
        self._time = -np.arange(self._rows)[::-1] / samples
        self._series: dict[str, np.ndarray] = {}

    def add(self, run: Run) -> Frames:
        """The window after `run`, whose first row is the last one already shown."""
        for name in _SERIES:
            new = np.asarray(getattr(run, name))
            old = self._series.get(name)
            if old is None or old.shape[1:] != new.shape[1:]:
                old = np.zeros((self._rows, *new.shape[1:]))
            self._series[name] = np.concatenate([old, new[1:]])[-self._rows:]
        return Frames(self._time, **self._series)
