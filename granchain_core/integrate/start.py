"""Starts at any drive phase, for computations that advance by whole periods from phase 0."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from ..errors import BadInput
from ..execution.stop import Stop
from ..scene import Scene
from ..scene.state import State, checked_start
from .engine import Engine
from .methods import following_setting

#: A phase must be k/n with n at most this, because the steps per period are a multiple of n.
_MOST_PARTS = 10_000
#: Largest distance of a phase from k/n [periods]: rounding.
_ROUNDING = 1e-9


def nearest_fraction(phase: float) -> tuple[Fraction, bool]:
    """Return the fraction k/n nearest to a phase, and whether it equals the phase."""
    part = Fraction(phase).limit_denominator(_MOST_PARTS)
    return part, abs(float(part) - phase) <= _ROUNDING


def at_phase_0(scene: Scene, start: State, stop: Stop | None = None) -> State:
    """Return the state at the next drive phase 0 of a motion from `start`, computed with `following_setting`.

    A state at phase 0 is returned unchanged. Raises `BadInput` if `start` is not a state of this chain, or if its phase
    is not a fraction k/n with n up to 10,000; also `ComputationError` and `Cancelled`.
    """
    begin = checked_start(scene, start)
    part, same = nearest_fraction(begin.phase)
    if not same:
        raise BadInput(f"A start at drive phase {begin.phase!r} cannot be advanced to phase 0; its phase must be a "
                       f"fraction k/n with n up to {_MOST_PARTS}: the nearest is {part} = {float(part)!r}.")
    if part.denominator == 1:
        return replace(begin, phase=0.0)
    engine = Engine(scene, following_setting(scene.cuts_tension), part.denominator, stop=stop)
    engine.start(replace(begin, phase=float(part)))
    engine.record(part.denominator - part.numerator)
    return engine.state
