"""The list of computations of one session."""

from __future__ import annotations

from granchain_core import Settled
from granchain_core.results.regime import exponent_words

from .progress import OFF, READY, ActivityState, activity_state
from .session import Session

#: Name, state and detail of a view or an analysis.
Activity = tuple[str, ActivityState, str]


def picture_activities(session: Session, busy: bool) -> list[Activity]:
    """Return the activities of the chain and its pictures, the live run, the steady state and its Lyapunov exponent."""
    settled, live = session.settled, session.mode == "live"
    running = activity_state(busy)
    return [
        ("chain, map, forces", running, f"from one {'live' if live else 'settled'} run"),
        ("live run", activity_state(session.playing) if live else OFF,
         ("running" if session.playing else "paused") if live else "the page shows the steady state"),
        ("steady state", OFF if live else running,
         "not computed in live mode" if live else "not found yet" if settled is None else settled.regime.sentence),
        ("Lyapunov exponent", *_lyapunov(None if live else settled)),
    ]


def account_activity(session: Session, busy: bool) -> Activity:
    """Return the activity of the energy account, which is computed after the picture if it is switched on."""
    return ("energy account", *_account(session, busy))


def _lyapunov(settled: Settled | None) -> tuple[ActivityState, str]:
    """Return state and detail of the exponent, which is computed for motions that do not become periodic."""
    if settled is None or settled.regime.lyapunov is None:
        return OFF, "only for motions that do not become periodic"
    return READY, f"{exponent_words(*settled.regime.lyapunov)} per period"


def _account(session: Session, busy: bool) -> tuple[ActivityState, str]:
    settled = session.settled
    if not session.energy_account:
        return OFF, "switched off"
    if session.mode == "live":
        return OFF, "not computed in a live run"
    if settled is None or settled.run.energy_residual is None:
        return activity_state(busy), "computed after the picture"
    return READY, f"closes to {settled.run.energy_residual:.0e}"
