"""The rate of websocket frames.

Tornado passes on whole messages. It answers pings itself and joins the frames of a fragmented message, so a client
could send any number of pings and fragments that no handler would see. Frames are therefore counted in the bytes that
Tornado reads, by the format of RFC 6455, section 5.2.
"""

from __future__ import annotations

#: Sustained frame rate [1/s], at which a connection's token bucket is refilled. A drag sends 60 messages a second, each
#: in three frames.
FRAME_RATE = 600.0
#: Burst: the number of tokens in a full bucket.
FRAME_BURST = 3000.0
#: Bytes of a frame that cost one more token: a sustained rate of 6 MB/s, a burst of eleven large uploads.
FRAME_UNIT = 10_000


class FrameBucket:
    """The token bucket of a connection; each frame consumes tokens."""

    def __init__(self, now: float) -> None:
        self._tokens = FRAME_BURST
        self._refilled_at = now
        #: The bytes of a frame's header that have arrived so far.
        self._head = b""
        #: Bytes of the payload that are still to come.
        self._left = 0

    def consume(self, data: bytes, now: float) -> bool:
        """Consume tokens for the frames that begin in the next bytes; return False if the bucket is empty.

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
    """Return the length of a frame's header, known from its first two bytes."""
    return 2 + {126: 2, 127: 8}.get(head[1] & 0x7F, 0) + (4 if head[1] & 0x80 else 0)


def _length_of_payload(head: bytes) -> int:
    length = head[1] & 0x7F
    return int.from_bytes(head[2:4] if length == 126 else head[2:10]) if length >= 126 else length
