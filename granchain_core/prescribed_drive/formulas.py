"""Drives by name for `run --drive NAME=a:b:c`: the function that makes the signal, its numbers, and their checks.

The help of `run --drive` and a table in docs/scenes.md are generated from `FORMULAS`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..errors import BadInput
from ..inputs.checks import unknown_name
from ..inputs.text import number_in
from .signal import Signal


def _nothing_more(numbers: Sequence[float]) -> str:
    """No further check."""
    return ""


@dataclass(frozen=True)
class Formula:
    """A drive by a formula: a row of `FORMULAS`.

    Attributes
    ----------
    make : callable
        Makes the signal from the drive amplitude [m] and the numbers.
    numbers : tuple of str
        Names of the numbers, in order; frequencies in Hz, times in s.
    meaning : str
        The motion of the driver, in words, for the docs.
    optional : int
        Number of values at the end that may be left out. All others must be above 0.
    problem : callable
        Returns what else is wrong with the numbers, as the end of a sentence, or "".
    """

    make: Callable[..., Signal]
    numbers: tuple[str, ...]
    meaning: str
    optional: int = 0
    problem: Callable[[Sequence[float]], str] = _nothing_more

    @property
    def needed(self) -> int:
        """Number of values that must be given."""
        return len(self.numbers) - self.optional

    @property
    def form(self) -> str:
        """The numbers in the form in which they are written, for example "f1:f2:duration[:ratio]"."""
        return ":".join(self.numbers[: self.needed]) + "".join(f"[:{name}]" for name in self.numbers[self.needed :])


def _noise(amplitude: float, low: float, high: float, duration: float, seed: float = 0.0) -> Signal:
    return Signal.noise(amplitude, low, high, duration, int(seed))


def _problem_of_noise(numbers: Sequence[float]) -> str:
    if numbers[0] >= numbers[1] or any(seed < 0.0 or seed != int(seed) for seed in numbers[3:]):
        return "noise goes from a lower to a higher frequency, and its seed is a whole number from 0"
    return ""


def _problem_of_tones(numbers: Sequence[float]) -> str:
    return "the ratio of two tones is a number from 0" if any(ratio < 0.0 for ratio in numbers[3:]) else ""


FORMULAS: dict[str, Formula] = {
    "chirp": Formula(
        Signal.chirp, ("f0", "f1", "duration"),
        "a linear chirp, A₀ sin 2π(f₀t + (f₁ − f₀)t²/2T): the frequency goes linearly from f₀ to f₁ [Hz] in the "
        "duration T [s]"),
    "burst": Formula(
        Signal.burst, ("f", "periods", "duration"),
        "n periods of A₀ sin 2πft under a window sin²(πft/n), then at rest until the duration is over"),
    "tones": Formula(
        Signal.tones, ("f1", "f2", "duration", "ratio"),
        "A₀ (sin 2πf₁t + r sin 2πf₂t)/(1 + r), with the ratio r, 1 if it is left out",
        optional=1, problem=_problem_of_tones),
    "noise": Formula(
        _noise, ("f0", "f1", "duration", "seed"),
        "noise with a flat spectrum of displacement from f₀ to f₁ and the root mean square of a sine of amplitude "
        "A₀; another seed, 0 if it is left out, gives other noise",
        optional=1, problem=_problem_of_noise),
}


def formula_signal(text: str, amplitude: float) -> Signal | None:
    """Make the signal that NAME=a:b:c describes, with the drive amplitude [m]; None for anything else, e.g. a file.

    Raises `BadInput` if the numbers cannot be used.
    """
    name, equals, values = text.partition("=")
    if not equals:
        return None
    if name not in FORMULAS:
        raise unknown_name("drive", name, FORMULAS)
    formula = FORMULAS[name]
    numbers = [number_in(part) for part in values.split(":")]
    given = [number for number in numbers if number is not None]
    if (not formula.needed <= len(numbers) <= len(formula.numbers) or len(given) < len(numbers)
            or min(given[: formula.needed]) <= 0.0):
        raise BadInput(f"--drive {text[:60]!r} must have the form {name}={formula.form}, in Hz and s, with numbers "
                       "above 0.")
    problem = formula.problem(given)
    if problem:
        raise BadInput(f"--drive {text[:60]!r}: {problem}.")
    return formula.make(amplitude, *given)
