"""A periodic orbit with its Floquet multipliers, and its stability.

A fixed point of the n-period map is an orbit; its multipliers, the eigenvalues of the map's derivative, decide whether
it is stable. A forced orbit has no trivial multiplier 1. The observer of model (4), Zhang et al. 2016, is a
second chain driven by the first one's input force. Linearised about the first chain's motion, its tangents are those of
the first chain without the driver's contact, so its multipliers follow from the same orbit.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from ..execution.stop import Stop
from ..former_names import with_former_names
from ..results.regime import modulus_words
from ..scene import Scene
from ..scene.state import State
from ..tables import Column, Labelled, Table, axis, bead_axis, or_nan, provenance
from ..tables.provenance import Attribute
from ..tables.words import multiplier_columns, state_columns
from .multiplier_errors import derivative_change, errors_of
from .stroboscopic_map import FLOW_METHOD
from .unit_circle import are_certain, nearest_to_circle, outside

#: Multipliers smaller than this fraction of the largest are rounding errors.
ROUNDING = 1e-13


@with_former_names
@dataclass(frozen=True, eq=False, repr=False)
class Orbit(Labelled):
    """A periodic orbit with its Floquet multipliers.

    Attributes
    ----------
    scene : Scene
        The chain.
    period : int
        Period in drive periods.
    state : State
        State of the orbit at drive phase 0.
    residual : float
        Change of the state under the map, relative to displacements and w (`StroboscopicMap.residual`).
    newton_residuals : tuple of float
        The residuals of all iterations.
    multipliers : numpy.ndarray of complex, shape (2N,)
        Sorted by modulus, largest first; for more than 100 beads, only the leading ones.
    liouville_error : float or None
        Difference between the logarithm of the multipliers' product and ∫ trace, relative to the latter where that is
        above 1; None where not all multipliers are known or the smallest are rounding errors.
    contact_events : numpy.ndarray, shape (events, 2)
        Contact events along the orbit: contact + 1, negative where it opens, and the time in drive periods.
    observer_multipliers : numpy.ndarray of complex or None
        Multipliers of the observer of model (4); None unless they were requested.
    monodromy, observer_monodromy : numpy.ndarray or None, shape (2N, 2N)
        Derivatives of the n-period map with respect to scaled displacements, then w; their eigenvalues are the
        multipliers. None with more than 100 beads.
    period_note : str
        Why period 1 was assumed, in words; empty if a period was given or found.
    distance_of_motion : float or None
        For an orbit sought near a motion (`orbit_near_motion`): its least distance from the motion's states at phase 0,
        relative to their largest displacement and velocity. Otherwise None.

    Examples
    --------
    >>> from granchain_core import orbit, scene
    >>> found = orbit(scene("sec2").evolve(N=2, f=2000.0))
    >>> found.multipliers.shape, found.stable
    ((4,), True)
    """

    scene: Scene
    period: int
    state: State
    residual: float
    newton_residuals: tuple[float, ...]
    multipliers: np.ndarray
    liouville_error: float | None
    contact_events: np.ndarray
    observer_multipliers: np.ndarray | None = None
    monodromy: np.ndarray | None = None
    observer_monodromy: np.ndarray | None = None
    period_note: str = ""
    distance_of_motion: float | None = None

    @functools.cached_property
    def multiplier_errors(self) -> np.ndarray | None:
        """Absolute error of each multiplier (2N,); None with more than 100 beads.

        It is computed on first access (multiplier_errors.py), which takes as long as a Newton step.
        """
        return self._errors()

    @functools.cached_property
    def observer_multiplier_errors(self) -> np.ndarray | None:
        """Absolute error of each of the observer's multipliers (2N,); None where they were not requested."""
        return self._errors(observer=True)

    def find_errors(self, stop: Stop) -> None:
        """Compute `multiplier_errors` now. Raises `Cancelled` when another thread sets `stop`."""
        self.__dict__["multiplier_errors"] = self._errors(stop=stop)

    def _errors(self, observer: bool = False, stop: Stop | None = None) -> np.ndarray | None:
        multipliers = self.observer_multipliers if observer else self.multipliers
        observed = self.observer_monodromy if observer else None
        if self.monodromy is None or multipliers is None:
            return None
        change = derivative_change(self.scene, self.period, self.state, self.monodromy, observed, stop=stop)
        return errors_of(multipliers, self.monodromy if observed is None else observed, change)

    @property
    def stable(self) -> bool:
        """Whether no multiplier is outside the unit circle; the rule is in unit_circle.py."""
        return not self.multipliers_outside.any()

    @property
    def multipliers_outside(self) -> np.ndarray:
        """Whether each multiplier is outside the unit circle."""
        return outside(self.multipliers, self.scene.has_dissipation)

    @property
    def observer_multipliers_outside(self) -> np.ndarray | None:
        """Whether each of the observer's multipliers is outside the unit circle; None where they are not known."""
        return None if self.observer_multipliers is None else outside(self.observer_multipliers,
                                                                      self.scene.has_dissipation)

    @property
    def stability_certain(self) -> bool:
        """Whether `stable` is certain in spite of the errors; False if these are not known."""
        return are_certain(self.multipliers, self.multiplier_errors, self.scene.has_dissipation)

    def stability_words(self) -> str:
        """"stable" or "unstable", or the multiplier that is no farther from the unit circle than its error."""
        return _stability_words(self.multipliers, self.multiplier_errors, self.scene.has_dissipation)

    def observer_stability_words(self) -> str | None:
        """Like `stability_words`, for the observer; None where it was not requested."""
        if self.observer_multipliers is None:
            return None
        return _stability_words(self.observer_multipliers, self.observer_multiplier_errors, self.scene.has_dissipation)

    @property
    def observer_stability_certain(self) -> bool | None:
        """Whether `observer_stable` is certain in spite of the errors; None where the observer was not requested."""
        if self.observer_multipliers is None:
            return None
        return are_certain(self.observer_multipliers, self.observer_multiplier_errors, self.scene.has_dissipation)

    @property
    def leading_observer_multiplier(self) -> complex | None:
        """The observer's multiplier with the largest modulus; None where its multipliers are not known."""
        return None if self.observer_multipliers is None else complex(self.observer_multipliers[0])

    @property
    def observer_stable(self) -> bool | None:
        """Like `stable`, for the observer; None where it was not requested."""
        beyond = self.observer_multipliers_outside
        return None if beyond is None else not beyond.any()

    def tables(self) -> tuple[Table, ...]:
        """`multipliers`, with the observer's where known; `state`; `newton`, the residuals of the search."""
        columns = multiplier_columns(self.multipliers, ("rank",), self.multiplier_errors)
        if self.observer_multipliers is not None:
            errors = self.observer_multiplier_errors
            columns |= multiplier_columns(self.observer_multipliers, ("rank",), errors, "observer_")
        ranks = axis("rank", np.arange(len(self.multipliers)), "1", "place by modulus, 0 is the largest")
        residuals = Column(np.array(self.newton_residuals), ("iteration",), "1",
                           "change of the state under the map, relative to the largest displacement and the largest w")
        return (Table("multipliers", ranks, columns),
                Table("state", bead_axis(self.scene.N),
                      state_columns(self.state.displacement, self.state.velocity, ("bead",))),
                Table("newton", axis("iteration", np.arange(len(self.newton_residuals)), "1",
                                     "evaluation of Newton's method"), {"residual": residuals}))

    def attributes(self) -> dict[str, Attribute]:
        """Period, residual, stability and provenance."""
        values: dict[str, Attribute] = {
            **provenance(self.scene, FLOW_METHOD, None), "period": self.period, "residual": self.residual,
            "stable": int(self.stable), "liouville": or_nan(self.liouville_error)}
        if self.distance_of_motion is not None:
            values["distance_of_motion"] = self.distance_of_motion
        return values if self.observer_stable is None else {**values, "observer_stable": int(self.observer_stable)}

    def summary(self) -> list[str]:
        """Period, stability, the leading multiplier and the residual."""
        lead = self.multipliers[0]
        observer = "" if self.observer_stable is None else f"; observer {self.observer_stability_words()}"
        return [f"period {self.period}, {self.stability_words()}{observer}",
                f"leading multiplier {lead.real:+.4f}{lead.imag:+.4f}i, |μ| {modulus_words(abs(lead))}"
                + ("" if self.multiplier_errors is None else f" ± {self.multiplier_errors[0]:.0e}"),
                f"closes to {self.residual:.1e} of its largest displacement and w",
                *([] if self.distance_of_motion is None else [self.distance_words()]),
                *([self.period_note] if self.period_note else [])]

    def distance_words(self) -> str:
        """Distance of the motion from an orbit that was sought near it, in words; empty for any other orbit."""
        if self.distance_of_motion is None:
            return ""
        return f"the motion comes within {self.distance_of_motion:.2g} of it, relative to its own size"


