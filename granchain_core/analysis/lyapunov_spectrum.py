"""All Lyapunov exponents of the stroboscopic map, and the Kaplan–Yorke dimension of its attractor.

Equation   Q_{p+1} R_{p+1} = M_p Q_p with M_p the derivative of the map over period p
           λ_i = ⟨ln |R_ii|⟩ per drive period
           D_KY = j + (λ_1 + … + λ_j) / |λ_{j+1}| with the largest j for which the sum is not negative
Source     Benettin et al. 1980; Kaplan & Yorke 1979; standard errors from means of blocks
Note       The sum of all exponents is the mean of ∫ trace along the motion (Liouville), which is computed too.
           Standard errors take the means of the blocks as independent. The blocks are plain ones, not those of
           steady/lyapunov.py: on a closed curve their error covers the swing of the growth (docs/analysis.md), and
           where all blocks hold the same part of the swing, half of the swing over the periods is the error.
           A strong dashpot shrinks some directions by more than double precision resolves in a period: such
           exponents are bounds from above, and `resolved` says how many are more than that.
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

#: [no threshold] Directions whose stretching in one period is at most this fraction of the largest are rounding. The
#: derivative errs by about 1e-13 of its largest entry (the tolerance of its flow), so that an error of ten per cent of
#: the stretching is still none; an exponent is its logarithm.
_ROUNDING = 1e-12
#: [no threshold] First periods, which are left out of the means: in them the directions align with those of the
#: exponents. What is left of the alignment falls as exp(−(λ_i − λ_{i+1}) P), slowly where two are near. It is part of
#: the swing, so that it moves a mean by at most twice the stated error. Over the same 400 periods the exponents after
#: 200 periods of alignment differ from those after 50 by at most 1.9 stated errors on four orbits (in `precompressed`,
#: where the leading two differ by 5e-5), by 0.5 on a torus and by 0.08 in two chaotic motions.
_ALIGNMENT_PERIODS = 50
#: [no threshold] Most periods of one measurement.
MOST_SPECTRUM_PERIODS = 1_000_000
#: [no threshold] Blocks over which the standard errors are taken. Twenty means give a standard error to 16 %; a block
#: of the fewest periods allowed is then one period.
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
        Per drive period, largest first, and their standard errors: of the means of 20 blocks taken as independent, at
        least half the swing of the summed growth over the number of periods.
    dimension : float or None
        Kaplan–Yorke dimension of the section's attractor, from the exponents without their errors; 1 on a closed curve
        (`on_closed_curve`).
    dimension_range : tuple of float or None
        The dimension with all exponents one standard error lower, and higher.
    resolved : int
        Number of exponents that are resolved; the others are upper bounds.
    periods : int
        Drive periods over which they are means.
    mean_trace : float
        Mean of ∫ trace per period: what the exponents must add up to if all are resolved.
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
        """Whether the regime is quasi-periodic and all exponents but the largest are surely negative.

        The largest exponent is 0 then, whose sign no record can show.
        """
        return self.regime == "quasi-periodic" and self.resolved > 1 and bool(
            self.exponents[1:].max() < -self.errors[np.argmax(self.exponents[1:]) + 1])

    @property
    def dimension(self) -> float | None:
        """Kaplan–Yorke dimension of the section's attractor; that of the flow is one more.

        1 on a closed curve; 2N where no sum is negative, as without damping; None where it depends on exponents that
        are not resolved.
        """
        if self.on_closed_curve:
            return 1.0
        return _kaplan_yorke(self.exponents, self.resolved)

    @property
    def dimension_range(self) -> tuple[float, float] | None:
        """The dimension with all exponents one standard error lower, and higher; None where one of them is not known.

        A range and no confidence interval: the errors of the exponents are taken to have the same sign. On a closed
        curve both are 1.
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
        """Difference of the exponents' sum from the mean trace, over the larger of |mean trace| and 1.

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
                               "1 if it is known, 0 if it is at most what is given")}),)

    def attributes(self) -> dict[str, Attribute]:
        """Dimension and sums, and where they come from."""
        low, high = self.dimension_range or (None, None)
        return {**provenance(self.scene, FLOW_METHOD, None), "periods": self.periods, "regime": self.regime,
                "mean_trace": self.mean_trace,
                "dimension": or_nan(self.dimension), "liouville": or_nan(self.liouville_error),
                "dimension_low": or_nan(low), "dimension_high": or_nan(high)}

    def summary(self) -> list[str]:
        """The leading exponents and the dimension."""
        shown = [f"{e:+.4f} ± {s:.4f}" for e, s in zip(self.exponents[:4], self.errors, strict=False)]
        return [f"leading exponents per drive period: {', '.join(shown)}",
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
    """The dimension from exponents (2N,), of which the first `resolved` are known and the rest smaller."""
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
    """All Lyapunov exponents of the motion that a chain settles to.

    Parameters
    ----------
    scene : Scene
        The chain, of at most 100 beads, tension allowed.
    periods : int
        Drive periods over which the exponents are means, 20 to 1,000,000.
    start : State, optional
        Where the chain starts before it settles; its scene's start if not given.
    stop : Stop, optional
        Once it is set the computation ends with `Cancelled`.
    progress : callable, optional
        Called with the fraction that is done, 0 to 1.

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
    # the factorization puts them in this order in the limit only: near ones may have changed places
    order = np.concatenate([np.argsort(-exponents[:resolved], kind="stable"), np.arange(resolved, len(x))])
    mean_trace = float(traces[_ALIGNMENT_PERIODS:].mean())
    return LyapunovSpectrum(scene, exponents[order], errors[order], resolved, periods, mean_trace,
                            settling.regime.name)


