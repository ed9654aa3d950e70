"""Returns of a state to itself: relative changes of scaled states, and the least period of an orbit."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

#: [no threshold] Replaces a size of zero, by which nothing can be divided: far below any other, but not subnormal.
_NO_SIZE = 1e-300


def sizes(x: np.ndarray, least_displacement: float = 0.0) -> np.ndarray:
    """The sizes (2N,) of displacements and of w, the two halves of x (2N,): the largest modulus in each half.

    The size of displacements is at least `least_displacement`.
    """
    half = len(x) // 2
    largest = [max(_NO_SIZE, least, float(np.abs(part).max()))
               for least, part in ((least_displacement, x[:half]), (0.0, x[half:]))]
    return np.repeat(largest, half)


def relative_change(change: np.ndarray, x: np.ndarray, least_displacement: float = 0.0) -> float:
    """The larger of the changes of displacements and of w, each relative to its size in x (2N,) (`sizes`)."""
    return float(np.abs(change / sizes(x, least_displacement)).max())


def shorter_periods(after: Callable[[int], np.ndarray], x: np.ndarray, period: int, tolerance: float,
                    least_displacement: float = 0.0) -> Iterator[int]:
    """Yield the proper divisors n of `period` after which x returns within a relative `tolerance`; `after(n)` is Φⁿ(x).

    The tolerance must be far above the error of the map Φ and far below the distance between two orbits.
    """
    for n in range(1, period):
        if period % n == 0 and relative_change(after(n) - x, x, least_displacement) < tolerance:
            yield n


def least_period(after: Callable[[int], np.ndarray], x: np.ndarray, period: int, tolerance: float,
                 least_displacement: float = 0.0) -> int:
    """The smallest of `shorter_periods`, or `period` itself."""
    return next(shorter_periods(after, x, period, tolerance, least_displacement), period)
