"""Periodic orbits by Newton's method on the stroboscopic map, with their Floquet multipliers.

A fixed point of the n-period map is an orbit, stable or not: that is decided by its multipliers, the eigenvalues of
the map's derivative. A forced orbit has no trivial multiplier 1. The observer of model (4), Zhang et al. 2016, is a
second chain pushed by the first one's input force. Linearised about the first chain's motion, its tangents are those of
the first chain without the driver's contact, so its multipliers come from the same orbit.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np

from ..errors import ComputationError
from ..execution.stop import Stop
from ..inputs.checks import whole_number
from ..integrate.scaling import scales_of
from ..integrate.start import at_phase_0
from ..results.regime import Regime, modulus_words
from ..scene import Scene
from ..scene.refusals import require_scene
from ..scene.state import State
from ..steady.regime_criteria import LONGEST_LOCKED_PERIOD
from ..steady.residuals import ACCEPTED_RESIDUAL, RESIDUAL_GOAL
from ..steady.settling.advance import run_until_settled
from ..steady.settling.nearby_orbit import MOST_BEADS_WITH_MULTIPLIERS
from ..tables import Column, Labelled, Table, axis, bead_axis, or_nan, provenance
from ..tables.provenance import Attribute
from ..tables.words import multiplier_columns, state_columns
from .multiplier_errors import derivative_change, errors_of
from .stroboscopic_map import FLOW_METHOD, Flow, StroboscopicMap, refuse_cut

#: Why an orbit has period 1 where a start was given.
NO_PERIOD_GIVEN = "period 1 was taken, because a start was given without a period"
#: Newton's iterations at most.
MOST_ITERATIONS = 12
#: Multipliers smaller than this part of the largest are rounding.
ROUNDING = 1e-13
#: Most halvings of a Newton step before the iteration fails.
_MOST_HALVINGS = 6


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
        Change of the state by the map, relative to displacements and w (`StroboscopicMap.residual`).
    newton_residuals : tuple of float
        The residuals of all iterations.
    multipliers : numpy.ndarray of complex, shape (2N,)
        Sorted by modulus, largest first; of more than 100 beads the leading ones only.
    liouville : float or None
        Difference between the logarithm of the multipliers' product and ∫ trace, relative to the latter where that is
        above 1; None where not all multipliers are known or the smallest are rounding.
    contact_events : numpy.ndarray, shape (events, 2)
        Contact events along the orbit: contact + 1, negative where it opens, and the time over the drive period.
    observer_multipliers : numpy.ndarray of complex or None
        Those of the observer of model (4), where they were requested.
    monodromy, observer_monodromy : numpy.ndarray or None, shape (2N, 2N)
        Derivatives of the n-period map in scaled displacements, then w, whose eigenvalues the multipliers are; None
        with more than 100 beads.
    period_note : str
        Why period 1 was assumed, in words; empty if a period was given or found.

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
    liouville: float | None
    contact_events: np.ndarray
    observer_multipliers: np.ndarray | None = None
    monodromy: np.ndarray | None = None
    observer_monodromy: np.ndarray | None = None
    period_note: str = ""

    @property
    def changes(self) -> np.ndarray:
        """The older name of `contact_events`."""
        return self.contact_events

    @functools.cached_property
    def multiplier_errors(self) -> np.ndarray | None:
        """Absolute error of each multiplier (2N,); None with more than 100 beads.

        The first access computes it (multiplier_errors.py), in the time of a Newton step.
        """
        return self._errors()

    @functools.cached_property
    def observer_multiplier_errors(self) -> np.ndarray | None:
        """Absolute error of each of the observer's multipliers (2N,).

        None where they were not requested.
        """
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
        """Whether all multipliers are inside the unit circle."""
        return bool(np.abs(self.multipliers).max() < 1.0)

    @property
    def stability_certain(self) -> bool:
        """Whether `stable` holds in spite of the errors; False if these are not known."""
        return _is_certain(self.multipliers, self.multiplier_errors)

    def stability_words(self) -> str:
        """"stable" or "unstable", or the multiplier that is no farther from the unit circle than its error."""
        return _stability_words(self.multipliers, self.multiplier_errors)

    def observer_stability_words(self) -> str | None:
        """The words for the observer; None where it was not requested."""
        if self.observer_multipliers is None:
            return None
        return _stability_words(self.observer_multipliers, self.observer_multiplier_errors)

    @property
    def observer_stability_certain(self) -> bool | None:
        """Whether `observer_stable` holds in spite of the errors; None where the observer was not requested."""
        if self.observer_multipliers is None:
            return None
        return _is_certain(self.observer_multipliers, self.observer_multiplier_errors)

    @property
    def observer_stable(self) -> bool | None:
        """Whether the observer's multipliers are all inside the unit circle."""
        if self.observer_multipliers is None:
            return None
        return bool(np.abs(self.observer_multipliers).max() < 1.0)

    def tables(self) -> tuple[Table, ...]:
        """`multipliers`, the observer's too where they are known; `state`; `newton`, the residuals of the search."""
        columns = multiplier_columns(self.multipliers, ("rank",), self.multiplier_errors)
        if self.observer_multipliers is not None:
            errors = self.observer_multiplier_errors
            columns |= multiplier_columns(self.observer_multipliers, ("rank",), errors, "observer_")
        ranks = axis("rank", np.arange(len(self.multipliers)), "1", "place by modulus, 0 is the largest")
        residuals = Column(np.array(self.newton_residuals), ("iteration",), "1",
                           "change of the state by the map, relative to the largest displacement and the largest w")
        return (Table("multipliers", ranks, columns),
                Table("state", bead_axis(self.scene.N),
                      state_columns(self.state.displacement, self.state.velocity, ("bead",))),
                Table("newton", axis("iteration", np.arange(len(self.newton_residuals)), "1",
                                     "evaluation of Newton's method"), {"residual": residuals}))

    def attributes(self) -> dict[str, Attribute]:
        """Period, residual, stability, and the provenance."""
        values: dict[str, Attribute] = {
            **provenance(self.scene, FLOW_METHOD, None), "period": self.period, "residual": self.residual,
            "stable": int(self.stable), "liouville": or_nan(self.liouville)}
        return values if self.observer_stable is None else {**values, "observer_stable": int(self.observer_stable)}

    def summary(self) -> list[str]:
        """Period, stability, the leading multiplier and the residual."""
        lead = self.multipliers[0]
        observer = "" if self.observer_stable is None else f"; observer {self.observer_stability_words()}"
        return [f"period {self.period}, {self.stability_words()}{observer}",
                f"leading multiplier {lead.real:+.4f}{lead.imag:+.4f}i, |μ| {modulus_words(abs(lead))}"
                + ("" if self.multiplier_errors is None else f" ± {self.multiplier_errors[0]:.0e}"),
                f"closes to {self.residual:.1e} of its largest displacement and w",
                *([self.period_note] if self.period_note else [])]


