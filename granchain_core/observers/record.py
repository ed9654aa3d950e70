"""A measured force over time: checks, offset, gaps, and interpolation between samples.

Between the samples, the force is a monotone cubic (Fritsch & Carlson 1980, slopes of Fritsch & Butland 1984, as in
SciPy's PchipInterpolator). It passes through every sample and never goes beyond the two neighbouring ones: a force that
is never negative stays so, and between two zero samples it is zero. Its error is of order 2 to 3 in the spacing where
the force is smooth. Around the jump that a linear dashpot makes when its contact closes, the error of the force is of
order 1/2 in root mean square (tests/observers/test_sampling.py measures both), and that of the motion is of order 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ..errors import BadInput
from ..experiment.sensors import Sensors
from ..inputs.gaps import Gaps, sample_number, with_zeros
from ..inputs.text import number_in
from ..scene import Scene
from ..scene.hertz import HERTZ_DURATION, HERTZ_FORCE

#: Minimum number of samples over the shortest pulse with the record's largest force.
PULSE_SAMPLES = 4
#: A force whose smallest modulus is above this fraction of its largest may contain a sensor offset: a note says so.
_NEAR_ZERO = 0.02
#: Minimum number of samples in total.
FEWEST = 8
_PERFECT = Sensors()
#: Duration of a collision of two free beads of mass m with peak force F, over √(m/2) K^{−1/3} F^{−1/6}.
_HERTZ = HERTZ_DURATION * HERTZ_FORCE ** (1.0 / 6.0)


@dataclass(frozen=True, eq=False)
class ForceRecord:
    """Samples of a force: time (T,) [s], force (T,) [N], measured output force (T,) [N] or None.

    `place` names the place of a sample in its source for messages, "Line 7" or "Sample 6". `understood` describes how
    the record was read, and `notes` how it was treated. `put_in` are the indices of samples inserted into gaps.
    """

    time: np.ndarray
    force: np.ndarray
    output: np.ndarray | None = None
    place: Callable[[int], str] = sample_number
    understood: str = ""
    notes: tuple[str, ...] = field(default=())
    put_in: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))

    @property
    def spacing(self) -> float:
        """The usual (median) time between samples [s]."""
        return float(np.median(np.diff(self.time)))

    def thinned(self) -> tuple[ForceRecord, np.ndarray, np.ndarray]:
        """The record of a sensor half as fast, and the indices of its measured samples in this record and in that one.

        It has every second measured sample, including the first and the last. The zero force in gaps begins and ends
        next to the remaining samples, at twice the distance: the force falls to it half as fast, whichever sample was
        the last before a gap.
        """
        measured = np.delete(np.arange(len(self.time)), self.put_in)
        kept = np.unique(np.append(measured[::2], measured[-1]))
        gaps = np.unique(np.searchsorted(kept, self.put_in)) - 1
        spacing = 2.0 * float(np.median(np.diff(self.time[measured])))
        time, force, put_in = with_zeros(self.time[kept], self.force[kept], gaps, spacing)
        return ForceRecord(time, force, put_in=put_in), kept, np.delete(np.arange(len(time)), put_in)

    def cubics(self) -> np.ndarray:
        """Coefficients (T − 1, 4) of the force in every interval, constant term first, in N and s."""
        from scipy.interpolate import PchipInterpolator  # takes a quarter of a second to load, so only here

        return np.ascontiguousarray(PchipInterpolator(self.time, self.force).c[::-1].T)


def force_record(time: object, force: object, output: object = None) -> ForceRecord:
    """Make a record from arrays in SI. Raises `BadInput` naming the first sample that cannot be used."""
    arrays = [_array(name, values) for name, values in (("time", time), ("force", force))]
    given = None if output is None else _array("output", output)
    lengths = {len(a) for a in (*arrays, *(() if given is None else (given,)))}
    if len(lengths) != 1:
        raise BadInput(f"time, force and output must be equally long; they have "
                       f"{' and '.join(str(n) for n in sorted(lengths))} samples.")
    return checked(ForceRecord(arrays[0], arrays[1], given))


def _array(name: str, values: object) -> np.ndarray:
    try:
        array = np.array(values, dtype=float)
    except (TypeError, ValueError):
        raise BadInput(f"{name} must be numbers in one row, one per sample.") from None
    if array.ndim != 1:
        raise BadInput(f"{name} must be numbers in one row; its shape is {array.shape}.")
    return array


def checked(record: ForceRecord) -> ForceRecord:
    """Check that every number is finite and times ascend; return the record itself. Raises `BadInput`."""
    if len(record.time) < FEWEST:
        raise BadInput(f"There are {len(record.time)} samples of the force; at least {FEWEST} are needed.")
    for name in ("time", "force", "output"):
        values = getattr(record, name)
        if values is not None and not np.isfinite(values).all():
            at = int(np.flatnonzero(~np.isfinite(values))[0])
            raise BadInput(f"{record.place(at)}: {name} is {values[at]}, not a finite number; leave the sample out, "
                           "which makes a gap, or repair it.")
    steps = np.diff(record.time)
    if (steps <= 0.0).any():
        at = int(np.flatnonzero(steps <= 0.0)[0]) + 1
        raise BadInput(f"{record.place(at)}: time {record.time[at]:.9g} s does not come after "
                       f"{record.time[at - 1]:.9g} s of the previous sample; "
                       "samples must be in order of time, each time once.")
    return record


def prepared(record: ForceRecord, scene: Scene, offset: float | str = 0.0, gap: str = "refuse",
             sensors: Sensors = _PERFECT) -> ForceRecord:
    """Prepare the force to be applied: subtract the offset, treat gaps, and check the sampling for `scene`.

    `offset` is a force in N, or "median" for the median of all samples, which is the sensor's zero if the driver is out
    of contact for more than half of the time. Raises `BadInput` naming the sample.
    """
    notes = []
    zero = _offset(record, offset)
    if zero != 0.0:
        notes.append(f"offset of {zero:.4g} N subtracted")
    elif float(np.abs(record.force).min()) > _NEAR_ZERO * float(np.abs(record.force).max()) and scene.F0 == 0.0:
        notes.append(f"the force is nowhere below {np.abs(record.force).min():.3g} N: if that is the sensor's offset, "
                     "subtract it with --offset median, or --offset with its value (offset= in Python)")
    moved = ForceRecord(record.time, force=record.force - zero, output=record.output, place=record.place,
                        understood=record.understood)
    bridged = _bridged(moved, gap, notes)
    _check_sampling(moved, scene, sensors)
    return ForceRecord(bridged.time, force=bridged.force, output=bridged.output, place=bridged.place,
                       understood=bridged.understood, notes=tuple(notes), put_in=bridged.put_in)


def _offset(record: ForceRecord, offset: float | str) -> float:
    if offset == "median":
        return float(np.median(record.force))
    try:
        value = number_in(offset) if isinstance(offset, str) else float(offset)
    except (TypeError, ValueError, OverflowError):
        value = None
    if value is None or not np.isfinite(value):
        raise BadInput(f"offset {str(offset)[:30]!r} is neither a force in newtons nor 'median'.")
    return value


def _bridged(record: ForceRecord, gap: str, notes: list[str]) -> ForceRecord:
    """The samples with their gaps treated; zero force begins and ends one usual spacing from a gap's neighbours."""
    gaps = Gaps.of(record.time, record.place)
    treated = gaps.treated(gap, "a smooth curve across it", "force")
    if not treated:
        return record
    notes.append(treated)
    if gap == "interpolate":
        return record
    if record.output is not None:
        raise BadInput(f"{gaps.where}: a gap in a record with an output force can only be interpolated, since there is "
                       "no output force for inserted samples.")
    time, force, put_in = with_zeros(record.time, record.force, gaps.before, gaps.usual)
    return ForceRecord(time, force=force, output=None, place=record.place, understood=record.understood, put_in=put_in)


