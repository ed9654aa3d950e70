"""The time samples of a picture: whole periods of a settled motion, or the last periods of a live run."""

from __future__ import annotations

import threading
import weakref
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from granchain_core import Run, Scene
from granchain_core.integrate.scaling import scales_of

#: Smallest number of rows per drive period.
_FEWEST_ROWS = 96
#: Largest number of rows per drive period.
_MOST_ROWS = 384
#: The number of rows per drive period is a multiple of this.
_ROW_STEP = 48
#: Rows per contact time 1/φ; a pulse passes a bead in about three contact times.
_ROWS_PER_CONTACT_TIME = 1.5
#: Largest number of values of one quantity in a picture. Beyond it, rows are dropped; the difference is not visible.
_MOST_VALUES = 60_000

#: Drive periods in a live picture, and the fewest in a settled picture; a longer orbit is shown once.
PERIODS = 4


def round_up(value: float) -> float:
    """Round up to one of ten steps per decade, so that a scale stays still while a knob moves."""
    if not value > 0.0 or not np.isfinite(value):
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    steps = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)
    return float(next((step * power for step in steps if value <= step * power), 10.0 * power))


@dataclass(frozen=True)
class Frames:
    """Equally spaced rows in time; `time` is in seconds, or in drive periods before now for a live run.

    `input_jumps` and `output_jumps` (J, 2) are the times at which a force jumps from 0 between rows, and the forces
    that it reaches [N].
    """

    samples: int
    time: np.ndarray
    displacement: np.ndarray
    kinetic_energy: np.ndarray
    force: np.ndarray
    drive_displacement: np.ndarray
    input_force: np.ndarray
    output_force: np.ndarray
    output_force_elastic: np.ndarray
    input_jumps: np.ndarray
    output_jumps: np.ndarray

    @property
    def largest_output(self) -> float:
        """The largest output force in the picture, jumps included [N]."""
        return float(max(self.output_force.max(), self.output_jumps[:, 1].max(initial=-np.inf)))

    @cached_property
    def extremes(self) -> Extremes:
        """The largest values; forces include the top of each jump, displacements the driver's."""
        driver, wall = self.drive_displacement[:, None], np.zeros((self.rows, 1))
        displacement = np.concatenate([driver, self.displacement, wall], axis=1)
        return Extremes(
            input_force=float(max(self.input_force.max(), self.input_jumps[:, 1].max(initial=0.0))),
            output_force=self.largest_output,
            kinetic_energy=float(self.kinetic_energy.max()),
            displacement=float(np.abs(displacement).max()),
            overlap=float(max((displacement[:, :-1] - displacement[:, 1:]).max(), 0.0)),
            input_pull=float(max(-self.input_force.min(), 0.0)),
            output_pull=float(max(-min(self.output_force.min(), self.output_force_elastic.min()), 0.0)))

    @cached_property
    def chain(self) -> np.ndarray:
        """The values from which the browser draws the chain, in single precision: see `chain_series`."""
        return drawn_values(chain_series(self.displacement, self.force, self.kinetic_energy, self.drive_displacement))

    @property
    def rows(self) -> int:
        """The number of instants."""
        return len(self.time)

    @property
    def beads(self) -> int:
        """The number of beads."""
        return self.displacement.shape[1]


@dataclass(frozen=True)
class Extremes:
    """The largest values of one or more pictures [N, N, J, m, m, N, N].

    The overlap is the largest between two touching bodies. A pull is the largest amount by which a force falls below 0.
    """

    input_force: float = 0.0
    output_force: float = 0.0
    kinetic_energy: float = 0.0
    displacement: float = 0.0
    overlap: float = 0.0
    input_pull: float = 0.0
    output_pull: float = 0.0

    def widened(self, other: Extremes) -> Extremes:
        """Return the larger of the two values of each quantity."""
        return Extremes(**{name: max(value, getattr(other, name)) for name, value in self.items()})

    def items(self) -> Iterator[tuple[str, float]]:
        """Iterate over names and values."""
        return ((field.name, getattr(self, field.name)) for field in fields(self))


def chain_series(displacement: np.ndarray, force: np.ndarray, energy: np.ndarray,
                 drive: np.ndarray) -> list[np.ndarray]:
    """Return a chain's series, (T, N), (T, N + 1), (T, N) and (T,), in the order of `unpack` in chain_series.js."""
    return [series.ravel() for series in (displacement, force, energy, drive)]


def drawn_values(series: Sequence[np.ndarray]) -> np.ndarray:
    """Return series joined into one array, because every array is two messages on the websocket."""
    return np.concatenate(series, dtype=np.float32)