def _stability_words(multipliers: np.ndarray, errors: np.ndarray | None, damped: bool) -> str:
    if errors is None or are_certain(multipliers, errors, damped):
        return "unstable" if outside(multipliers, damped).any() else "stable"
    nearest = nearest_to_circle(multipliers, errors, damped)
    return f"stability not decided (|μ| {modulus_words(abs(multipliers[nearest]))} ± {errors[nearest]:.0e})"


def liouville_if_known(multipliers: np.ndarray, log_determinant: float) -> float | None:
    """Error of Liouville's formula; None where the smallest multiplier is a rounding error."""
    sizes = np.abs(multipliers)
    return None if sizes.min() < ROUNDING * sizes.max() else liouville_error(multipliers, log_determinant)


def liouville_error(multipliers: np.ndarray, log_determinant: float) -> float:
    """Difference between ln |det| and ∫ trace, relative to the latter where that is above 1."""
    with np.errstate(divide="ignore"):
        log_product = float(np.sum(np.log(np.abs(multipliers))))
    return abs(log_product - log_determinant) / max(1.0, abs(log_determinant))


def sorted_multipliers(derivative: np.ndarray) -> np.ndarray:
    """Eigenvalues of a monodromy matrix, largest modulus first."""
    multipliers = np.linalg.eigvals(derivative)
    return multipliers[np.argsort(-np.abs(multipliers), kind="stable")]
