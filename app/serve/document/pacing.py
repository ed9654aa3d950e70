"""Sending pictures at the pace of the browser: at most two are in transit until one is acknowledged."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

Picture = TypeVar("Picture")


#: Pictures in transit at once: one being painted, one travelling. Live mode keeps as many on their way. Measured there
#: with `live_figures` of tests/benchmarks/browser_latency.py, 2026-11-26, two cores with other work, a round trip of
#: 50 ms added on the way: 14 pictures a second with one, 26 with two; without it 54 and 69, and a median lag of 14 and
#: 17 ms.
_MOST_IN_TRANSIT = 2


class PicturePacer(Generic[Picture]):
    """Passes pictures to the browser; of those that wait, only the latest is sent.

    Without acknowledgements, a server that computes faster than the browser paints would fill the websocket, and the
    picture would lag a second behind the knob. `on_idle` is called when the browser has acknowledged a picture and none
    waits.
    """

    def __init__(self, send: Callable[[int, Picture], None], on_idle: Callable[[], None]) -> None:
        self._send = send
        self._on_idle = on_idle
        self._waiting: Picture | None = None
        self._sent = 0
        self._painted = 0

    @property
    def is_full(self) -> bool:
        """Whether as many pictures are in transit as may be."""
        return self._sent - self._painted >= _MOST_IN_TRANSIT

    def offer(self, picture: Picture) -> None:
        """Send `picture` now, or as soon as the browser is ready, unless a newer one is offered before."""
        if self.is_full:
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
        """Forget acknowledgements that will never come: the window was hidden, and a hidden window paints nothing."""
        self._painted = self._sent
        self._go_on()

    def _go_on(self) -> None:
        if self.is_full:
            return
        if self._waiting is not None:
            self.offer(self._waiting)
        else:
            self._on_idle()
