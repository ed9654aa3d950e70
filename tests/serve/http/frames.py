"""Frames of a websocket as a browser sends them, over a raw socket, which also sends what no browser would."""

from __future__ import annotations

import contextlib
import json
import socket

from listening import Listening

#: Kinds of frames (RFC 6455, section 5.2).
TEXT, CONTINUED, PING, PONG = 1, 0, 9, 10


def masked(opcode: int, payload: bytes = b"", final: bool = True) -> bytes:
    """Return a frame as a browser sends it (RFC 6455, section 5.2), with a mask of zeros."""
    length = bytes([0x80 | len(payload)]) if len(payload) < 126 else bytes([0x80 | 127]) + len(payload).to_bytes(8)
    return bytes([opcode | 0x80 * final]) + length + bytes(4) + payload


def message(content: str = "{}", kind: str = "PULL-DOC-REQ") -> bytes:
    """Return a message as BokehJS sends it, in three frames."""
    return b"".join(masked(TEXT, part.encode()) for part in (json.dumps({"msgid": "1", "msgtype": kind}), "{}", content))


def received(sent: socket.socket, patience: float, until: bytes | None = None) -> bytes:
    """Return the bytes received until the other side closes, the time is up, or `until` has arrived."""
    sent.settimeout(patience)
    came = b""
    with contextlib.suppress(TimeoutError, ConnectionError):
        while more := sent.recv(1_000_000):
            came += more
            if until is not None and until in came:
                break
    return came


def connected(one: Listening) -> socket.socket:
    """Return a new page's websocket that Bokeh has acknowledged; before that, it accepts no messages."""
    status, there = one.open(one.token())
    assert status == 101 and b'"ACK"' in received(there, 30, b'"ACK"')
    return there


def closed_with(sent: socket.socket, patience: float, reason: bytes = b"too many frames") -> int:
    """Return the code of the closing frame with this reason; 0 if none arrives within this many seconds."""
    return code_of(received(sent, patience), reason)


def code_of(came: bytes, reason: bytes) -> int:
    """Return the code of a closing frame with this reason; 0 if there is none."""
    at = came.rfind(reason)
    return int.from_bytes(came[at - 2:at]) if at > 1 else 0
