"""What one picture shows: whole periods of a settled run, or the last periods of a live one."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from granchain_core import Run, Scene

_FEWEST, _MOST, _STEP = 96, 384, 48
_PER_CONTACT_TIME = 1.5
"""Rows while the contacts' own time 1/φ passes: a pulse stays on a bead for about three of these times."""
_LARGEST = 60_000
"""Values of one quantity in a picture; beyond it rows are left out, because nobody sees them."""

LIVE_PERIODS = 4
SETTLED_PERIODS, _REPEATED = 4, 4

_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"),
             (1e-12, "p"), (1e-15, "f"), (1e-18, "a"))


def prefixed(largest: float) -> tuple[float, str]:
    """The factor and letter of the SI prefix in which `largest` reads between 1 and 1000."""
    for factor, letter in _PREFIXES:
        if largest >= factor:
            return factor, letter
    return 1.0, ""


def round_up(value: float) -> float:
    """The next of a few steps in every decade: a scale that keeps still while a knob moves."""
    if not value > 0.0 or not np.isfinite(value):
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    steps = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)
    return float(next((step * power for step in steps if value <= step * power), 10.0 * power))


@dataclass(frozen=True)
class Frames:
    """Rows in time, equally spaced; `time` in seconds or, when live, in drive periods before now."""

    samples: int
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


_SERIES = tuple(field.name for field in fields(Frames) if field.name not in ("samples", "time"))


def samples_for(scene: Scene) -> int:
    """Rows per drive period: as many as the pulses need, which are short in a slow drive."""
    rate = np.sqrt(scene.K * np.sqrt(scene.A0) / scene.bead(1).mass)
    needed = _STEP * round(_PER_CONTACT_TIME * rate / scene.f / _STEP)
    return int(min(max(needed, _FEWEST), _MOST))


def settled_frames(run: Run) -> Frames:
    """Whole periods from time 0, the orbit repeated until one sees that it repeats.

    What is not periodic does not repeat, and is shown as it was recorded.
    """
    rows = len(run.time)
    periods = max(1, round((rows - 1) / run.samples))
    copies = max(-(-SETTLED_PERIODS // periods), 2 if periods <= _REPEATED else 1)
    if run.regime.name != "periodic":
        copies = 1
    values = copies * rows * run.displacement.shape[1]
    stride = next((n for n in (1, 2, 3, 4) if values <= n * _LARGEST), 6)
    index = np.concatenate([np.arange(0, rows - 1, stride) for _ in range(copies)] + [np.array([rows - 1])])
    samples = run.samples // stride
    time = np.arange(len(index)) / (samples * run.scene.f)
    return Frames(samples, time, **{name: getattr(run, name)[index] for name in _SERIES})


class LiveWindow:
    """The last few periods of a live run; every row knows how many drive periods ago it was."""

    def __init__(self, samples: int, periods: int = LIVE_PERIODS) -> None:
        self._samples = samples
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
        return Frames(self._samples, self._time, **self._series)
