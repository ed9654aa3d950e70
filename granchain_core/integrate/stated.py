"""The stated error of a motion, from several computations with increasing resolution."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from .methods import METHODS, MethodSetting, jump_errors, typical_error
from .safety_factors import IRREGULAR, REGULAR, RUN_FORCES, RUN_FORCES_THAT_JUMP
from .scaling import ScaledChain

#: Factor on the rounding of all steps, summed as a random walk and multiplied by the growth of errors: eight times the
#: usual rounding, which few random scenes exceed.
_ROUNDING_FACTOR = 32.0
#: The growth of errors is measured by the difference of two computations if the coarser one has a typical error above
#: this. Otherwise the difference may be rounding, and its ratio to the typical error is not a measure of growth.
_ROUNDING_NEGLIGIBLE_ABOVE = 1e-10
#: Stated relative error above which the result is useless.
_LARGEST_USEFUL_ERROR = 0.05
#: Stated error of motions that have diverged, relative to the largest displacement: they differ by at most twice that.
_WHOLE_MOTION = 2.0
#: Order assumed with tension cut if the method's order with it is not measured: the lowest measured order.
_ORDER_WITH_CUT = 1.0


def relative_difference(first: np.ndarray, second: np.ndarray) -> float:
    """Return the largest |first − second| over the largest |first|, for equal shapes; 0 if `first` is all zero."""
    largest = float(np.abs(first).max())
    return float(np.abs(first - second).max()) / largest if largest > 0.0 else 0.0


def least_errors(setting: MethodSetting, scaled: ScaledChain, step: float, jumps: np.ndarray,
                 maxima: np.ndarray) -> np.ndarray:
    """Return lower limits of a motion's stated errors (4,) with this step: of displacements, then of largest forces.

    They are the typical errors, and for forces at jumps (2,) also `jump_errors`. All in scaled units.
    """
    typical = typical_error(setting)
    return np.array([typical, *np.maximum(typical, jump_errors(setting, scaled, step, jumps, maxima))])


def relative_changes(now: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Return the changes of the three largest forces from one computation to a finer one, relative to the finer one.

    Infinite where the finer one is zero and the other is not.
    """
    change = np.abs(now - before)
    return np.divide(change, now, out=np.where(change > 0.0, np.inf, 0.0), where=now > 0.0)


def force_differences(now: np.ndarray, before: np.ndarray, forces_jump: bool) -> np.ndarray:
    """Return the relative changes (3,) of a run's largest forces, times the safety factor with or without jumps."""
    return (RUN_FORCES_THAT_JUMP if forces_jump else RUN_FORCES) * relative_changes(now, before)


def or_whole_motion(stated: np.ndarray) -> np.ndarray:
    """Return the stated errors, raised to `_WHOLE_MOTION` if that of the displacements, the first, is useless.

    Two computations that differ this much may have diverged, and their difference is then no measure of the error.
    """
    return stated if stated[0] <= _LARGEST_USEFUL_ERROR else np.maximum(stated, _WHOLE_MOTION)


@dataclass(eq=False)
class StatedErrors:
    """The errors of several computations of one motion, for several quantities at once.

    Two computations may agree by chance (docs/accuracy.md, "Accuracy is measured, not trusted"). So the stated error is
    the maximum of
      - the difference of the last two, times a factor;
      - the previous difference, times the same factor, reduced according to the method's order, or with error control
        by the ratio of the tolerances;
      - the typical error of a method with such steps;
      - the rounding of the steps, times the largest growth of errors in any of the computations; computations with a
        typical error of 1e-10 or less do not count, and without any other the term is 0;
      - for the largest forces, the error at jumps (`jump_errors`).
    The first quantity determines the growth of errors.
    """

    cuts_tension: bool
    settings: list[MethodSetting] = field(default_factory=list)
    stated: np.ndarray = field(default_factory=lambda: np.zeros(0))
    rounding: float = 0.0
    growth: float = 0.0
    _before: np.ndarray | None = None

    def begin(self, setting: MethodSetting) -> None:
        """Register the first computation."""
        self.settings.append(setting)

    def add(self, setting: MethodSetting, steps: int, differences: np.ndarray, least_errors: np.ndarray) -> None:
        """Add a finer computation with `steps` steps: its relative differences from the last one, and least errors."""
        coarser = self.settings[-1]
        self._see_growth(coarser, float(differences[0]))
        self.rounding = _ROUNDING_FACTOR * self.growth * np.finfo(float).eps * float(np.sqrt(steps))
        errors = differences
        if self._before is not None:
            errors = np.maximum(errors, self._before / self._falls(coarser, setting))
        regular = METHODS[setting.method].converges_regularly and not self.cuts_tension
        self.stated = np.maximum((REGULAR if regular else IRREGULAR) * errors, np.maximum(least_errors, self.rounding))
        self._before = differences
        self.settings.append(setting)

    @property
    def rounded(self) -> bool:
        """Whether only rounding is left of the first quantity's error, so that finer steps gain nothing."""
        return bool(self.stated[0] <= self.rounding)

    def final(self, done: bool) -> np.ndarray:
        """Return the stated errors if no finer computation follows."""
        return self.stated if done else or_whole_motion(self.stated)

    def _see_growth(self, coarser: MethodSetting, difference: float) -> None:
        typical = typical_error(coarser)
        if typical > _ROUNDING_NEGLIGIBLE_ABOVE:
            self.growth = max(self.growth, difference / typical)

    def _falls(self, coarser: MethodSetting, finer: MethodSetting) -> float:
        """Return the expected ratio of the errors, by the observed order, or for error control by the tolerances."""
        method = METHODS[finer.method]
        if method.error_control:
            return coarser.tolerance / finer.tolerance
        order = method.observed_with_cut if self.cuts_tension else method.observed_order
        if math.isnan(order):
            order = _ORDER_WITH_CUT
        return float((finer.refine / coarser.refine) ** order)
