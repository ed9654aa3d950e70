"""The rotation number of a quasi-periodic motion: its second frequency over the drive frequency.

Definition  ρ = lim (ψ_k − ψ_0) / k: on a closed curve that the stroboscopic map Φ maps to itself, the mean advance of
            the angle ψ, in turns, per drive period k. The second frequency is f₂ = ρ f
Convention  ρ is known up to its sign and a whole number, and is given in [0, ½]. On n closed curves that are visited in
            turn, it is the rotation number of Φⁿ, and f₂ = ρ f / n, up to its sign and multiples of f / n
Source      winding.py in this folder, which computes it from strobes
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ..execution.stop import Stop
from ..inputs.checks import whole_number
from ..integrate import Engine, fixed_step_setting
from ..integrate.methods import RK4_SPLIT
from ..integrate.safety_factors import IRREGULAR
from ..results.regime import Regime
from ..scene import Scene
from ..scene.refusals import require_scene
from ..scene.state import State
from ..steady.settling.advance import run_until_settled
from ..tables import Column, Labelled, Table, axis, or_nan, provenance
from ..tables.provenance import Attribute
from .winding import LARGEST_DENOMINATOR, LENGTHS, Winding, folded, winding_of

#: [rotation] Minimum number of drive periods in the first record.
FEWEST_PERIODS = 1000
#: [rotation] Maximum number of drive periods in the first record.
MOST_ROTATION_PERIODS = 10_000
#: [rotation] The longer steps: number per drive period relative to the default.
_LONGER = 2.0
#: [rotation] The shorter steps: number per drive period relative to the default. The difference between the two
#: computations gives their error.
_SHORTER = 4.0
#: [rotation] Maximum number of records of one motion, each after the previous one and twice as long. The regime is
#: known before the curve is reached to rounding, and near a fraction a record must be long.
_MOST_RECORDS = 3
#: [rotation] Maximum number of beads whose strobes are kept. In a longer chain, they are evenly spaced.
_MOST_BEADS = 30
#: [rotation] Number of drive periods run at once.
_PERIODS_AT_ONCE = 1000
#: [rotation] Error of the average below which no further record follows.
_SMALL_ERROR = 1e-8


@dataclass(frozen=True, eq=False, repr=False)
class RotationNumber(Labelled):
    """The rotation number of a motion, with its error; or why it is not decided.

    Attributes
    ----------
    scene : Scene
        The chain.
    regime : Regime
        What kind of motion it is; only a quasi-periodic one has a rotation number.
    value : float or None
        ρ in [0, ½], of the `curves`-th iterate of the stroboscopic map; None if it is not decided.
    average_error : float or None
        Error of the average: `_STATED` (winding.py) times the largest difference between the first, middle and last
        half of the record, and between projections.
    step_error : float or None
        Error of the integration: `IRREGULAR` (integrate/safety_factors.py) times the difference from the result with
        steps twice as long.
    curves : int
        Number of closed curves that the motion visits in turn.
    periods : int
        Number of drive periods of the last record.
    projections : int
        Number of projections of the state from which it was computed, and which agree within `average_error`.
    reason : str
        Why it is not decided; empty if it is decided.
    convergence : numpy.ndarray, shape (4, 3)
        For an eighth, a quarter, a half and the whole of the record: number of states on one curve, ρ, and the largest
        difference between the first, middle and last half. NaN if it is not decided.

    Examples
    --------
    >>> from granchain_core import rotation_number, scene
    >>> found = rotation_number(scene("sec2").evolve(f=1700.0))
    >>> f"{found.value:.6f}", found.curves, found.error < 1e-6
    ('0.221811', 1, True)
    >>> f"{found.second_frequency:.2f} Hz"
    '377.08 Hz'
    """

    scene: Scene
    regime: Regime
    value: float | None
    average_error: float | None
    step_error: float | None
    curves: int
    periods: int
    projections: int
    reason: str
    convergence: np.ndarray

    @property
    def error(self) -> float | None:
        """The sum of both errors; None if there is no value."""
        return None if self.average_error is None or self.step_error is None else self.average_error + self.step_error

    @property
    def second_frequency(self) -> float | None:
        """ρ f / curves [Hz], up to its sign and multiples of f / curves; None where there is no value."""
        return None if self.value is None else self.value * self.scene.f / self.curves

    @property
    def second_frequency_error(self) -> float | None:
        """Error of the second frequency [Hz]; None where there is no value."""
        return None if self.error is None else self.error * self.scene.f / self.curves

    @property
    def digits(self) -> float | None:
        """Decimal digits to which the halves of the record and the projections agree; None where there is no value."""
        return None if self.average_error is None else float(-np.log10(self.average_error))

    @property
    def nearest_fraction(self) -> Fraction | None:
        """The fraction j/q, q at most `LARGEST_DENOMINATOR`, that is nearest to ρ; None where there is no value."""
        return None if self.value is None else Fraction(self.value).limit_denominator(LARGEST_DENOMINATOR)

    @property
    def fraction_distance(self) -> float | None:
        """|ρ − j/q| for the nearest fraction, to be compared with `error`; None where there is no value."""
        nearest = self.nearest_fraction
        return None if self.value is None or nearest is None else abs(self.value - float(nearest))

    def tables(self) -> tuple[Table, ...]:
        """One table, `rotation`: how the average converges with the length of the record."""
        along, lengths = ("length",), np.array([2.0**-k for k in range(LENGTHS)][::-1])
        return (Table("rotation", axis("length", lengths, "1", "fraction of the record, from its beginning"), {
            "states": Column(self.convergence[:, 0], along, "1", "states on one curve in it"),
            "rotation_number": Column(self.convergence[:, 1], along, "1", "rotation number from it"),
            "difference": Column(self.convergence[:, 2], along, "1", "largest difference of its first, middle and "
                                                                      "last half")}),)

    def attributes(self) -> dict[str, Attribute]:
        """The rotation number with its errors, and provenance."""
        nearest = self.nearest_fraction
        return {**provenance(self.scene, RK4_SPLIT, None), "regime": self.regime.name, "periods": self.periods,
                "rotation_number": or_nan(self.value), "rotation_number_error": or_nan(self.error),
                "average_error": or_nan(self.average_error), "step_error": or_nan(self.step_error),
                "curves": self.curves, "projections": self.projections, "reason": self.reason,
                "second_frequency": or_nan(self.second_frequency),
                "second_frequency_error": or_nan(self.second_frequency_error),
                "nearest_fraction": "" if nearest is None else str(nearest),
                "fraction_distance": or_nan(self.fraction_distance)}

    def summary(self) -> list[str]:
        """Rotation number, second frequency and nearest fraction; or why it is not decided."""
        if self.value is None or self.second_frequency is None:
            return [f"rotation number not decided: {self.reason}"]
        per = "period" if self.curves == 1 else f"{self.curves} periods: {self.curves} curves are visited in turn"
        return [f"rotation number {with_error(self.value, self.error)} per {per}",
                f"second frequency {with_error(self.second_frequency, self.second_frequency_error)} Hz, up to its sign "
                f"and multiples of {self.scene.f / self.curves:g} Hz",
                f"error of the average {self.average_error:.1e} ({self.projections} projections agree), of the steps "
                f"{self.step_error:.1e}",
                f"nearest fraction with a denominator up to {LARGEST_DENOMINATOR}: {self.nearest_fraction}, "
                f"{self.fraction_distance:.1e} away"]


def with_error(value: float, error: float | None) -> str:
    """A number and its error with two digits; the number has no more decimals than the error, and at most 15."""
    if error is None:
        return f"{value:.6g}"
    decimals = min(15, max(0, 1 - math.floor(math.log10(error))))
    return f"{value:.{decimals}f} ± {error:.1e}"


def rotation_number(scene: Scene, periods: int = 4000, start: State | None = None, stop: Stop | None = None,
                    progress: Callable[[float], None] | None = None) -> RotationNumber:
    """Compute the rotation number of the quasi-periodic motion that a chain settles to.

    The chain settles; then its strobes are recorded with half the default step and with a quarter of it. As long as the
    average's error is above 1e-8, a record twice as long follows, up to three records with each step.

    Parameters
    ----------
    scene : Scene
        The chain.
    periods : int
        Number of drive periods of the first record, 1000 to 10,000.
    start : State, optional
        Where the chain starts to settle; by default the scene's own start.
    stop : Stop, optional
        Once it is set, the computation ends with `Cancelled`.
    progress : callable, optional
        Called with the completed fraction, 0 to 1.

    Returns
    -------
    RotationNumber
        The rotation number with its error, or the reason why it is not decided.

    Raises
    ------
    BadInput
        A chain that is not driven, or a number of periods out of range.
    ComputationError
        The motion did not stay finite.

    Examples
    --------
    >>> from granchain_core import rotation_number, scene
    >>> rotation_number(scene("sec2").evolve(N=2, f=2000.0)).reason
    'the motion is periodic, not quasi-periodic'
    """
    require_scene(scene)
    periods = whole_number("periods =", periods, FEWEST_PERIODS, MOST_ROTATION_PERIODS)
    settled = run_until_settled(scene, start, stop)
    if settled.regime.name != "quasi-periodic":
        return _result(scene, settled.regime, periods,
                       Winding(None, error=None, curves=1,
                               reason=f"the motion is {settled.regime.name}, not quasi-periodic"), None)
    reported = progress or (lambda _: None)
    engine = _engine(scene, _LONGER, settled.engine.state, settled.stop)
    longer, _ = _recorded(engine, periods, lambda part: reported(part / 3))
    engine = _engine(scene, _SHORTER, engine.state, settled.stop)
    shorter, length = _recorded(engine, periods, lambda part: reported((1 + 2 * part) / 3))
    return _result(scene, settled.regime, length, *_compared(longer, shorter))


def _engine(scene: Scene, refined: float, state: State, stop: Stop) -> Engine:
    """The fixed-step method with `refined` times the default steps, at `state`."""
    engine = Engine(scene, fixed_step_setting(refined), 1, stop=stop)
    engine.start(state)
    return engine


def _recorded(engine: Engine, periods: int, reported: Callable[[float], None]) -> tuple[Winding, int]:
    """The rotation number from the last record, and its length: the first has `periods`, each next one twice as many.
    """
    for number in range(_MOST_RECORDS):
        length = periods << number
        winding = winding_of(_strobes(engine, length))
        reported((2.0 ** (number + 1) - 1.0) / (2.0**_MOST_RECORDS - 1.0))
        if winding.error is not None and winding.error < _SMALL_ERROR:
            break
    return winding, length


def _strobes(engine: Engine, periods: int) -> np.ndarray:
    """The strobes (P, 2, n) of the next periods, for all beads or, in a longer chain, for at most `_MOST_BEADS`."""
    stride = -(-engine.scaled.beads // _MOST_BEADS)
    parts = [min(_PERIODS_AT_ONCE, periods - first) for first in range(0, periods, _PERIODS_AT_ONCE)]
    return np.concatenate([engine.periods(part, watch=False)[0][1:, :, ::stride] for part in parts])


def _compared(longer: Winding, shorter: Winding) -> tuple[Winding, float | None]:
    """The rotation number with the shorter steps, and its error from the difference to that with the longer steps."""
    if shorter.value is None:
        return shorter, None
    if longer.value is None:
        return Winding(None, error=None, curves=shorter.curves,
                       reason=f"steps twice as long give none: {longer.reason}"), None
    if longer.curves != shorter.curves:
        reason = f"with steps twice as long there are {longer.curves} curves instead of {shorter.curves}"
        return Winding(None, error=None, curves=shorter.curves, reason=reason), None
    return shorter, IRREGULAR * folded(longer.value - shorter.value)


def _result(scene: Scene, regime: Regime, periods: int, winding: Winding, step_error: float | None) -> RotationNumber:
    convergence = np.full((LENGTHS, 3), np.nan) if winding.convergence is None else winding.convergence
    return RotationNumber(scene, regime=regime, value=winding.value, average_error=winding.error, step_error=step_error,
                          curves=winding.curves, periods=periods, projections=winding.projections,
                          reason=winding.reason, convergence=convergence)
