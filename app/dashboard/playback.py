"""Playback: settled or live mode, start, speed, play or pause, one period forward."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..parts.header.header import Header
from ..session.initial_state import MOST_BEADS_IN_LINK
from ..session.message_checks import check_bool
from ..session.page import Actions
from ..session.session import Session
from .main_picture import MainPicture


class Playback:
    """Actions of the header that concern time; `compute` requests a picture."""

    def __init__(self, session: Session, header: Header, pictures: MainPicture, compute: Callable[[], None],
                 show_sentence: Callable[[str], None]) -> None:
        self._session = session
        self._header = header
        self._pictures = pictures
        self._compute = compute
        self._show_sentence = show_sentence
        self.actions: Actions = {
            "mode": self._mode, "start": self._start, "speed": self._speed, "playing": self._playing,
            "reset": self._reset, "next-period": self._next_period, "reconnected": self._reconnected,
        }

    def _mode(self, message: dict[str, Any]) -> None:
        self._session.set_mode(message.get("value"))
        if self._session.mode == "live":
            self._pictures.begin_live()
        else:
            self._pictures.end_live()
        self._header.show_session(self._session)
        self._compute()

    def _start(self, message: dict[str, Any]) -> None:
        self._session.set_start(message.get("value"))
        self._header.show_session(self._session)
        self._compute()

    def _speed(self, message: dict[str, Any]) -> None:
        self._session.set_speed(message.get("value"))
        self._header.show_session(self._session)

    def _playing(self, message: dict[str, Any]) -> None:
        self._session.playing = check_bool("playing", message.get("value"))
        if self._pictures.live is not None:
            self._pictures.live.hold()
            if not self._session.playing:
                self._pictures.advance(1)
        self._pictures.next_live_step()

    def _reconnected(self, message: dict[str, Any]) -> None:
        """Restore the pause, which no link contains, after a lost connection, and say what could not be restored."""
        uploaded = check_bool("uploaded", message.get("uploaded", False))
        if not check_bool("playing", message.get("playing")):
            self._playing({"value": False})
            self._header.show_session(self._session)
        scene, different = self._session.scene, []
        if self._session.mode == "live":
            different.append("the live run has started again")
        elif scene.is_driven and scene.N > MOST_BEADS_IN_LINK:  # the link has no room for its initial state
            different.append("the motion starts from rest")
        if uploaded:
            different.append("your uploaded data are gone")
        but = f", but {' and '.join(different)}" if different else ""
        self._show_sentence(f"The connection was lost. Your settings are restored{but}.")

    def _reset(self, _: dict[str, Any]) -> None:
        if self._pictures.live is not None:
            self._pictures.live.reset()
        self._session.settled = None
        self._compute()

    def _next_period(self, _: dict[str, Any]) -> None:
        if self._pictures.live is not None:
            self._session.playing = False
            self._pictures.advance(self._pictures.live.samples)
