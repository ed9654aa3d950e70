"""The regime of a motion and its evidence: period n, quasi-periodic, chaotic, or unsettled."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from ..former_names import with_former_names
from ..kernels.strobes.periodicity import assumed_contraction

#: Names of regimes.
NAMES = ("periodic", "quasi-periodic", "chaotic", "unsettled")
#: Names of steady states that never repeat, for which no errors are stated.
NEVER_REPEATING = ("quasi-periodic", "chaotic")
#: Ways in which the orbit of a periodic motion was found: the motion settled on it, or was still approaching it.
FOUND_BY = SETTLING, NEWTON, EXTRAPOLATION = ("settling", "Newton", "extrapolation")
#: `Regime.orbit_found_by` of an approach in an older file that does not say which of the last two it was.
NOT_STATED = "not stated"
#: [all] A distance is taken to shrink by |μ| per orbit, at most 1 less this (`Regime.assumed_contraction`).
LEAST_BELOW_1 = 1e-6
#: Name of `Regime.observed_contraction` in files and JSON, whose keys do not change.
CONTRACTION_KEY = "decay"


@with_former_names
@dataclass(frozen=True)
class Regime:
    """The kind of a motion, and the evidence for it.

    Attributes
    ----------
    name : str
        One of `NAMES`.
    period : int or None
        Period of the motion in drive periods; None if it is not periodic.
    observed_contraction : float or None
        Factor by which changes shrank per orbit, 1 if they did not shrink; None if it was not observed. Files and JSON
        call it `decay`.
    distance : float or None
        Bound on a relative distance to the orbit. For a motion that settled, it is that of the motion, or of the orbit
        in a result that was computed again with finer steps (`Settled`). For an orbit that Newton's method found, it is
        the residual over 1 − |μ|, the distance of the reported orbit; the motion itself may be farther away.
    periods_run : int
        Number of drive periods run.
    lyapunov : tuple of float or None
        Lyapunov exponent per drive period and its standard error over blocks of periods; None if not measured.
    lyapunov_periods : int or None
        Drive periods over which it was measured.
    multiplier : float or None
        Largest |μ| of the n-period map; None if it was not computed. A batch computes it for orbits found by
        extrapolation that decay slowly, to about 1e-4.
    approaches : int or None
        Period of an orbit that an unsettled motion approaches.
    driven : bool
        Whether there is a drive. Without one (e.g. after an impact), the motion is a transient, and `name` is
        "unsettled".
    return_distance : float or None
        Median distance from the strobes of a record's second half to the nearest of its first half, relative to the
        largest displacement and velocity (w in a batch); known if the Lyapunov exponent is neutral (docs/regimes.md).
    return_limit : float or None
        Limit below which the `return_distance` of a quasi-periodic motion must be.
    window_ratios : tuple of float or None
        Smallest and largest ratio of the largest change in a window of periods to that in the window before, over three
        windows and all periods tried; known if the Lyapunov exponent is neutral.
    orbit_found_by : str or None
        How the orbit of a periodic motion was found: "settling" if the motion settled on it; "Newton" or
        "extrapolation" if the motion was still approaching it, "not stated" if an older file does not say which of the
        two; None for other motions. JSON and files have it under the keys `followed` and `followed_by` too.

    Examples
    --------
    >>> from granchain_core import scene, settle
    >>> regime = settle(scene("sec2").evolve(N=2, f=2000.0)).regime
    >>> regime.name, regime.period, regime.distance < 1e-4
    ('periodic', 1, True)
    """

    name: str
    period: int | None
    observed_contraction: float | None
    distance: float | None
    periods_run: int
    lyapunov: tuple[float, float] | None = None
    multiplier: float | None = None
    approaches: int | None = None
    driven: bool = True
    return_distance: float | None = None
    return_limit: float | None = None
    window_ratios: tuple[float, float] | None = None
    lyapunov_periods: int | None = None
    orbit_found_by: str | None = SETTLING

    def __post_init__(self) -> None:
        """Leave `orbit_found_by` to periodic motions."""
        if self.name != "periodic":
            object.__setattr__(self, "orbit_found_by", None)

    @classmethod
    def unsettled(cls, periods_run: int, lyapunov: tuple[float, float] | None = None,
                  lyapunov_periods: int | None = None) -> Regime:
        """Return the regime of a motion that has not settled after `periods_run` periods."""
        return cls(name="unsettled", period=None, observed_contraction=None, distance=None, periods_run=periods_run,
                   lyapunov=lyapunov, lyapunov_periods=lyapunov_periods)

    @classmethod
    def undriven(cls, periods_run: int) -> Regime:
        """Return the regime of a motion without a drive, a transient, after `periods_run` times 1/f.

        Its name is "unsettled", because files and the command line's JSON have one of `NAMES`, a list on which scripts
        rely. `driven`, which both also contain, distinguishes it from a driven motion that has not settled.
        """
        return cls(name="unsettled", period=None, observed_contraction=None, distance=None, periods_run=periods_run,
                   driven=False)

    def to_json(self) -> dict[str, Any]:
        """Return the fields under their keys in files and JSON."""
        values = {CONTRACTION_KEY if name == "observed_contraction" else name: value
                  for name, value in asdict(self).items() if name != "orbit_found_by"}
        by = self.found_by_in_files if self.is_approach else None
        return {**values, "followed": self.is_approach, "followed_by": by}

    def evidence_by_key(self) -> dict[str, Any]:
        """Return the fields, and how the orbit was found, under their keys in the command line's JSON."""
        return {**self.to_json(), "orbit_found_by": self.found_by_in_files}

    @classmethod
    def from_json(cls, kept: Mapping[str, Any]) -> Regime:
        """Return the regime from the keys of a file, whose values have been checked."""
        values = {"observed_contraction" if name == CONTRACTION_KEY else name: value
                  for name, value in kept.items() if name not in ("followed", "followed_by")}
        by = (kept.get("followed_by") or NOT_STATED) if kept.get("followed") else SETTLING
        return cls(**values, orbit_found_by=by)

    @property
    def found_by_in_files(self) -> str | None:
        """`orbit_found_by` as JSON and files have it, None where it is not stated."""
        return None if self.orbit_found_by == NOT_STATED else self.orbit_found_by

    @property
    def is_approach(self) -> bool:
        """Whether the motion was still approaching its orbit when that was found."""
        return self.orbit_found_by not in (SETTLING, None)

    @property
    def assumed_contraction(self) -> float:
        """Factor by which a distance is assumed to shrink per orbit.

        It is |μ| if known, otherwise the observed factor, otherwise `CONTRACTION_NOT_SEEN`.
        """
        if self.multiplier is not None:
            return min(1.0 - LEAST_BELOW_1, self.multiplier)
        return assumed_contraction(self.observed_contraction or 0.0)

    @property
    def evidence(self) -> str:
        """Describe |μ| if it was computed, otherwise the observed contraction factor; empty if neither is known.

        If a batch extrapolated a motion to its orbit without multipliers, its assumed contraction is not evidence.
        """
        period = self.period or self.approaches or 1
        if self.multiplier is not None:
            return f"|μ| {modulus_words(self.multiplier)}" + ("" if period == 1 else f" per {period} periods")
        if self.observed_contraction is None or self.is_approach:
            return ""
        interval = "period" if period == 1 else f"{period} periods"
        return f"transient shrinks to {modulus_words(self.observed_contraction)} every {interval}"

    @property
    def sentence(self) -> str:
        """The regime in words for the dashboard."""
        evidence = f" ({self.evidence})" if self.evidence else ""
        if self.name == "periodic":
            if self.is_approach:
                return f"period {self.period}, orbit found after {self.periods_run} periods of approach{evidence}"
            return f"period {self.period}, settled within {self.periods_run} periods{evidence}"
        if not self.driven:
            return "transient without a drive, from its start"
        if self.name == "unsettled":
            towards = f", on its way to period {self.approaches}{evidence}" if self.approaches else ""
            return f"not settled after {self.periods_run} periods{towards}"
        assert self.lyapunov is not None
        return f"{self.name}, Lyapunov exponent {exponent_words(*self.lyapunov)} per period"


def exponent_words(exponent: float, error: float) -> str:
    """Format a Lyapunov exponent and its standard error with two digits of the error, but at most seven decimals."""
    decimals = min(7, max(1, 1 - math.floor(math.log10(error)))) if 0.0 < error < math.inf else 3
    return f"{exponent:+.{decimals}f} ± {error:.{decimals}f}"


def modulus_words(modulus: float) -> str:
    """Format a modulus with enough digits to distinguish it from 1 and from 0."""
    if abs(modulus - 1.0) < 0.01:
        return f"{modulus:.6f}" if abs(modulus - 1.0) < 1e-4 else f"{modulus:.4f}"
    if modulus < 0.0095:
        mantissa, exponent = f"{modulus:.0e}".split("e")
        return f"{mantissa}e{int(exponent)}"
    return f"{modulus:.2f}" if modulus >= 0.095 else f"{modulus:.3f}"