def periodic_orbit(scene: Scene, period: int | None = None, start: State | None = None, observer: bool = False,
                   stop: Stop | None = None) -> Orbit:
    """A periodic orbit, stable or not, by Newton's method.

    Its Floquet multipliers are the eigenvalues of the map's derivative, computed with the orbit (docs/orbits.md).

    Parameters
    ----------
    scene : Scene
        The chain; its tension must not be cut.
    period : int, optional
        Period in drive periods. By default that of the steady state; 1 if the steady state is not periodic, or if
        `start` is given. `Orbit.period_note` then says why.
    start : State, optional
        Where Newton's method begins; by default the steady state reached from rest.
    observer : bool
        Whether to compute the multipliers of the observer, model (4) of Zhang et al. 2016.
    stop : Stop, optional
        Ends the computation when another thread sets it.

    Returns
    -------
    Orbit
        The orbit that was found.

    Raises
    ------
    BadInput
        The period is out of range, or the scene cuts tension.
    ComputationError
        Newton's method did not converge; the message has its residuals.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import orbit, scene
    >>> found = orbit(scene("sec2").evolve(N=2, f=2000.0))
    >>> found.period, found.residual < 1e-10
    (1, True)
    >>> bool(abs(found.multipliers[0]) < 1.0)
    True
    """
    require_scene(scene)
    n = None if period is None else whole_number("period", period, 1, LONGEST_LOCKED_PERIOD)
    refuse_cut(scene)
    note = ""
    if start is None:
        settling = run_until_settled(scene, None, stop)
        if n is None and settling.regime.period is None:
            note = f"period 1 was taken, because the motion from rest is {_no_period(settling.regime)}"
        n = n or settling.regime.period or 1
        start = settling.engine.state
    else:
        if n is None:
            note = NO_PERIOD_GIVEN
        start = at_phase_0(scene, start, stop)
    n = n or 1
    stroboscopic_map = StroboscopicMap(scene, n, stop)
    x = stroboscopic_map.inner(stroboscopic_map.engine.scaled.from_si(start))
    x, flow, history = _newton(stroboscopic_map, x)
    return replace(_orbit(scene, n, stroboscopic_map, x, flow, history, observer), period_note=note)


def _no_period(regime: Regime) -> str:
    """The regime of a motion without a period, in words."""
    return f"not settled after {regime.periods_run} periods" if regime.name == "unsettled" else regime.name


def random_state(scene: Scene, seed: int) -> State:
    """A random start: normally distributed displacements and velocities in units of A0 and A0·φ."""
    scales = scales_of(scene)
    draw = np.random.default_rng(seed).standard_normal((2, scene.N))
    return State(draw[0] * scales.length, draw[1] * scales.velocity)


