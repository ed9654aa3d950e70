"""Frames are counted in a websocket's bytes, however these are split, and limited by a token bucket."""

from __future__ import annotations

import pytest

from app.serve.http.frame_rate import FRAME_BURST, FRAME_RATE, FRAME_UNIT, FrameBucket

pytestmark = pytest.mark.quick


def frame(payload: int, masked: bool = True) -> bytes:
    """Return a text frame with a payload of this many bytes (RFC 6455, section 5.2)."""
    if payload < 126:
        length, more = payload, b""
    elif payload < 2**16:
        length, more = 126, payload.to_bytes(2)
    else:
        length, more = 127, payload.to_bytes(8)
    return bytes([0x81, length | 0x80 * masked]) + more + bytes(4 * masked) + b"\x81" * payload


@pytest.mark.parametrize("cut", [1, 2, 7, 10_000])
@pytest.mark.parametrize("masked", [True, False])
def test_frames_are_counted_however_their_bytes_are_cut(cut: int, masked: bool) -> None:
    sizes = [0, 2, 125, 126, 127, 2**16 - 1, 2**16, 100_000]
    data = b"".join(frame(size, masked) for size in sizes)
    bucket = FrameBucket(0.0)
    for at in range(0, len(data), cut):
        assert bucket.consume(data[at:at + cut], 0.0)
    assert FRAME_BURST - bucket._tokens == pytest.approx(len(sizes) + sum(sizes) / FRAME_UNIT)


def test_a_bucket_is_filled_again_and_holds_no_more_than_a_burst() -> None:
    bucket, empty = FrameBucket(0.0), frame(0)
    assert bucket.consume(empty * int(FRAME_BURST), 0.0)
    assert not bucket.consume(empty, 0.0)
    assert bucket.consume(empty * int(FRAME_RATE - 1.0), 1.0)
    assert not bucket.consume(empty, 1.0)
    assert bucket.consume(empty * int(FRAME_BURST), 1000.0)
    assert not bucket.consume(empty, 1000.0)


def test_a_thousand_frames_a_second_empty_the_bucket() -> None:
    bucket, passed = FrameBucket(0.0), 0
    while bucket.consume(frame(0), 1e-3 * passed):
        passed += 1
    assert passed == pytest.approx(FRAME_BURST / (1.0 - 1e-3 * FRAME_RATE), rel=1e-3)


def test_eleven_of_the_largest_uploads_may_come_at_once() -> None:
    bucket = FrameBucket(0.0)
    assert all(bucket.consume(frame(2_667_000), 0.0) for _ in range(11))
    assert not bucket.consume(frame(2_667_000), 0.0)