def shortest_pulse(scene: Scene, force: float) -> float:
    """Duration [s] of a collision of two of the chain's lightest beads with peak `force` [N]: no pulse is shorter."""
    reduced = 0.5 * float(scene.masses().min())
    stiffest = float(scene.contact_stiffness().max())
    return float(_HERTZ * np.sqrt(reduced) * stiffest ** (-1.0 / 3.0) * force ** (-1.0 / 6.0))


def _check_sampling(record: ForceRecord, scene: Scene, sensors: Sensors) -> None:
    largest = float(np.abs(record.force).max())
    if largest == 0.0:
        raise BadInput("The force is zero at every sample: nothing would move.")
    allowed = max(shortest_pulse(scene, largest), sensors.shortest_pulse) / PULSE_SAMPLES
    if record.spacing > allowed:
        worst = int(np.argmax(np.abs(record.force)))
        through = " behind these sensors" if sensors.filters else ""
        raise BadInput(f"{record.place(worst)}: a pulse of {largest:.3g} N may be as short as "
                       f"{PULSE_SAMPLES * allowed:.3g} s in this chain{through}, and samples {record.spacing:.3g} s "
                       f"apart would miss it; the nearest valid spacing is {allowed:.3g} s "
                       f"({1.0 / allowed:.4g} samples per second).")
