"""Flow control of pictures: the browser sets the pace (*backpressure*).

At most `_MOST_IN_FLIGHT` pictures are in flight until the browser acknowledges one. Of the waiting pictures, only the
newest is sent (*conflation*).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

Picture = TypeVar("Picture")


#: Pictures in flight at once: one being painted, and one on its way. Live mode always has this many in flight. Measured
#: in live mode with `live_figures` of tests/benchmarks/browser_latency.py, 2026-11-26, on two cores with other work:
#: with an added round trip of 50 ms, 14 pictures a second with one in flight and 26 with two; without it, 54 and 69
#: pictures a second, with a median lag of 14 and 17 ms.
_MOST_IN_FLIGHT = 2


class PicturePacer(Generic[Picture]):
    """Passes pictures to the browser at its pace.

    Without acknowledgements, a server that computes faster than the browser paints would fill the websocket, and the
    picture would lag a second behind the knob. `on_idle` is called when the browser has acknowledged a picture and no
    other is waiting.
    """

    def __init__(self, send: Callable[[int, Picture], None], on_idle: Callable[[], None]) -> None:
        self._send = send
        self._on_idle = on_idle
        self._waiting: Picture | None = None
        self._sent = 0
        self._painted = 0

    @property
    def is_full(self) -> bool:
        """Whether no further picture may be sent before an acknowledgement."""
        return self._sent - self._painted >= _MOST_IN_FLIGHT

    def offer(self, picture: Picture) -> None:
        """Send `picture` now or as soon as the browser is ready; it replaces a waiting picture."""
        if self.is_full:
            self._waiting = picture
            return
        self._waiting = None
        self._sent += 1
        self._send(self._sent, picture)

    def painted(self, number: object) -> None:
        """Note that picture `number` is on the screen, as reported by the browser."""
        if not isinstance(number, int) or not self._painted < number <= self._sent:
            return
        self._painted = number
        self._go_on()

    def restart(self) -> None:
        """Stop waiting for acknowledgements of pictures in flight: a window that was hidden has painted nothing."""
        self._painted = self._sent
        self._go_on()

    def _go_on(self) -> None:
        if self.is_full:
            return
        if self._waiting is not None:
            self.offer(self._waiting)
        else:
            self._on_idle()