_SERIES = tuple(field.name for field in fields(Frames)
                if field.name not in ("samples", "time", "input_jumps", "output_jumps"))


def with_jumps(time: np.ndarray, force: np.ndarray, jumps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a force train as a line with vertical jumps (J, 2); each adds two points, at 0 and at its force."""
    if not len(jumps):
        return time, force
    rows = np.searchsorted(time, jumps[:, 0])
    feet = np.zeros(len(jumps))
    twice = np.repeat(rows, 2)
    return (np.insert(time, twice, np.repeat(jumps[:, 0], 2)),
            np.insert(force, twice, np.stack([feet, jumps[:, 1]], axis=1).ravel()))


def jumps_of(run: Run, contact: int) -> np.ndarray:
    """Return times since the run's first row [s] and forces [N] of one contact's jumps (J, 2), in order."""
    time, force = run.jumps.of(contact)
    return np.stack([time - run.time[0], force], axis=1)


def samples_for(scene: Scene) -> int:
    """Return the rows per drive period: enough for the pulses, which are short compared with a long drive period.

    Without a drive, a picture covers one time 1/f and has as many rows as `PERIODS` periods would have with one.
    """
    shown = 1 if scene.is_driven else PERIODS
    needed = _ROW_STEP * round(shown * _ROWS_PER_CONTACT_TIME * scales_of(scene).phi / scene.f / _ROW_STEP)
    return int(min(max(needed, _FEWEST_ROWS), _MOST_ROWS))


def settled_frames(run: Run) -> Frames:
    """Return whole periods from time 0; a periodic orbit is shown often enough to see that it repeats.

    A motion that is not periodic is shown once, as recorded.
    """
    rows = len(run.time)
    periods = max(1, round((rows - 1) / run.samples))
    copies = max(-(-PERIODS // periods), 2 if periods <= PERIODS else 1)
    if run.regime.name != "periodic":
        copies = 1
    values = copies * rows * run.displacement.shape[1]
    stride = next((n for n in (1, 2, 3, 4) if values <= n * _MOST_VALUES), 6)
    index = np.concatenate([np.arange(0, rows - 1, stride) for _ in range(copies)] + [np.array([rows - 1])])
    samples = run.samples // stride
    time = np.arange(len(index)) / (samples * run.scene.f)
    shifts = [np.array([copy * periods / run.scene.f, 0.0]) for copy in range(copies)]
    pushed, passed = (np.concatenate([jumps_of(run, c) + shift for shift in shifts]) for c in (0, run.scene.N))
    return Frames(samples, time, **{name: getattr(run, name)[index] for name in _SERIES},
                  input_jumps=pushed, output_jumps=passed)


_PREPARED: weakref.WeakKeyDictionary[Run, weakref.ref[Frames]] = weakref.WeakKeyDictionary()
_LOCK = threading.Lock()


def prepared_frames(run: Run) -> Frames:
    """Return the frames of a settled run with everything drawing needs, shared by all sessions that show the run.

    The frames are cached as long as anything refers to them. A thread calls this before the event loop draws.
    """
    with _LOCK:
        known = _PREPARED.get(run)
        frames = None if known is None else known()
    if frames is None:
        frames = settled_frames(run)
        _ = frames.extremes, frames.chain
        with _LOCK:
            _PREPARED[run] = weakref.ref(frames)
    return frames


class LiveWindow:
    """The last few periods of a live run; the time of a row is given in drive periods before now."""

    def __init__(self, samples: int, periods: int = PERIODS) -> None:
        self._samples = samples
        self._rows = periods * samples + 1
        self._time = -np.arange(self._rows)[::-1] / samples
        self._series: dict[str, np.ndarray] = {}
        self._jumps = {name: np.zeros((0, 2)) for name in ("input_jumps", "output_jumps")}

    def add(self, run: Run) -> Frames:
        """Append `run` and return the window; the run's first row is the last row that is already shown."""
        for name in _SERIES:
            new = np.asarray(getattr(run, name))
            old = self._series.get(name)
            if old is None or old.shape[1:] != new.shape[1:]:
                old = np.zeros((self._rows, *new.shape[1:]))
            self._series[name] = np.concatenate([old, new[1:]])[-self._rows:]
        passed = np.array([(len(run.time) - 1) / self._samples, 0.0])
        for name, contact in (("input_jumps", 0), ("output_jumps", run.scene.N)):
            both = np.concatenate([self._jumps[name], jumps_of(run, contact) * np.array([run.scene.f, 1.0])]) - passed
            self._jumps[name] = both[both[:, 0] >= self._time[0]]
        return Frames(self._samples, self._time, **self._series, **self._jumps)
