"""Sending pictures at the pace of the browser: at most two are in transit until one is acknowledged."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

Picture = TypeVar("Picture")


#: Pictures on their way at once: one being painted, one travelling. Measured on two cores: 21 frames a second and 45
#: ms of lag (p95) with one, 28 and 43 with two.
_MOST_IN_TRANSIT = 2


class FramePacer(Generic[Picture]):
    """Passes pictures to the browser; of those that wait, only the latest is sent.

    Without acknowledgements, a server that computes faster than the browser paints would fill the websocket, and the
    picture would lag a second behind the knob.
    """

    def __init__(self, send: Callable[[int, Picture], None], idle: Callable[[], None]) -> None:
        self._send = send
        self._idle = idle
        self._waiting: Picture | None = None
        self._sent = 0
        self._painted = 0

    @property
    def waits(self) -> bool:
        """Whether the browser still owes an acknowledgement."""
        return self._sent - self._painted >= _MOST_IN_TRANSIT

    def offer(self, picture: Picture) -> None:
        """Send `picture` now, or as soon as the browser is ready, unless a newer one is offered before."""
        if self.waits:
            self._waiting = picture
            return
        self._waiting = None
        self._sent += 1
        self._send(self._sent, picture)

    def painted(self, number: object) -> None:
        """The browser says that picture `number` is on the screen."""
        if not isinstance(number, int) or not self._painted < number <= self._sent:
            return
        self._painted = number
        self._go_on()

    def restart(self) -> None:
        """Forget acknowledgements that will never come (the page was reconnected)."""
        self._painted = self._sent
        self._go_on()

    def _go_on(self) -> None:
        if self.waits:
            return
        if self._waiting is not None:
            self.offer(self._waiting)
        else:
            self._idle()
