"""All Lyapunov exponents of the stroboscopic map, and the Kaplan–Yorke dimension of its attractor.

Equation   Q_{k+1} R_{k+1} = M_k Q_k with M_k the derivative of the map over period k
           λ_i = ⟨ln |R_ii|⟩ per drive period
           D_KY = j + (λ_1 + … + λ_j) / |λ_{j+1}| with the largest j for which the sum is not negative
Source     Benettin et al. 1980; Kaplan & Yorke 1979; standard errors from means of blocks
Note       The sum of all exponents is the mean of ∫ trace along the motion (Liouville), which is computed too.
           Standard errors treat the means of the blocks as independent. The blocks do not overlap, unlike those of
           steady/lyapunov.py: on a closed curve their error covers the swing of the growth (docs/analysis.md). Where
           all blocks contain the same part of the swing, the error is half of the swing over the number of periods.
           In one period, a strong dashpot shrinks some directions by more than double precision resolves: such
           exponents are only upper bounds, and `resolved` is the number of the others.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..execution.stop import Stop
from ..former_names import with_former_names
from ..inputs.checks import check_range, whole_number
from ..orbits.stroboscopic_map import FLOW_METHOD, StroboscopicMap
from ..scene import Scene
from ..scene.refusals import require_scene
from ..scene.state import State
from ..steady.settling.advance import run_until_settled
from ..steady.settling.nearby_orbit import MOST_BEADS_WITH_MULTIPLIERS
from ..tables import Column, Labelled, Table, axis, or_nan, provenance
from ..tables.provenance import Attribute

#: [no threshold] The stretching of a direction in one period is rounding if it is at most this fraction of the largest.
#: The error of the derivative is about 1e-13 of its largest entry (the tolerance of its flow), so it is at most ten per
#: cent of a larger stretching, which is little in an exponent, the logarithm.
_ROUNDING = 1e-12
#: [no threshold] First periods, which are left out of the means: in them, the directions align with those of the
#: exponents. The remaining misalignment falls as exp(−(λ_i − λ_{i+1}) P), slowly where two exponents are close. It is
#: part of the swing, so it moves a mean by at most twice the stated error. Over the same 400 periods, the exponents
#: after 200 periods of alignment differ from those after 50 by at most 1.9 stated errors on four orbits (in
#: `precompressed`, where the leading two differ by 5e-5), by 0.5 on a torus and by 0.08 in two chaotic motions.
_ALIGNMENT_PERIODS = 50
#: [no threshold] Maximum number of periods of one measurement.
MOST_SPECTRUM_PERIODS = 1_000_000
#: [no threshold] Number of blocks from which the standard errors are computed. Twenty means give a standard error to
#: 16 %; with the fewest periods allowed, a block is one period.
_BLOCKS = 20


@with_former_names
@dataclass(frozen=True, eq=False, repr=False)
class LyapunovSpectrum(Labelled):
    """The Lyapunov exponents of a motion.

    Attributes
    ----------
    scene : Scene
        The chain.
    exponents, errors : numpy.ndarray, shape (2N,)
        Exponents per drive period, largest first, and their standard errors. These follow from the means of 20 blocks
        treated as independent, and are at least half the swing of the summed growth over the number of periods.
    dimension : float or None
        Kaplan–Yorke dimension of the section's attractor, from the exponents without their errors; 1 on a closed curve
        (`on_closed_curve`).
    dimension_range : tuple of float or None
        The dimension with all exponents one standard error lower, and higher.
    resolved : int
        Number of exponents that are resolved; the others are upper bounds.
    periods : int
        Number of drive periods over which the exponents are means.
    mean_trace : float
        Mean of ∫ trace per period: the sum of the exponents if all are resolved.
    regime : str
        What kind of motion it is (`Regime.name`).

    Examples
    --------
    >>> from granchain_core import lyapunov_spectrum, scene
    >>> found = lyapunov_spectrum(scene("sec2").evolve(N=2, f=2000.0), periods=40)
    >>> found.exponents.shape, bool(found.exponents[0] < 0.0), found.dimension
    ((4,), True, 0.0)
    """

    scene: Scene
    exponents: np.ndarray
    errors: np.ndarray
    resolved: int
    periods: int
    mean_trace: float
    regime: str = ""

    @property
    def on_closed_curve(self) -> bool:
        """Whether the regime is quasi-periodic and all exponents but the largest are certainly negative.

        The largest exponent is then 0, and no record can show its sign.
        """
        return self.regime == "quasi-periodic" and self.resolved > 1 and bool(
            self.exponents[1:].max() < -self.errors[np.argmax(self.exponents[1:]) + 1])

    @property
    def dimension(self) -> float | None:
        """Kaplan–Yorke dimension of the section's attractor; that of the flow is one more.

        It is 1 on a closed curve, 2N where no sum is negative, as without damping, and None where it depends on
        exponents that are not resolved.
        """
        if self.on_closed_curve:
            return 1.0
        return _kaplan_yorke(self.exponents, self.resolved)

    @property
    def dimension_range(self) -> tuple[float, float] | None:
        """The dimension with all exponents one standard error lower, and higher; None if one of the two is not known.

        This is a range, not a confidence interval: the errors of all exponents are assumed to have the same sign. On a
        closed curve, both are 1.
        """
        if self.on_closed_curve:
            return 1.0, 1.0
        low = _kaplan_yorke(self.exponents - self.errors, self.resolved)
        high = _kaplan_yorke(self.exponents + self.errors, self.resolved)
        return None if low is None or high is None else (low, high)

    @property
    def dimension_resolved(self) -> bool:
        """Whether the range is known and has no jump: the largest exponent has one sign within its standard error."""
        span, certain = self.dimension_range, abs(self.exponents[0]) > self.errors[0]
        return self.dimension is not None and span is not None and bool(certain or span[0] == span[1])

    @property
    def liouville_error(self) -> float | None:
        """Difference between the exponents' sum and the mean trace, over the larger of |mean trace| and 1.

        None unless all exponents are resolved.
        """
        if self.resolved < len(self.exponents):
            return None
        return float(abs(self.exponents.sum() - self.mean_trace) / max(1.0, abs(self.mean_trace)))

    def tables(self) -> tuple[Table, ...]:
        """One table, `lyapunov`: exponents with their errors."""
        along, ranks = ("rank",), np.arange(len(self.exponents))
        return (Table("lyapunov", axis("rank", ranks, "1", "place by size, 0 is the largest"), {
            "exponent": Column(self.exponents, along, "1", "Lyapunov exponent per drive period"),
            "error": Column(self.errors, along, "1", "its standard error"),
            "resolved": Column((ranks < self.resolved).astype(np.int8), along, "1",
                               "1 if it is resolved, 0 if it is an upper bound")}),)

    def attributes(self) -> dict[str, Attribute]:
        """Dimension, sums and provenance."""
        low, high = self.dimension_range or (None, None)
        return {**provenance(self.scene, FLOW_METHOD, None), "periods": self.periods, "regime": self.regime,
                "mean_trace": self.mean_trace,
                "dimension": or_nan(self.dimension), "liouville": or_nan(self.liouville_error),
                "dimension_low": or_nan(low), "dimension_high": or_nan(high)}

    def summary(self) -> list[str]:
        """The leading exponents and the dimension."""
        largest = [f"{e:+.4f} ± {s:.4f}" for e, s in zip(self.exponents[:4], self.errors, strict=False)]
        return [f"leading exponents per drive period: {', '.join(largest)}",
                f"Kaplan–Yorke dimension of the section: {self.dimension_words()}",
                f"{self.resolved} of {len(self.exponents)} resolved, over {self.periods} periods"]

    def dimension_words(self) -> str:
        """The dimension with its range; "not resolved" where the sign of the largest exponent decides."""
        if self.on_closed_curve:
            return "1 (closed curve)"
        if self.dimension is None:
            return "not known"
        if self.dimension_range is None:
            return f"{self.dimension:.3f}, its range is not known"
        low, high = self.dimension_range
        if not self.dimension_resolved:
            why = "more periods show whether it is 1 (closed curve)" if self.regime == "quasi-periodic" \
                else "the sign of the largest exponent decides"
            return f"not resolved, {low:.3f} to {high:.3f}: {why}"
        return f"{self.dimension:.3f}" + (f" ({low:.3f} to {high:.3f})" if high > low else "")


def _kaplan_yorke(exponents: np.ndarray, resolved: int) -> float | None:
    """The dimension from exponents (2N,), of which the first `resolved` are known and the others smaller."""
    exponents = np.concatenate([np.sort(exponents[:resolved])[::-1], exponents[resolved:]])
    sums = np.cumsum(exponents)
    if sums[0] < 0.0:
        return 0.0
    last = int(np.nonzero(sums >= 0.0)[0][-1])
    if last + 1 >= resolved:
        return float(len(sums)) if resolved == len(sums) else None
    return float(last + 1 + sums[last] / abs(exponents[last + 1]))


def lyapunov_spectrum(scene: Scene, periods: int = 400, start: State | None = None, stop: Stop | None = None,
                      progress: Callable[[float], None] | None = None) -> LyapunovSpectrum:
    """Compute all Lyapunov exponents of the motion that a chain settles to.

    Parameters
    ----------
    scene : Scene
        The chain, of at most 100 beads, with tension allowed.
    periods : int
        Number of drive periods over which the exponents are means, 20 to 1,000,000.
    start : State, optional
        Where the chain starts to settle; by default the scene's own start.
    stop : Stop, optional
        Once it is set, the computation ends with `Cancelled`.
    progress : callable, optional
        Called with the completed fraction, 0 to 1.

    Returns
    -------
    LyapunovSpectrum
        Exponents with standard errors.

    Raises
    ------
    BadInput
        Too many beads, tension cut, or a number of periods out of range.
    ComputationError
        The motion did not stay finite.

    Examples
    --------
    >>> from granchain_core import lyapunov_spectrum, scene
    >>> found = lyapunov_spectrum(scene("sec2").evolve(N=2, f=2000.0), periods=20)
    >>> bool(found.exponents.sum() < 0.0)
    True
    """
    require_scene(scene)
    periods = whole_number("periods =", periods, _BLOCKS, MOST_SPECTRUM_PERIODS)
    check_range("N =", scene.N, 1, MOST_BEADS_WITH_MULTIPLIERS)
    stroboscopic_map = StroboscopicMap(scene, 1, stop)
    settling = run_until_settled(scene, start, stop)
    x = stroboscopic_map.inner(settling.engine.y)
    growth, traces, resolved = _growth(stroboscopic_map, x, _ALIGNMENT_PERIODS + periods, progress)
    exponents, errors = _exponents(growth[_ALIGNMENT_PERIODS:])
    # the factorization sorts them only in the limit: close ones may be out of order
    order = np.concatenate([np.argsort(-exponents[:resolved], kind="stable"), np.arange(resolved, len(x))])
    mean_trace = float(traces[_ALIGNMENT_PERIODS:].mean())
    return LyapunovSpectrum(scene, exponents=exponents[order], errors=errors[order], resolved=resolved, periods=periods,
                            mean_trace=mean_trace, regime=settling.regime.name)


def _growth(stroboscopic_map: StroboscopicMap, x: np.ndarray, periods: int,
            progress: Callable[[float], None] | None) -> tuple[np.ndarray, np.ndarray, int]:
    """Logarithms of the stretching of 2N orthogonal directions in each period (P, 2N), and ∫ trace over it (P,).

    The third result is the number of leading directions whose stretching is above rounding in every period.
    """
    directions, growth, traces = np.eye(len(x)), np.zeros((periods, len(x))), np.zeros(periods)
    rounding = np.zeros(len(x), dtype=bool)
    for k in range(periods):
        flow = stroboscopic_map(x, directions=directions)
        directions, triangle = np.linalg.qr(flow.derivative)
        stretching = np.abs(np.diag(triangle))
        rounding |= stretching <= _ROUNDING * stretching.max()
        growth[k] = np.log(np.maximum(stretching, np.finfo(float).tiny))
        x, traces[k] = flow.end, flow.log_determinant
        if progress is not None:
            progress((k + 1) / periods)
    return growth, traces, int(np.argmax(rounding)) if rounding.any() else len(x)


def _exponents(growth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means (n,) of the growth (P, n) over the periods, and their standard errors."""
    exponents = growth.mean(axis=0)
    blocks = np.array([part.mean(axis=0) for part in np.array_split(growth, _BLOCKS)])
    errors = blocks.std(axis=0, ddof=1) / np.sqrt(_BLOCKS)
    return exponents, np.maximum(errors, _swing(growth - exponents) / (2.0 * len(growth)))


def _swing(deviations: np.ndarray) -> np.ndarray:
    """Range of the cumulative sums, including 0 at the start, of deviations (P, n) from the mean growth.

    Complex multipliers turn the directions. If a block contains a whole number of half turns, all block means are
    alike, and their scatter does not show how the unfinished half turn at the end of the record changes the mean.
    """
    sums = np.cumsum(deviations, axis=0)
    return np.maximum(sums.max(axis=0), 0.0) - np.minimum(sums.min(axis=0), 0.0)
