"""Motions of the driver other than the harmonic one: chirp, burst, two tones, noise, a measured series.

A signal is given at knots. Between them the velocity is a straight line and the displacement a quadratic, and this
motion is computed exactly. A formula u(t) is given at KNOTS knots per period of its highest frequency. The velocities
there are chosen so that the displacement equals the formula's at the knots, and is within 4e-8 of the amplitude between
them; the velocity is off by up to h² v''/12, which is (2π/KNOTS)²/12 = 2e-5 of it. A signal knows this error, and
`drive` adds its effect to the errors that it states.

The motion between the samples of a measurement is not known. A measured signal has two coarser ones, made from every
second sample, and `drive` estimates an error from the differences to their motions.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..errors import BadInput
from ..inputs.gaps import Gaps, sample_number, with_zeros
from . import waveforms

#: Knots per period of a formula's highest frequency.
KNOTS = 400
#: Maximum number of knots of a signal.
MOST_KNOTS = 2_000_000
#: Number of corrections of the velocities at the knots: each replaces the displacement's error e there by h² e''/4.
_CORRECTIONS = 3
#: Number of pieces into which the interval between two samples of a measured displacement is divided.
_PIECES = 8


@dataclass(frozen=True, eq=False)
class Signal:
    """A motion of the driver.

    Attributes
    ----------
    time : numpy.ndarray, shape (T,)
        Knots [s], ascending.
    displacement : numpy.ndarray, shape (T,)
        Displacement of the driver at the knots [m]; it is the integral of the velocity.
    velocity : numpy.ndarray, shape (T,)
        Velocity of the driver at the knots [m/s]; between two knots it is linear in time.
    words : str
        Description of the signal.
    velocity_error, displacement_error : float
        Largest difference from a formula at any time [m/s] and [m]; 0 for a motion that is given at knots.
    coarser : tuple of Signal
        The same motion from samples with even numbers, and from those with odd numbers; empty for a formula and for a
        motion that is exact.
    order : float
        Order of convergence to the measured motion as samples become closer: 1 (velocities that jump) to 2 (smooth
        ones). It is estimated from every second and every fourth sample.

    Examples
    --------
    >>> from granchain_core import Signal
    >>> sweep = Signal.chirp(5e-7, 300.0, 600.0, 0.02)
    >>> sweep.words, bool(abs(sweep.displacement).max() < 5.001e-7)
    ('chirp from 300 to 600 Hz in 0.02 s', True)
    """

    time: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    words: str
    velocity_error: float = 0.0
    displacement_error: float = 0.0
    coarser: tuple[Signal, ...] = ()
    order: float = 2.0

    @classmethod
    def from_velocity(cls, time: object, velocity: object, words: str = "given velocity", start: float = 0.0, *,
                      exact: bool = False, gap: str = "refuse",
                      place: Callable[[int], str] = sample_number) -> Signal:
        """Make a motion from its velocity at ascending times; between two of them the velocity is a straight line.

        Parameters
        ----------
        time, velocity : array_like, shape (T,)
            Times [s] and velocities [m/s].
        words : str
            Description of the signal.
        start : float
            Displacement at the first time [m].
        exact : bool
            Whether the motion is exactly this polygonal line, at any spacing. If not, the velocities are samples: a
            gap is refused, and `drive` states the error of the lines between the samples.
        gap : str
            Treatment of a gap between samples, a spacing of more than 1.5 times the usual one: "refuse", "zero" (no
            velocity in it) or "interpolate" (a straight line across it).
        place : callable, optional
            The place of a sample in its source from its index, for messages.

        Raises
        ------
        BadInput
            The arrays do not fit together, are not finite or are too long, times do not ascend, or there is a gap.

        Examples
        --------
        >>> from granchain_core import Signal
        >>> ramp = Signal.from_velocity([0.0, 1e-3, 5e-3], [0.0, 1e-3, 1e-3], exact=True)
        >>> ramp.displacement.tolist()
        [0.0, 5e-07, 4.5e-06]
        """
        t, v = (np.asarray(values, dtype=float) for values in (time, velocity))
        if t.ndim != 1 or t.shape != v.shape or len(t) < 2:
            raise BadInput("A motion of the driver needs times and as many velocities, at least two.")
        if len(t) > MOST_KNOTS:
            raise BadInput(f"{len(t)} knots are more than {MOST_KNOTS}; give a shorter signal or a lower frequency.")
        if not (np.isfinite(t).all() and np.isfinite(v).all()) or (np.diff(t) <= 0.0).any():
            raise BadInput("Times and velocities of the driver must be finite, and times must ascend.")
        if exact:
            return cls._with_lines(t, v, words, start)
        gaps, put_in = Gaps.of(t, place), np.zeros(0, dtype=int)
        treated = gaps.treated(gap, "a straight line across it", "velocity")
        if treated and gap == "zero":
            t, v, put_in = with_zeros(t, v, gaps.before, gaps.usual)
        words += f", {treated}" if treated else ""
        return _of_samples(len(t), put_in, lambda kept: cls._with_lines(t[kept], v[kept], words, start))

    @classmethod
    def from_displacement(cls, time: object, displacement: object, words: str = "given displacement", *,
                          exact: bool = False, gap: str = "refuse",
                          place: Callable[[int], str] = sample_number) -> Signal:
        """Make a motion from its displacement at ascending times, by a cubic spline with eight knots per sample.

        It begins at 0, whatever the first sample is: a driver that overlaps bead 1 at time 0 would be another start.

        Parameters
        ----------
        time, displacement : array_like, shape (T,)
            Times [s] and displacements [m].
        words : str
            Description of the signal.
        exact : bool
            Whether the motion is exactly this spline, at any spacing. If not, the displacements are samples: a gap is
            refused, and `drive` states the error of the spline between the samples.
        gap : str
            Treatment of a gap between samples, a spacing of more than 1.5 times the usual one: "refuse" or
            "interpolate" (the spline across it). There is no "zero": a driver at rest in the gap would jump at its end.
        place : callable, optional
            The place of a sample in its source from its index, for messages.

        Raises
        ------
        BadInput
            The arrays do not fit together, are not finite or are too long, times do not ascend, or there is a gap.
        """
        t, u = (np.asarray(values, dtype=float) for values in (time, displacement))
        if t.ndim != 1 or t.shape != u.shape or len(t) < 4 or not (np.isfinite(t).all() and np.isfinite(u).all()) \
                or (np.diff(t) <= 0.0).any():
            raise BadInput("A motion of the driver needs at least four finite displacements at ascending times.")
        if exact:
            return cls._with_spline(t, u, words)
        treated = Gaps.of(t, place).treated(gap, "a smooth curve across it")
        words += f", {treated}" if treated else ""
        return _of_samples(len(t), np.zeros(0, dtype=int), lambda kept: cls._with_spline(t[kept], u[kept], words))

    @classmethod
    def _with_lines(cls, t: np.ndarray, v: np.ndarray, words: str, start: float) -> Signal:
        """The motion whose velocity is a polygonal line, from checked arrays."""
        moved = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(t) * (v[1:] + v[:-1]))])
        return cls(t, start + moved, v, words)

    @classmethod
    def _with_spline(cls, t: np.ndarray, u: np.ndarray, words: str) -> Signal:
        """The motion along a cubic spline of displacements, from checked arrays."""
        from scipy.interpolate import CubicSpline

        knots = np.interp(np.arange(_PIECES * (len(t) - 1) + 1) / _PIECES, np.arange(len(t)), t)
        return cls.from_velocity(knots, CubicSpline(t, u).derivative()(knots), words, exact=True)

    @classmethod
    def of(cls, velocity: Callable[[np.ndarray], np.ndarray], displacement: Callable[[np.ndarray], np.ndarray],
           duration: float, highest: float, words: str) -> Signal:
        """Make a motion from formulas of velocity [m/s] and displacement [m], with frequencies up to `highest` [Hz]."""
        count = math.ceil(KNOTS * duration * highest)
        if count > MOST_KNOTS:
            raise BadInput(f"{duration:g} s at up to {highest:g} Hz are {count:.1e} knots; the nearest valid duration "
                           f"is {MOST_KNOTS / KNOTS / highest:.4g} s.")
        time = np.linspace(0.0, duration, max(count, 8) + 1)
        exact, at_knots = velocity(time), displacement(time)
        corrected = exact
        for _ in range(_CORRECTIONS):
            signal = cls._with_lines(time, corrected, words, float(at_knots[0]))
            corrected = corrected - np.gradient(signal.displacement - at_knots, time[1])
        signal = cls._with_lines(time, corrected, words, float(at_knots[0]))
        # the error of a smooth velocity is largest at the knots or midway between them. Its integral between two knots
        # is within a tenth of an interval times this error, since h² v'' (1/12 − s (1 − s)/2) h ds adds up to at most
        # 0.0080 h³ v''
        midway = velocity(time[:-1] + 0.5 * time[1])
        velocity_error = max(np.abs(corrected - exact).max(),
                             np.abs(0.5 * (corrected[1:] + corrected[:-1]) - midway).max())
        error_at_knots = float(np.abs(signal.displacement - at_knots).max())
        return replace(signal, velocity_error=float(velocity_error),
                       displacement_error=error_at_knots + 0.1 * float(time[1] * velocity_error))

    @classmethod
    def chirp(cls, amplitude: float, low: float, high: float, duration: float) -> Signal:
        """A linear chirp, A sin 2π(f₀ t + (f₁ − f₀) t²/2T): the frequency goes from f₀ to f₁ [Hz] in T [s]."""
        return cls.of(*waveforms.chirp(amplitude, low, high, duration), duration, max(low, high),
                      f"chirp from {low:g} to {high:g} Hz in {duration:g} s")

    @classmethod
    def burst(cls, amplitude: float, frequency: float, periods: float, duration: float) -> Signal:
        """A sin 2πft · sin² πft/n for n periods of f [Hz], then at rest until `duration` [s]."""
        return cls.of(*waveforms.burst(amplitude, frequency, periods), max(duration, periods / frequency),
                      2.0 * frequency, f"burst of {periods:g} periods of {frequency:g} Hz")

    @classmethod
    def tones(cls, amplitude: float, one: float, other: float, duration: float, ratio: float = 1.0) -> Signal:
        """A (sin 2πf₁t + r sin 2πf₂t)/(1 + r), so that no displacement is above A."""
        return cls.of(*waveforms.tones(amplitude, one, other, ratio), duration, max(one, other),
                      f"tones of {one:g} and {other:g} Hz for {duration:g} s")

    @classmethod
    def noise(cls, amplitude: float, low: float, high: float, duration: float, seed: int = 0) -> Signal:
        """Noise with a flat spectrum of displacement from f₀ to f₁ [Hz] and the rms A/√2 of a sine of amplitude A.

        It is the sum of two hundred sines with random frequencies and phases, the same for the same seed. The noise
        grows from zero over the first two periods of f₀.
        """
        return cls.of(*waveforms.noise(amplitude, low, high, seed), duration, high,
                      f"noise from {low:g} to {high:g} Hz for {duration:g} s, seed {seed}")

    def quadratics(self) -> np.ndarray:
        """Coefficients (T − 1, 3) of the displacement in every interval, constant term first, in m and s."""
        step = np.diff(self.time)
        return np.stack([self.displacement[:-1], self.velocity[:-1], 0.5 * np.diff(self.velocity) / step], axis=1)

    def displacement_at(self, time: np.ndarray) -> np.ndarray:
        """Displacement [m] at any times between the first knot and the last."""
        at = np.clip(np.searchsorted(self.time, time, "right") - 1, 0, len(self.time) - 2)
        constant, linear, quadratic = self.quadratics()[at].T
        since = time - self.time[at]
        return np.asarray(constant + since * (linear + since * quadratic))

    def shifted(self, start: float) -> Signal:
        """The motion shifted towards the chain by `start` [m] at all times."""
        return replace(self, displacement=self.displacement + start,
                       coarser=tuple(signal.shifted(start) for signal in self.coarser))

    def finer(self, spacing: float) -> Signal:
        """The motion with knots at most `spacing` [s] apart, at which `drive` then returns the forces.

        Each interval is divided into the same number of equal parts, so the given knots are among the new ones.
        """
        parts = math.ceil(float(np.diff(self.time).max()) / spacing)
        if parts < 2:
            return self
        if parts * (len(self.time) - 1) > MOST_KNOTS:
            raise BadInput(f"With knots {spacing:.3g} s apart, this motion would have more than {MOST_KNOTS}; the "
                           f"nearest valid spacing is {(self.time[-1] - self.time[0]) / MOST_KNOTS:.3g} s.")
        at = np.arange(parts * (len(self.time) - 1) + 1) / parts
        given = np.arange(len(self.time))
        time, velocity = (np.interp(at, given, values) for values in (self.time, self.velocity))
        return replace(self, time=time, velocity=velocity, displacement=self.displacement_at(time))


def _of_samples(count: int, put_in: np.ndarray, of: Callable[[np.ndarray], Signal]) -> Signal:
    """The signal of `count` samples with its coarser ones; `of` makes the signal of the samples with given indices.

    The first and the last sample and the zeros that were `put_in` are always kept. There are two signals from every
    second sample, because one of them may agree with the full one by chance: if the velocity of a sine has four samples
    per period, at its extrema and zeros, the extrema alone give the same lines.
    """
    full, measured = of(np.arange(count)), np.delete(np.arange(count), put_in)

    def by_every(nth: int) -> tuple[tuple[Signal, ...], float]:
        """Signals from every nth sample, and the largest distance of their displacements from the full signal's."""
        signals = tuple(of(np.unique(np.concatenate([measured[first::nth], measured[[0, -1]], put_in])))
                        for first in range(nth))
        return signals, max(float(np.abs(signal.displacement_at(full.time) - full.displacement).max())
                            for signal in signals)

    (coarser, second), (_, fourth) = by_every(2), by_every(4)
    # differences for a spacing h: C h^order (2^order − 1) and C h^order (4^order − 1), whose ratio is 2^order + 1
    falls = fourth / second - 1.0 if second > 0.0 else 4.0
    return replace(full, coarser=coarser, order=math.log2(min(max(falls, 2.0), 4.0)))
