"""What is being computed for one visitor at this moment, and what is not: read from the jobs themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from granchain_core import Settled

if TYPE_CHECKING:
    from .controller import Controller

OFF, IDLE, RUNNING = "off", "there", "computing"


def activities(page: Controller) -> list[tuple[str, str, str]]:
    """Name, state and detail of every view and analysis of the page."""
    session, picture = page.session, page.session.picture
    live = session.mode == "live"
    running = RUNNING if page.busy else IDLE
    pictures = "covered by another page" if page.covered else f"from one {'live' if live else 'settled'} run"
    return [
        ("chain, map, force trains", OFF if page.covered else running, pictures),
        ("live run", (RUNNING if session.playing else IDLE) if live else OFF,
         ("goes on" if session.playing else "paused") if live else "the page shows the steady state"),
        ("steady state", OFF if live else running,
         "live mode looks for none" if live else "not found yet" if picture is None else picture.regime.sentence),
        ("Lyapunov exponent", *_lyapunov(None if live else picture)),
        *page.curves.activities(),
        ("energy account", *_account(page)),
        ("accuracy of all methods", RUNNING if page.accuracy.running else IDLE if page.accuracy.rows else OFF,
         page.accuracy.progress_words),
        page.stability.activity,
        page.hard.activity,
        ("cost of effects", RUNNING if page.effects.measuring else IDLE, page.effects.progress_words),
    ]


def _lyapunov(picture: Settled | None) -> tuple[str, str]:
    """It is computed only where the motion does not become periodic."""
    if picture is None or picture.regime.lyapunov is None:
        return OFF, "only for motions that do not become periodic"
    return IDLE, f"{picture.regime.lyapunov[0]:+.3f} ± {picture.regime.lyapunov[1]:.3f} per period"


def _account(page: Controller) -> tuple[str, str]:
    """It is computed after the picture, where it was switched on."""
    picture = page.session.picture
    if not page.session.account:
        return OFF, "switched off"
    if page.session.mode == "live":
        return OFF, "the live run keeps none"
    if picture is None or picture.run.energy_residual is None:
        return RUNNING if page.busy else IDLE, "follows the picture"
    return IDLE, f"closes to {picture.run.energy_residual:.0e}"