def _growth(stroboscopic_map: StroboscopicMap, x: np.ndarray, periods: int,
            progress: Callable[[float], None] | None) -> tuple[np.ndarray, np.ndarray, int]:
    """Logarithms of the stretching of 2N orthogonal directions in each period (P, 2N), and ∫ trace over it (P,).

    The third value is the number of leading directions whose stretching is above rounding in every period.
    """
    directions, growth, traces = np.eye(len(x)), np.zeros((periods, len(x))), np.zeros(periods)
    rounding = np.zeros(len(x), dtype=bool)
    for p in range(periods):
        flow = stroboscopic_map(x, directions=directions)
        directions, triangle = np.linalg.qr(flow.derivative)
        stretching = np.abs(np.diag(triangle))
        rounding |= stretching <= _ROUNDING * stretching.max()
        growth[p] = np.log(np.maximum(stretching, np.finfo(float).tiny))
        x, traces[p] = flow.end, flow.log_determinant
        if progress is not None:
            progress((p + 1) / periods)
    return growth, traces, int(np.argmax(rounding)) if rounding.any() else len(x)


def _exponents(growth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means (n,) of the growth (P, n) over the periods, and their standard errors."""
    exponents = growth.mean(axis=0)
    blocks = np.array([part.mean(axis=0) for part in np.array_split(growth, _BLOCKS)])
    errors = blocks.std(axis=0, ddof=1) / np.sqrt(_BLOCKS)
    return exponents, np.maximum(errors, _swing(growth - exponents) / (2.0 * len(growth)))


def _swing(deviations: np.ndarray) -> np.ndarray:
    """Highest less lowest of the summed deviations from the mean growth (P, n), from before the first period on.

    Complex multipliers turn the directions; if a block holds a whole number of half turns, all block means are alike,
    and their scatter does not show what the unfinished half turn at the end of the record leaves in the mean.
    """
    sums = np.cumsum(deviations, axis=0)
    return np.maximum(sums.max(axis=0), 0.0) - np.minimum(sums.min(axis=0), 0.0)
