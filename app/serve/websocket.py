"""How messages travel: a picture's all in one go, and at once; the page's when they can be answered.

The private attributes of Tornado, Bokeh and Panel that can be done without are used in this file only. Each buys some
milliseconds or a message that would be lost; where a release has it no more, the public way is taken.
"""

from __future__ import annotations

import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import panel as pn
from bokeh.document import Document
from bokeh.events import Event
from panel.io.state import set_curdoc
from tornado.iostream import IOStream


def _session(document: Document) -> Any:
    return getattr(document.session_context, "session", None)


def _streams(document: Document) -> list[IOStream]:
    """The streams of this page's websockets; none where the way to them is another one."""
    connections = getattr(_session(document), "_subscribed_connections", ())
    sockets = [getattr(getattr(connection, "_socket", None), "ws_connection", None) for connection in connections]
    streams = [getattr(one, "stream", None) for one in sockets]
    return [stream for stream in streams if isinstance(stream, IOStream) and not stream.closed()]


def has_turn(document: Document) -> bool:
    """Whether it is known to be the document's turn, in which alone it may be changed.

    Bokeh keeps a list of what is to be written while it is. A message can arrive outside of it, while an earlier one's
    answers are still being written; Bokeh refuses every change then.
    """
    session = _session(document)
    return session is None or getattr(session, "_pending_writes", None) is not None


def in_its_turn(document: Document, action: Callable[[], None]) -> None:
    """Do what the page asked for as soon as the document may be changed and the page learns of it.

    A page has its parts, and can ask, before it says that all of them are drawn. Panel throws away what is changed
    until then, as if the page were still to fetch the document.
    """
    if not pn.state.loaded:
        pn.state.onload(action)
    elif has_turn(document):
        action()
    else:
        document.add_next_tick_callback(action)


def send_at_once(document: Document) -> None:
    """Nothing is held back until the browser's system has acknowledged earlier messages, which may take 40 ms."""
    for stream in _streams(document):
        stream.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


@contextmanager
def in_one_go(document: Document) -> Iterator[None]:
    """The messages written in this block are handed to the network together when it ends.

    A picture is a score of small messages, and each of them would cost 0.3 ms here and a wake-up in the browser.
    Tornado collects what is written until its buffer is emptied; in the block, emptying waits. Where Tornado empties it
    in another way, each message goes by itself.
    """
    streams = [stream for stream in _streams(document) if hasattr(stream, "_handle_write")]
    for stream in streams:
        stream._handle_write = _wait  # type: ignore[method-assign]
    try:
        yield
    finally:
        for stream in streams:
            del stream._handle_write
            if not stream.closed():
                stream._handle_write()


def _wait() -> None:
    """What emptying a stream's buffer is while a picture is being written."""


class PromptEvents:
    """A Panel component whose events skip Panel's busy indicator, 2 ms of 5 for an event: this page does not show it.

    Panel calls `_process_bokeh_event`; a release that calls something else goes its own way, indicator and all.
    """

    def _process_bokeh_event(self, doc: Document, event: Event) -> None:
        handle = getattr(self, "_process_event", None)
        if handle is None:
            super()._process_bokeh_event(doc, event)  # type: ignore[misc]
            return
        with set_curdoc(doc):
            handle(event)
