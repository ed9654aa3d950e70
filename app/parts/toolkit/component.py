"""The base class of components that the dashboard's own JavaScript draws."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import param
from panel.custom import JSComponent

from ...plots.theme import Theme
from ...scripts import FILES, files_by_name
from .panel_overrides import (
    WithCommonProperties,
    WithoutBusyIndicator,
    WithoutChildren,
    WithoutDesign,
    WithPlainChanges,
)

_FILES = {**FILES, **files_by_name("*.css")}


def text(name: str) -> str:
    """Return the content of a style sheet, or of a script that is written into the page, by name."""
    return _FILES[name].read_text(encoding="utf-8")


class Component(WithPlainChanges, WithCommonProperties, WithoutChildren, WithoutDesign, WithoutBusyIndicator,
                JSComponent):
    """A part of the page. `state` is sent to the browser and kept; messages go both ways and are not kept.

    The visitor's actions arrive as messages, because Panel delays property changes by 50 ms, but not messages.
    """

    state = param.Dict(default={})

    __abstract = True

    def __init__(self, receive: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(margin=0, **params)
        self._receive = receive

    def send(self, **message: Any) -> None:
        """Send a message to this part in the browser."""
        if not self.try_send(message):
            self._send_msg(message)

    def apply_theme(self, theme: Theme) -> None:
        """Draw the figures in another theme; a part without figures needs only its style sheet."""

    def update_state(self, **changes: Any) -> None:
        """Change some entries of `state`."""
        before = self.state
        if any(name not in before or before[name] != value for name, value in changes.items()):
            merged = {**before, **changes}
            if not self.try_change("state", merged):
                self.state = merged

    def receive(self, data: Any) -> None:
        """Receive a message from this part in the browser."""
        if self._receive is not None and isinstance(data, dict):
            self._receive(data)

    def _handle_msg(self, data: Any) -> None:
        self.receive(data)
