"""A visitor without a browser, who opens the page and speaks Bokeh's protocol over a raw websocket."""

from __future__ import annotations

import asyncio
import json
import random
import re
import time
from contextlib import suppress
from typing import Any
from urllib.parse import urlencode, urlsplit

from tornado.httpclient import AsyncHTTPClient, HTTPRequest
from tornado.websocket import WebSocketClientConnection, WebSocketClosedError, websocket_connect

from ..connection_times import connection_times

_TOKEN = re.compile(r'"token":"([^"]+)"')
_ESM_MODEL = re.compile(r'"name":"[^"]*ReactiveESM[^"]*","id":"([^"]+)"')
_NUMBER = re.compile(r'"number",(\d+)')
#: Time between two pings of a visible page [s], as a browser has it.
_PING_EVERY = connection_times()["PING_EVERY"][0] / 1000
#: Largest message that a page may get [bytes]: the chain of 10,000 beads.
_LARGEST = 200_000_000


class Visitor:
    """A visitor: `open`, then `move`, then `leave`.

    `arrived` is the time at which the last picture arrived, by `time.perf_counter`, and `pictures` counts the pictures.
    The scripts of the page take `scripts_time` to load, at least and at most [s].
    """

    def __init__(self, address: str, query: str = "", scripts_time: tuple[float, float] = (0.0, 0.0)) -> None:
        self.address, self.query = address.rstrip("/"), query
        self._scripts_time = scripts_time
        self.arrived, self.pictures, self.opened_in = 0.0, 0, 0.0
        self.sentences: list[str] = []
        self.shown: set[str] = set()
        self._picture = asyncio.Event()
        self._model = ""
        self._socket: WebSocketClientConnection | None = None
        self._reader: asyncio.Task[None] | None = None
        self._pings: asyncio.Task[None] | None = None
        self._last = 0

    async def open(self, patience: float = 120.0) -> None:
        """Load the page and wait for its first picture."""
        began = time.perf_counter()
        self._picture.clear()
        client = AsyncHTTPClient(max_clients=1000)
        page = await client.fetch(HTTPRequest(f"{self.address}/{self.query}", request_timeout=patience,
                                              connect_timeout=patience))
        found = _TOKEN.search(page.body.decode())
        if found is None:
            raise RuntimeError("the page has no token")
        token = found.group(1)
        await asyncio.sleep(random.uniform(*self._scripts_time))
        place = urlsplit(self.address)
        request = HTTPRequest(f"ws://{place.netloc}/ws", request_timeout=patience, connect_timeout=patience,
                              headers={"Origin": self.address})
        self._socket = await websocket_connect(request, subprotocols=["bokeh", token], max_message_size=_LARGEST)
        self._socket.protocol.set_nodelay(True)  # as browsers do; otherwise a move after a ping waits 40 ms in this client
        self._reader = asyncio.create_task(self._read())
        await asyncio.wait_for(self._picture.wait(), patience)
        self.opened_in = time.perf_counter() - began

    async def move(self, name: str, value: float, patience: float = 60.0) -> float | None:
        """Move a knob; return the time until its picture arrives [s], or None if none does."""
        self._picture.clear()
        self.shown.clear()
        began = time.perf_counter()
        await self.say(do="set", name=name, value=value, seq=1)
        while True:
            left = began + patience - time.perf_counter()
            try:
                await asyncio.wait_for(self._picture.wait(), max(left, 0.001))
            except TimeoutError:
                return None
            if name != "f" or f"{value}" in self.shown:
                return self.arrived - began
            self._picture.clear()

    async def lost(self) -> None:
        """Wait until the server closes the connection."""
        assert self._reader is not None
        await asyncio.wait([self._reader])
        if self._pings is not None:
            self._pings.cancel()

    async def leave(self) -> None:
        """Close the page."""
        if self._pings is not None:
            self._pings.cancel()
        if self._socket is not None:
            self._socket.close()
        if self._reader is not None:
            await asyncio.wait([self._reader], timeout=5)
            self._reader.cancel()

    async def say(self, **message: Any) -> None:
        """Send a message like a part of the page."""
        await self._event("data_event", [["model", {"id": self._model}], ["data", _as_map(message)]])

    async def _ping(self) -> None:
        """Ask the server repeatedly for an answer, as a visible page does."""
        while True:
            await asyncio.sleep(_PING_EVERY)
            await self.say(do="ping")

    async def _event(self, name: str, entries: list[Any]) -> None:
        event = {"type": "event", "name": name, "values": {"type": "map", "entries": entries}}
        await self._send("PATCH-DOC", {"events": [
            {"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": event}]})

    async def _send(self, kind: str, content: dict[str, Any]) -> None:
        assert self._socket is not None
        self._last += 1
        with suppress(WebSocketClosedError):  # the parts of two messages must not mix, so nothing is awaited between them
            await asyncio.gather(*[self._socket.write_message(json.dumps(part))  # each may find the socket closed
                                   for part in ({"msgid": str(self._last), "msgtype": kind}, {}, content)],
                                 return_exceptions=True)

    async def _read(self) -> None:
        """Read messages: header, metadata, content, and a header and a payload for each buffer."""
        assert self._socket is not None
        while (header_text := await self._socket.read_message()) is not None:
            header = json.loads(header_text)
            parts = [await self._socket.read_message() for _ in range(2 + 2 * header.get("num_buffers", 0))]
            if any(part is None for part in parts):
                return
            await self._take(header["msgtype"], str(parts[1]))

    async def _take(self, kind: str, content: str) -> None:
        if kind == "ACK":
            await self._send("PULL-DOC-REQ", {})
        elif kind == "PULL-DOC-REPLY":
            found = _ESM_MODEL.search(content)
            if found is None:
                raise RuntimeError("the page has no part of ours")
            self._model = found.group(1)
            await self._event("document_ready", [])
            await self.say(do="ready", compact=False, theme="light")
            self._pings = asyncio.create_task(self._ping())
        elif kind == "PATCH-DOC":
            await self._changed(content)

    async def _changed(self, content: str) -> None:
        if '"sentence"' in content:
            self.sentences.append(content)
        self.shown.update(re.findall(r"\d+\.\d+", content) if len(content) < 3000 else ())
        if '"frames"' in content and (number := _NUMBER.search(content)):
            self.arrived = time.perf_counter()
            self.pictures += 1
            self._picture.set()
            await self.say(do="painted", number=int(number.group(1)))


def _as_map(message: dict[str, Any]) -> dict[str, Any]:
    return {"type": "map", "entries": [[key, value] for key, value in message.items()]}


def query_of(**fields: object) -> str:
    """Return the part of a shared scene's address after the slash."""
    return "?" + urlencode(fields)
