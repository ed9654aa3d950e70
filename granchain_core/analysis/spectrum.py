"""Spectra of forces, and the transfer from the input force to the output force.

Equation   F(t) = Σ_m A_m cos(2π m f t / n + φ_m) for a motion of period n: its Fourier series, without a window
           H_m = F̂_out,m / F̂_in,m at the lines at which the input force is not negligible
Note       The spectrum of a motion without a period is not such a series: quasi-periodic motion has lines at
           combinations of its frequencies, chaotic motion a continuous part. Its record is weighted by a Hann window,
           and a peak has the height of an isolated sine; two peaks closer than 2 / duration are not resolved.
           Frequencies above half the sampling frequency are folded back (aliased). `aliasing` estimates the resulting
           error: twice the largest difference from the lines computed from every second sample, in the lower half of
           their frequencies.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from ..inputs.checks import unknown_name
from ..results.run import Run, require_run
from ..scene import Scene
from ..tables import Column, Labelled, Table, axis
from ..tables.provenance import Attribute

#: Names of the forces that have a spectrum, and the corresponding attributes of a run.
FORCES = {"input": "input_force", "output": "output_force", "elastic": "output_force_elastic"}
#: A line of the input force is used for a transfer only if it is above this fraction of the largest line.
_SMALLEST_INPUT_LINE = 1e-6


@dataclass(frozen=True, eq=False, repr=False)
class Spectrum(Labelled):
    """Amplitudes of a force over frequency.

    Attributes
    ----------
    run : Run
        The motion.
    force : str
        "input", "output" or "elastic".
    frequency : numpy.ndarray, shape (M,)
        From 0 to half the sampling frequency [Hz].
    amplitude : numpy.ndarray, shape (M,)
        Amplitude of the cosine at each frequency; at frequency 0 the mean of the force [N].
    phase : numpy.ndarray, shape (M,)
        Phase of the cosine at each frequency, measured from drive phase 0 [rad].
    period : int or None
        Period of the motion, in drive periods, if this is its Fourier series; None for a windowed record of a motion
        without a period.
    aliasing : float
        Estimate of the part of an amplitude that is folded back from above half the sampling frequency [N].

    Examples
    --------
    >>> from granchain_core import scene, settle, spectrum
    >>> lines = spectrum(settle(scene("sec2").evolve(N=2, f=2000.0)).run)
    >>> lines.period, float(lines.frequency[1])
    (1, 2000.0)
    """

    run: Run
    force: str
    frequency: np.ndarray
    amplitude: np.ndarray
    phase: np.ndarray
    period: int | None
    aliasing: float

    @property
    def error(self) -> float:
        """Estimated error of an amplitude [N]: `aliasing`, plus the largest force times the motion's relative error.

        NaN if the run states no error.
        """
        stated = (getattr(self.run.force_errors, self.force), self.run.displacement_error)
        known = [error for error in stated if error is not None]
        return self.aliasing + max(known) * float(np.abs(self.run.force).max()) if known else math.nan

    @property
    def resolution(self) -> float:
        """Frequency resolution [Hz]: lines closer than this are not separated.

        It is the spacing of the frequencies for a Fourier series, and twice the spacing with a Hann window.
        """
        return float(self.frequency[1]) * (1.0 if self.period else 2.0)

    @property
    def scene(self) -> Scene:
        """The chain."""
        return self.run.scene

    def tables(self) -> tuple[Table, ...]:
        """One table, `spectrum`: amplitude and phase over the frequency."""
        along = ("frequency",)
        return (Table("spectrum", axis("frequency", self.frequency, "Hz", "frequency"), {
            "amplitude": Column(self.amplitude, along, "N", f"amplitude of the {self.force} force, the mean at 0"),
            "phase": Column(self.phase, along, "rad", "phase of the cosine, measured from drive phase 0")}),)

    def attributes(self) -> dict[str, Attribute]:
        """Force, period, aliasing and resolution, along with the attributes of its run."""
        return {**self.run.attributes(), "force": self.force, "period": self.period or 0, "aliasing": self.aliasing,
                "resolution": self.resolution}

    def summary(self) -> list[str]:
        """The force, and its largest lines."""
        top = [i for i in np.argsort(-self.amplitude) if self.frequency[i] > 0.0][:3]
        kind = f"lines of a motion of period {self.period}" if self.period else "windowed record, no period"
        return [f"{self.force} force, {kind}; resolution {self.resolution:.4g} Hz",
                *(f"{self.amplitude[i]:.4g} N at {self.frequency[i]:.6g} Hz" for i in top),
                f"folded back from above half the sampling frequency: at most about {self.aliasing:.1e} N"]


@dataclass(frozen=True, eq=False, repr=False)
class Transfer(Labelled):
    """The output force's lines over those of the input force.

    Attributes
    ----------
    frequency : numpy.ndarray, shape (M,)
        Lines at which the input force is above 1e-6 of its largest line and above twice its `aliasing` [Hz].
    gain, phase : numpy.ndarray, shape (M,)
        |H|, and the argument of H [rad]: negative where the output is late.
    gain_error, phase_error : numpy.ndarray, shape (M,)
        Estimated errors of both, that of the phase [rad] at most π. The gain's error is NaN where the line of the input
        force is smaller than its error.
    run : Run
        The motion.

    Examples
    --------
    >>> from granchain_core import scene, settle, transfer
    >>> through = transfer(settle(scene("sec2").evolve(N=2, f=2000.0)).run)
    >>> bool(through.gain[0] > 0.9), float(through.frequency[1])
    (True, 2000.0)
    """

    frequency: np.ndarray
    gain: np.ndarray
    phase: np.ndarray
    gain_error: np.ndarray
    phase_error: np.ndarray
    run: Run

    @property
    def scene(self) -> Scene:
        """The chain."""
        return self.run.scene

    def tables(self) -> tuple[Table, ...]:
        """One table, `transfer`: gain and phase over the frequency."""
        along = ("frequency",)
        return (Table("transfer", axis("frequency", self.frequency, "Hz", "frequency"), {
            "gain": Column(self.gain, along, "1", "line of the output force over that of the input force"),
            "phase": Column(self.phase, along, "rad", "phase of the output less that of the input"),
            "gain_error": Column(self.gain_error, along, "1", "error of the gain, NaN if unknown"),
            "phase_error": Column(self.phase_error, along, "rad", "error of the phase, at most π")}),)

    def attributes(self) -> dict[str, Attribute]:
        """The attributes of its run."""
        return self.run.attributes()

    def summary(self) -> list[str]:
        """Number of lines, and gain and phase at the drive frequency."""
        at = int(np.argmin(np.abs(self.frequency - self.scene.f)))
        return [f"{len(self.frequency)} lines at which the input force is not negligible",
                f"at {self.frequency[at]:.6g} Hz: gain {self.gain[at]:.4g} ± {self.gain_error[at]:.0e}, phase "
                f"{self.phase[at]:+.3f} ± {self.phase_error[at]:.0e} rad"]


def spectrum(run: Run, force: str = "output") -> Spectrum:
    """Compute the spectrum of a force of a recorded motion.

    Parameters
    ----------
    run : Run
        A motion with a whole number of recorded drive periods, at least n for a motion of period n.
    force : str
        "input", "output", or "elastic", the elastic part of the output force.

    Returns
    -------
    Spectrum
        Lines of the Fourier series if the motion is periodic, otherwise those of the windowed record.

    Raises
    ------
    BadInput
        An unknown force; fewer than four samples per drive period, or an odd number; less than one recorded period of
        the motion, or not a whole number of drive periods.

    Examples
    --------
    >>> from granchain_core import scene, settle, spectrum
    >>> lines = spectrum(settle(scene("sec2").evolve(N=2, f=2000.0)).run, "input")
    >>> bool(lines.amplitude[1] > lines.amplitude[2])
    True
    """
    require_run(run)
    if force not in FORCES:
        raise unknown_name("force", force, FORCES)
    values, period = _record(run, np.asarray(getattr(run, FORCES[force]))[:-1])
    lines, half = (cosines(some, period is not None) for some in (values, values[::2]))
    aliasing = 2.0 * float(np.abs(lines[: len(half) // 2] - half[: len(half) // 2]).max())
    frequency = np.arange(len(lines)) * run.scene.f * run.samples / len(values)
    return Spectrum(run, force=force, frequency=frequency, amplitude=np.abs(lines), phase=np.angle(lines),
                    period=period, aliasing=aliasing)


def transfer(run: Run) -> Transfer:
    """Compute the transfer from the input force to the output force of a periodic motion.

    Parameters
    ----------
    run : Run
        As for `spectrum`.

    Returns
    -------
    Transfer
        Gain and phase of its lines.

    Raises
    ------
    BadInput
        The motion has no period, or any error of `spectrum`.

    Examples
    --------
    >>> from granchain_core import scene, settle, transfer
    >>> through = transfer(settle(scene("sec2").evolve(N=2, f=2000.0)).run)
    >>> through.gain.shape == through.phase.shape
    True
    """
    require_run(run)
    if run.regime.period is None:
        raise BadInput(f"A transfer needs lines, and this motion has none: {run.regime.sentence}.")
    into, out = spectrum(run, "input"), spectrum(run, "output")
    strong = into.amplitude > max(_SMALLEST_INPUT_LINE * into.amplitude.max(), 2.0 * into.aliasing)
    turned = out.phase[strong] - into.phase[strong]
    gain = out.amplitude[strong] / into.amplitude[strong]
    a, b = out.error / out.amplitude[strong], into.error / into.amplitude[strong]  # relative errors of both lines
    gain_error = np.where(b < 1.0, gain * (a + b) / np.where(b < 1.0, 1.0 - b, 1.0), math.nan)
    phase_error = np.where(a + b < 1.0, np.arcsin(np.minimum(a + b, 1.0)), math.pi)
    return Transfer(into.frequency[strong], gain=gain, phase=np.angle(np.exp(1j * turned)), gain_error=gain_error,
                    phase_error=phase_error, run=run)


def _record(run: Run, values: np.ndarray) -> tuple[np.ndarray, int | None]:
    """The samples to use, the last n drive periods of a motion of period n or all others, and the period."""
    if run.samples < 4 or run.samples % 2:
        raise BadInput(f"A spectrum needs an even number of samples per period, at least 4, not {run.samples}.")
    recorded = len(values) // run.samples
    needed = run.regime.period or 1
    if recorded < needed or len(values) % run.samples:
        raise BadInput(f"The spectrum of a motion of period {needed} needs {needed} whole recorded drive periods; the "
                       f"run has {len(values) / run.samples:g}.")
    if run.regime.period is None:
        return values, None
    return values[-needed * run.samples :], needed


def cosines(values: np.ndarray, repeats: bool) -> np.ndarray:
    """Complex amplitudes of the cosines in equally spaced values, the mean first; Hann-windowed unless `repeats`."""
    if not repeats:
        window = np.hanning(len(values) + 1)[:-1]
        mean = float(np.average(values, weights=window))
        amplitudes = np.fft.rfft((values - mean) * window) * (2.0 / window.sum())
        amplitudes[0] = mean
    else:
        amplitudes = np.fft.rfft(values) * (2.0 / len(values))
        amplitudes[0] *= 0.5
    amplitudes[-1] *= 0.5  # at half the sampling frequency, which has no second line at −f
    return np.asarray(amplitudes)