def _newton(stroboscopic_map: StroboscopicMap, x: np.ndarray) -> tuple[np.ndarray, Flow, list[float]]:
    """Damped Newton iterations."""
    flow = _flow(stroboscopic_map, x)
    history = [stroboscopic_map.residual(flow.end, x)]
    while history[-1] > RESIDUAL_GOAL and len(history) <= MOST_ITERATIONS:
        step = _newton_step(stroboscopic_map, x, flow)
        for halving in range(_MOST_HALVINGS):
            trial = x + step / 2**halving
            try:
                after = _flow(stroboscopic_map, trial)
            except ComputationError:  # a state too far away to be followed: a shorter step is nearer
                continue
            if stroboscopic_map.residual(after.end, trial) < history[-1]:
                break
        else:
            break
        x, flow = trial, after
        history.append(stroboscopic_map.residual(flow.end, x))
    if history[-1] > ACCEPTED_RESIDUAL:
        residuals = ", ".join(f"{r:.1e}" for r in history)
        raise ComputationError(f"Newton's method found no orbit of {stroboscopic_map.periods} drive periods near this "
                               f"start: its residuals were {residuals}; give another period or start.",
                               "no-convergence")
    return x, flow, history


def _dense(x: np.ndarray) -> bool:
    return len(x) <= 2 * MOST_BEADS_WITH_MULTIPLIERS


def _flow(stroboscopic_map: StroboscopicMap, x: np.ndarray) -> Flow:
    """The flow from x, with the derivative where it is computed as a whole."""
    return stroboscopic_map(x) if _dense(x) else stroboscopic_map(x, directions=np.zeros((len(x), 0)))


def _newton_step(stroboscopic_map: StroboscopicMap, x: np.ndarray, flow: Flow) -> np.ndarray:
    if not _dense(x):
        from .krylov import newton_step  # scipy.sparse.linalg takes 0.2 s to load, which only long chains need

        return newton_step(stroboscopic_map, x, flow.end)
    try:
        return np.linalg.solve(flow.derivative - np.eye(len(x)), x - flow.end)
    except np.linalg.LinAlgError:
        raise ComputationError("Newton's step does not exist: a multiplier is 1, as at a fold; move the knob a little.",
                               "no-convergence") from None


def _orbit(scene: Scene, n: int, stroboscopic_map: StroboscopicMap, x: np.ndarray, flow: Flow, history: list[float],
           observer: bool) -> Orbit:
    liouville = monodromy = observer_monodromy = None
    if _dense(x):
        monodromy, multipliers = flow.derivative, sorted_multipliers(flow.derivative)
        liouville = _liouville(multipliers, flow.log_determinant)
        observer_monodromy = stroboscopic_map(x, observer=True).derivative if observer else None
        observer_multipliers = None if observer_monodromy is None else sorted_multipliers(observer_monodromy)
    else:
        from .krylov import leading_multipliers

        multipliers = leading_multipliers(stroboscopic_map, x)
        observer_multipliers = leading_multipliers(stroboscopic_map, x, observer=True) if observer else None
    scaled = stroboscopic_map.engine.scaled
    return Orbit(scene, n, scaled.to_si(scaled.embed(x)), history[-1], tuple(history), multipliers, liouville,
                 flow.contact_events, observer_multipliers, monodromy, observer_monodromy)


def _is_certain(multipliers: np.ndarray, errors: np.ndarray | None) -> bool:
    """Whether all multipliers are inside the unit circle by more than their errors, or at least one is outside."""
    sizes = np.abs(multipliers)
    return errors is not None and bool((sizes + errors < 1.0).all() or (sizes - errors > 1.0).any())


def _stability_words(multipliers: np.ndarray, errors: np.ndarray | None) -> str:
    sizes = np.abs(multipliers)
    if errors is None or _is_certain(multipliers, errors):
        return "stable" if sizes.max() < 1.0 else "unstable"
    nearest = int(np.argmin(np.abs(sizes - 1.0) - errors))
    return f"stability not decided (|μ| {modulus_words(sizes[nearest])} ± {errors[nearest]:.0e})"


def _liouville(multipliers: np.ndarray, log_determinant: float) -> float | None:
    """Error of Liouville's formula; None where the smallest multiplier is only rounding."""
    sizes = np.abs(multipliers)
    return None if sizes.min() < ROUNDING * sizes.max() else liouville_error(multipliers, log_determinant)


def liouville_error(multipliers: np.ndarray, log_determinant: float) -> float:
    """Difference of ln |det| and ∫ trace, relative to the latter where that is above 1."""
    with np.errstate(divide="ignore"):
        log_product = float(np.sum(np.log(np.abs(multipliers))))
    return abs(log_product - log_determinant) / max(1.0, abs(log_determinant))


def sorted_multipliers(derivative: np.ndarray) -> np.ndarray:
    """Eigenvalues of a monodromy matrix, largest modulus first."""
    multipliers = np.linalg.eigvals(derivative)
    return multipliers[np.argsort(-np.abs(multipliers), kind="stable")]
