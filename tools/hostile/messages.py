"""Hostile messages: a page is opened over a raw websocket and sends messages that no browser sends.

They are messages of our own parts with values that no part sends, changes of properties of all kinds of models, events
and message types that do not exist, and frames that are not messages. At the same time, a second visitor keeps moving a
knob, and each of its moves must be answered. A connection that the server closes is opened again.
"""

from __future__ import annotations

import asyncio
import json
import random
import re
from collections import Counter

from app.dashboard.controller import Controller
from tools.visitors.soak import figures
from tools.visitors.started import Started
from tools.visitors.visitor import Visitor

from .values import text, value

_ID = re.compile(r'"id":"([^"]{1,60})"')
_KINDS = ("PATCH-DOC", "PULL-DOC-REQ", "PUSH-DOC", "SERVER-INFO-REQ", "ACK", "OK", "ERROR", "NOTHING", "")
_ATTRIBUTES = ("value", "data", "text", "state", "visible", "children", "start", "end", "title", "nothing", "tags", "name", "active")
_EVENTS = ("ModelChanged", "MessageSent", "ColumnDataChanged", "ColumnsStreamed", "ColumnsPatched", "TitleChanged", "RootAdded",
           "RootRemoved", "Nothing")


class Attacker(Visitor):
    """A visitor who means harm: `attack` sends one hostile message."""

    def __init__(self, address: str, rng: random.Random, actions: tuple[str, ...]) -> None:
        super().__init__(address)
        self._rng, self._actions, self._ids = rng, actions, [""]

    @property
    def connected(self) -> bool:
        """Whether the connection is still open."""
        return self._reader is not None and not self._reader.done()

    async def _take(self, kind: str, content: str) -> None:
        if kind == "PULL-DOC-REPLY":
            self._ids = _ID.findall(content)
        await super()._take(kind, content)

    async def attack(self) -> str:
        """Send a hostile message and return its kind."""
        name, send = self._rng.choice((("message of a part", self._part), ("message of a part", self._part),
                                       ("property", self._property), ("large property", self._large_property),
                                       ("document event", self._document_event),
                                       ("kind of message", self._kind), ("frame", self._frame)))
        await send()
        return name

    async def _part(self) -> None:
        names = ("name", "value", "number", "seq", "text", "query", "place", "theme", "bead", "row", "x", "y", "from", "to", "id")
        told = {self._rng.choice(names): value(self._rng) for _ in range(self._rng.randrange(4))}
        action = self._rng.choice(self._actions) if self._rng.random() < 0.9 else value(self._rng)
        await self._event("data_event", [["model", {"id": self._model if self._rng.random() < 0.7 else self._rng.choice(self._ids)}],
                                         ["data", {"type": "map", "entries": [["do", action], *([a, b] for a, b in told.items())]}]])

    async def _property(self) -> None:
        await self._send("PATCH-DOC", {"events": [{
            "kind": "ModelChanged", "model": {"id": self._rng.choice((*self._ids, "p0", ""))},
            "attr": self._rng.choice(_ATTRIBUTES), "new": value(self._rng)}]})

    async def _large_property(self) -> None:
        await self._send("PATCH-DOC", {"events": [{
            "kind": "ModelChanged", "model": {"id": self._rng.choice(self._ids)}, "attr": "tags", "new": ["x" * 1_600_000]}]})

    async def _document_event(self) -> None:
        event = {"kind": self._rng.choice(_EVENTS), "model": value(self._rng), "attr": text(self._rng)[:50], "new": value(self._rng),
                 "msg_type": self._rng.choice(("bokeh_event", "nothing")), "msg_data": value(self._rng),
                 "column_source": {"id": self._rng.choice(self._ids)}, "data": value(self._rng), "patches": value(self._rng),
                 "rollover": value(self._rng), "cols": value(self._rng), "title": value(self._rng)}
        for name in self._rng.sample(sorted(event), self._rng.randrange(4)):
            del event[name]
        await self._send("PATCH-DOC", {"events": [event] if self._rng.random() < 0.9 else value(self._rng)})

    async def _kind(self) -> None:
        await self._send(self._rng.choice(_KINDS), {"events": [value(self._rng)], "doc": value(self._rng)})

    async def _frame(self) -> None:
        assert self._socket is not None
        frame: str | bytes = self._rng.choice((
            json.dumps(value(self._rng)), text(self._rng).encode(errors="replace").decode(), self._rng.randbytes(30), "{", "[" * 5000,
            json.dumps({"msgid": "1", "msgtype": "PATCH-DOC", "num_buffers": self._rng.choice((1, -1, 10**9, "x"))})))
        await self._socket.write_message(frame, binary=isinstance(frame, bytes))


async def run(server: Started, count: int, seed: int) -> int:
    """Send `count` hostile messages while a visitor keeps moving; return how many of the moves had no answer."""
    rng, sent = random.Random(seed), Counter[str]()
    actions = actions_of_the_page()
    neighbour = Visitor(server.address)
    await neighbour.open()
    before = figures(server.number)[0] if server.process else float("nan")
    moves = asyncio.create_task(_move(neighbour, random.Random(seed)))
    attacker, connections, unanswered = Attacker(server.address, rng, actions), 0, 0
    while sum(sent.values()) < count:
        if not attacker.connected:
            attacker = Attacker(server.address, rng, actions)
            connections += 1
            try:
                await attacker.open()
            except TimeoutError:
                print(f"no picture for connection {connections} in two minutes", flush=True)
                unanswered += 1
        try:
            sent[await attacker.attack()] += 1
        except Exception as closed:  # by the server, between the check and the message
            sent[f"closed: {type(closed).__name__}"] += 1
        await asyncio.sleep(0.01)  # below the limit of messages per second, which tests/serve/http/test_security.py tests
    await attacker.leave()
    last = Visitor(server.address)
    await last.open()
    answered = await last.move("f", 341.7)
    await last.leave()
    moves.cancel()
    times = _TIMES[:]
    print(f"{count} messages, seed {seed}: {dict(sent)}; {connections} connections")
    if server.process:
        print(f"memory of the server: {before:.0f} MB with the first visitor, {figures(server.number)[0]:.0f} MB at the end")
    late = sum(one is None for one in times) + (answered is None) + unanswered
    print(f"moves of the other visitor and first pictures: {len(times) + connections}, without an answer {late}, "
          f"slowest {1e3 * max((one for one in times if one is not None), default=0.0):.0f} ms")
    return late


_TIMES: list[float | None] = []


async def _move(visitor: Visitor, rng: random.Random) -> None:
    while True:
        _TIMES.append(await visitor.move("f", round(rng.uniform(300.0, 900.0), 1)))
        await asyncio.sleep(1.0)


def actions_of_the_page() -> tuple[str, ...]:
    """Return the names of all messages that the page's parts send."""
    from bokeh.document import Document

    from app.session.session import Session
    from granchain_core import scene

    controller = Controller(Document(), Session(scene=scene("sec2")))
    names = tuple(sorted(name for actions in controller.owners.values() for name in actions))
    controller.close()
    return names
