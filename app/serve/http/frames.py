"""The rate of websocket frames.

Tornado hands over whole messages. It answers pings itself, and joins the frames of a message that comes in pieces, so
that a client could send any number of either unseen. Frames are therefore counted in the bytes that Tornado reads, by
the format of RFC 6455, section 5.2.
"""

from __future__ import annotations

#: Frames that a visitor may send, over a long time [1/s]: the rate at which the token bucket of a connection is filled.
#: A drag sends 60 messages a second, each in three frames.
FRAME_RATE = 600.0
#: Frames that a visitor may send at once: what the bucket holds.
FRAME_BURST = 3000.0
#: A frame counts once more for every so many of its bytes: 6 MB/s over a long time, eleven large uploads at once.
FRAME_UNIT = 10_000


class FrameBucket:
    """The token bucket of a connection, from which each frame is paid."""

    def __init__(self, now: float) -> None:
        self._tokens = FRAME_BURST
        self._refilled_at = now
        #: What has come of the head of a frame.
        self._head = b""
        #: Bytes of the payload that are still to come.
        self._left = 0

    def pay(self, data: bytes, now: float) -> bool:
        """Pay for the frames that begin in the next bytes; False if there are too many.

        `now` is the present time [s].
        """
        self._tokens = min(FRAME_BURST, self._tokens + (now - self._refilled_at) * FRAME_RATE)
        self._refilled_at = now
        at = 0
        while at < len(data):
            if self._left:
                passed = min(self._left, len(data) - at)
                self._left -= passed
                at += passed
                continue
            self._head += data[at:at + 1]
            at += 1
            if len(self._head) >= 2 and len(self._head) == _length_of_head(self._head):
                self._left = _length_of_payload(self._head)
                self._tokens -= 1.0 + self._left / FRAME_UNIT
                self._head = b""
        return self._tokens >= 0.0


def _length_of_head(head: bytes) -> int:
    """The number of bytes before the payload, from the first two of them."""
    return 2 + {126: 2, 127: 8}.get(head[1] & 0x7F, 0) + (4 if head[1] & 0x80 else 0)


def _length_of_payload(head: bytes) -> int:
    length = head[1] & 0x7F
    return int.from_bytes(head[2:4] if length == 126 else head[2:10]) if length >= 126 else length
