"""Finding a periodic orbit: Newton's method on the stroboscopic map, from the settled motion or from a given state."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..errors import ComputationError
from ..execution.stop import Stop
from ..inputs.checks import whole_number
from ..integrate.scaling import scales_of
from ..integrate.start import at_phase_0
from ..results.regime import Regime
from ..scene import Scene
from ..scene.refusals import require_scene
from ..scene.state import State
from ..steady.regime_criteria import LONGEST_LOCKED_PERIOD
from ..steady.residuals import formatted
from ..steady.settling.advance import run_until_settled
from ..steady.settling.nearby_orbit import MOST_BEADS_WITH_MULTIPLIERS
from .damped_newton import Iterated, iterate
from .orbit import Orbit, liouville_if_known, sorted_multipliers
from .stroboscopic_map import Flow, StroboscopicMap, refuse_cut

#: Why period 1 was assumed for an orbit that is sought from a given start.
NO_PERIOD_GIVEN = "period 1 was assumed, because a start was given without a period"
#: Why period 1 was assumed for an orbit that is sought near a motion.
NO_PERIOD_OF_SEARCH = "period 1 was assumed, because none was given"


def periodic_orbit(scene: Scene, period: int | None = None, start: State | None = None, observer: bool = False,
                   stop: Stop | None = None) -> Orbit:
    """Find a periodic orbit, stable or not, by Newton's method.

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
        Newton's method did not converge; the message gives its residuals.
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
    n, start, note = _begin(scene, n, start, stop)
    stroboscopic_map = StroboscopicMap(scene, n, stop)
    newton = _iterate(stroboscopic_map, stroboscopic_map.inner(stroboscopic_map.engine.scaled.from_si(start)))
    return replace(_orbit(scene, n, stroboscopic_map, newton, observer), period_note=note)


def _begin(scene: Scene, n: int | None, start: State | None, stop: Stop | None) -> tuple[int, State, str]:
    """Return the period, the state at phase 0 and the note for Newton's method; without `start`, settle from rest."""
    if start is not None:
        return n or 1, at_phase_0(scene, start, stop), "" if n else NO_PERIOD_GIVEN
    settling = run_until_settled(scene, None, stop)
    note = ""
    if n is None and settling.regime.period is None:
        note = f"period 1 was assumed, because the motion from rest is {_no_period(settling.regime)}"
    return n or settling.regime.period or 1, settling.engine.state, note


def _no_period(regime: Regime) -> str:
    """The regime of a motion without a period, in words."""
    return f"not settled after {regime.periods_run} periods" if regime.name == "unsettled" else regime.name


def random_state(scene: Scene, seed: int) -> State:
    """Draw a random start: normally distributed displacements and velocities in units of A0 and A0·φ."""
    scales = scales_of(scene)
    draw = np.random.default_rng(seed).standard_normal((2, scene.N))
    return State(scales.displacements(draw[0]), scales.velocities(draw[1]))


def _iterate(stroboscopic_map: StroboscopicMap, x: np.ndarray) -> Iterated:
    """Run Newton's method from the state x; raise `ComputationError` with the residuals if it does not converge."""

    def evaluate(state: np.ndarray) -> tuple[Flow, float]:
        flow = _flow(stroboscopic_map, state)
        return flow, stroboscopic_map.residual(flow.end, state)

    newton = iterate(evaluate, lambda state, flow: _newton_step(stroboscopic_map, state, flow), x)
    if not newton.converged:
        raise ComputationError(f"Newton's method found no orbit of {stroboscopic_map.periods} drive periods near this "
                               f"start: its residuals were {formatted(newton.residuals)}; give another period or "
                               "start.", "no-convergence")
    return newton


def _dense(x: np.ndarray) -> bool:
    return len(x) <= 2 * MOST_BEADS_WITH_MULTIPLIERS


def _flow(stroboscopic_map: StroboscopicMap, x: np.ndarray) -> Flow:
    """The flow from x, with the full derivative unless the chain is long."""
    return stroboscopic_map(x) if _dense(x) else stroboscopic_map(x, directions=np.zeros((len(x), 0)))


def _newton_step(stroboscopic_map: StroboscopicMap, x: np.ndarray, flow: Flow) -> np.ndarray:
    if not _dense(x):
        from .krylov import newton_step  # only long chains need scipy.sparse.linalg, which takes 0.2 s to load

        return newton_step(stroboscopic_map, x, flow.end)
    try:
        return np.linalg.solve(flow.derivative - np.eye(len(x)), x - flow.end)
    except np.linalg.LinAlgError:
        raise ComputationError("Newton's step does not exist: a multiplier is 1, as at a fold; move the knob a little.",
                               "no-convergence") from None


def _orbit(scene: Scene, n: int, stroboscopic_map: StroboscopicMap, newton: Iterated, observer: bool) -> Orbit:
    """The orbit at the fixed point that Newton's method found, with its multipliers."""
    x, flow = newton.z, newton.flow
    liouville_error = monodromy = observer_monodromy = None
    if _dense(x):
        monodromy, multipliers = flow.derivative, sorted_multipliers(flow.derivative)
        liouville_error = liouville_if_known(multipliers, flow.log_determinant)
        observer_monodromy = stroboscopic_map(x, observer=True).derivative if observer else None
        observer_multipliers = None if observer_monodromy is None else sorted_multipliers(observer_monodromy)
    else:
        from .krylov import leading_multipliers

        multipliers = leading_multipliers(stroboscopic_map, x)
        observer_multipliers = leading_multipliers(stroboscopic_map, x, observer=True) if observer else None
    scaled = stroboscopic_map.engine.scaled
    return Orbit(scene, n, state=scaled.to_si(scaled.embed(x)), residual=newton.residuals[-1],
                 newton_residuals=tuple(newton.residuals), multipliers=multipliers, liouville_error=liouville_error,
                 contact_events=flow.contact_events, observer_multipliers=observer_multipliers, monodromy=monodromy,
                 observer_monodromy=observer_monodromy)
