"""How time runs on the page: settled or live, from where, how fast, playing or paused, one period on."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from .live import LiveRun

if TYPE_CHECKING:
    from .controller import Controller


class Transport:
    """Actions of the bar on top that deal with time."""

    def __init__(self, page: Controller) -> None:
        self._page = page
        self.actions: dict[str, Callable[[dict[str, Any]], None]] = {
            "mode": self._mode, "start": self._start, "speed": self._speed, "playing": self._playing,
            "reset": self._reset, "step": self._step, "again": self._again,
        }

    def _mode(self, message: dict[str, Any]) -> None:
        page = self._page
        page.session.set_mode(message.get("value"))
        page.live = LiveRun(page.session.scene) if page.session.mode == "live" else None
        page.header()
        page.compute()

    def _start(self, message: dict[str, Any]) -> None:
        self._page.session.set_start(message.get("value"))
        self._page.header()
        self._page.compute()

    def _speed(self, message: dict[str, Any]) -> None:
        self._page.session.set_speed(message.get("value"))
        self._page.header()

    def _playing(self, message: dict[str, Any]) -> None:
        page = self._page
        page.session.playing = bool(message.get("value"))
        if page.live is not None:
            page.live.hold()
            if not page.session.playing:
                page.jobs.submit(partial(page.live_step, 1))
        page.idle()

    def _again(self, message: dict[str, Any]) -> None:
        """The page had lost its server and was built again from its knobs."""
        self._speed({"value": message.get("speed")})
        if not message.get("playing"):
            self._playing({"value": False})
            self._page.header()
        self._page.say("The connection was lost and the page was built again from its knobs; "
                       "the chain started anew from rest.")

    def _reset(self, _: dict[str, Any]) -> None:
        page = self._page
        if page.live is not None:
            page.live.reset()
        page.session.picture = None
        page.compute()

    def _step(self, _: dict[str, Any]) -> None:
        page = self._page
        if page.live is not None:
            page.session.playing = False
            page.jobs.submit(partial(page.live_step, page.live.samples))
