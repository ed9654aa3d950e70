"""A Bokeh server whose page answers questions as the dashboard does."""

from __future__ import annotations

import asyncio
import threading
from typing import Any

from bokeh.application import Application
from bokeh.application.handlers import FunctionHandler
from bokeh.client import ClientSession
from bokeh.document import Document
from bokeh.models import Div
from bokeh.server.server import Server
from tornado.ioloop import IOLoop

from app.serve.connection import socket_tuning
from app.serve.connection.socket_tuning import disable_nagle
from app.serve.document.changes import batched_changes
from app.serve.document.document_lock import may_change, run_when_locked


class Served:
    """A Bokeh server whose document answers questions, each in one batch and with the document locked."""

    def __init__(self) -> None:
        self.document: Document | None = None
        self.found: dict[str, Any] = {}
        started = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(started,), daemon=True)
        self._thread.start()
        assert started.wait(60)

    def _run(self, started: threading.Event) -> None:
        asyncio.set_event_loop(asyncio.new_event_loop())
        self.loop = IOLoop.current()
        server = Server({"/": Application(FunctionHandler(self._build))}, port=0, io_loop=self.loop)
        server.start()
        self.address = f"http://localhost:{server.port}/"
        self.loop.add_callback(started.set)
        self.loop.start()
        server.stop()

    def _build(self, document: Document) -> None:
        self.document = document
        question, self.answer = Div(name="question"), Div(name="answer")
        question.on_change("text", lambda _attribute, _old, new: run_when_locked(document, lambda: self.reply(new)))
        document.add_root(question)
        document.add_root(self.answer)

    def reply(self, text: str) -> None:
        """Send the answer in the way a picture is sent."""
        assert self.document is not None
        self.found = {"locked": may_change(self.document), "streams": socket_tuning._streams(self.document)}
        disable_nagle(self.document)
        with batched_changes(self.document):
            self.answer.text = f"{text}, yes"

    def stop(self) -> None:
        """End the server."""
        self.loop.add_callback(self.loop.stop)
        self._thread.join(20)


def ask(session: ClientSession, text: str) -> None:
    """Send a question in the way the browser does."""
    session.document.select_one({"name": "question"}).text = text


def wait_for(session: ClientSession, text: str) -> None:
    """Wait until the answer has arrived as a change of the document, as in the browser."""
    loop = session._connection.io_loop
    patience = loop.call_later(60, loop.stop)
    session._connection._loop_until(lambda: session.document.select_one({"name": "answer"}).text == text)
    loop.remove_timeout(patience)
    assert session.document.select_one({"name": "answer"}).text == text
