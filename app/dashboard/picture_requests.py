"""The requests for pictures of one session, and how long each takes until its picture is on the screen."""

from __future__ import annotations

import itertools
from typing import NamedTuple

from ..serve.monitoring.metrics import METRICS
from ..serve.monitoring.picture_stages import PictureStages


class PictureRequest(NamedTuple):
    """A request for a picture: its number, and the stages of its first picture, which begin with the request."""

    number: int
    stages: PictureStages


class PictureRequests:
    """Keeps the stages of each request's first picture while that picture is submitted, accepted, sent and painted.

    Called with the document locked.
    """

    def __init__(self) -> None:
        self._numbers = itertools.count(1)
        #: The last request; None before the first, and after a failure.
        self.last: PictureRequest | None = None
        #: The stages of the last request until its computation is submitted, and of a picture until it is sent.
        self._pending_stages: PictureStages | None = None
        self._unsent_stages: PictureStages | None = None
        #: The stages of pictures in flight, by their numbers.
        self._in_flight: dict[int, PictureStages] = {}
        #: The number of the last request whose picture has arrived.
        self._answered = 0

    def begin(self) -> None:
        """Note a new request."""
        self._pending_stages = PictureStages()
        self.last = PictureRequest(next(self._numbers), self._pending_stages)

    def submitted(self) -> PictureStages | None:
        """Return the stages of the last request; None if a computation for it was submitted before."""
        stages, self._pending_stages = self._pending_stages, None
        if stages is not None:
            stages.end("pace")  # live mode requests no step while two pictures are in flight
        return stages

    def failed(self) -> None:
        """Note a failure; after it, live steps answer no request."""
        self.last = self._pending_stages = None

    def accepted(self, request: PictureRequest | None, stages: PictureStages | None) -> float | None:
        """Note that a picture waits to be sent; if it is the first of its request, count and return its time [s]."""
        if stages is not None:
            stages.end("loop")
            self._unsent_stages = stages
        if request is None or request.number <= self._answered:
            return None
        self._answered, seconds = request.number, request.stages.elapsed
        METRICS.answered(seconds)
        return seconds

    def sent(self, number: int) -> None:
        """Note that the waiting picture is on its way to the browser, as picture `number`."""
        stages, self._unsent_stages = self._unsent_stages, None
        if stages is not None:
            stages.end("pace")
            self._in_flight[number] = stages

    def painted(self, number: int, browser_ms: object) -> None:
        """Note that picture `number` is on the screen; the browser's script took `browser_ms` [ms] to draw it."""
        if number in self._in_flight:
            self._in_flight[number].painted(browser_ms)
            self._in_flight = {later: stages for later, stages in self._in_flight.items() if later > number}

    def forget_in_flight(self) -> None:
        """Count none of the pictures in flight, because the browser had no reason to paint them."""
        self._in_flight.clear()
