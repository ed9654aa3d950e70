"""The websocket: messages leave together and at once; requests wait until they can be answered.

Private attributes of Tornado, Bokeh and Panel, and Panel's undocumented `set_curdoc`, are used in this file only. Each
saves some milliseconds or keeps a message from being lost; if a release drops one, the public API is used instead. Only
`guard` has no fallback: without it the server does not start.
"""

from __future__ import annotations

import socket
import weakref
from collections.abc import Callable
from typing import Any, NamedTuple

import panel as pn
from bokeh.core.property.descriptors import PropertyDescriptor
from bokeh.document import Document
from bokeh.events import Event
from bokeh.model import Model, collect_models
from bokeh.models import ImportedStyleSheet
from bokeh.server.server import Server
from panel.reactive import Syncable
from tornado.iostream import IOStream
from tornado.web import RequestHandler

from .guard import Rules, guarded

try:
    from panel.io.state import set_curdoc
except ImportError:  # it is not in Panel's documentation
    set_curdoc = None  # type: ignore[assignment]


def _session(document: Document) -> Any:
    return getattr(document.session_context, "session", None)


def _streams(document: Document) -> list[IOStream]:
    """The streams behind this page's websockets; empty if a release keeps them elsewhere."""
    connections = getattr(_session(document), "_subscribed_connections", ())
    sockets = [getattr(getattr(connection, "_socket", None), "ws_connection", None) for connection in connections]
    streams = [getattr(one, "stream", None) for one in sockets]
    return [stream for stream in streams if isinstance(stream, IOStream) and not stream.closed()]


def has_document_lock(document: Document) -> bool:
    """Whether Bokeh is known to hold the document's lock, without which the document may not be changed.

    While it holds the lock it keeps a list of pending writes. A message can also arrive while answers to an earlier
    one are still being written; Bokeh then refuses every change.
    """
    session = _session(document)
    return session is None or getattr(session, "_pending_writes", None) is not None


def with_document_lock(document: Document, action: Callable[[], None]) -> None:
    """Run `action` as soon as the document may be changed and the browser will be told of the change.

    The browser can send requests before it has reported that all parts are rendered. Until it has, Panel discards
    changes, as if the document had still to be fetched.
    """
    if not pn.state.loaded:
        pn.state.onload(action)
    elif has_document_lock(document):
        action()
    else:
        document.add_next_tick_callback(action)


def disable_nagle(document: Document) -> None:
    """Turn off Nagle's algorithm, which can delay a message by 40 ms until earlier ones are acknowledged."""
    for stream in _streams(document):
        stream.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


def gather_writes(document: Document) -> None:
    """Hand what is written in one turn of the event loop to the network together.

    A moved knob and its picture are about sixty small writes; sent singly, each costs 0.3 ms here and a wake-up in the
    browser. Where Tornado empties its buffer in another way than `_handle_write`, each goes by itself.
    """
    for stream in _streams(document):
        if hasattr(stream, "_handle_write") and "_handle_write" not in vars(stream):
            stream._handle_write = _Gathered(stream)  # type: ignore[method-assign]


class _Gathered:
    """Replaces a stream's `_handle_write`: empties the buffer when the present turn of the event loop is over."""

    def __init__(self, stream: IOStream) -> None:
        self._stream = weakref.ref(stream)
        self._loop = stream.io_loop
        self._due = False

    def __call__(self) -> None:
        """There is something to write."""
        if not self._due:
            self._due = True
            self._loop.add_callback(self._write)

    def _write(self) -> None:
        self._due = False
        stream = self._stream()
        if stream is not None and not stream.closed():
            type(stream)._handle_write(stream)


def guard(server: Server, rules: Rules) -> None:
    """Put a guard before every handler of the server; if Bokeh keeps them elsewhere, the server does not start."""
    application = server._tornado
    for rule in application.wildcard_router.rules:
        if isinstance(rule.target, type) and issubclass(rule.target, RequestHandler):
            rule.target = guarded(rule.target, rules)


#: Types of immutable values: models can share them.
_CONSTANTS = (type(None), bool, int, float, str, bytes)


def remember_defaults() -> None:
    """Ask Bokeh once for a property's default instead of once for every model: a fifth of an opening's work.

    Bokeh merges the overridden defaults of all base classes each time, some 8000 times a page. Only constants are
    remembered, of properties that no theme changes and that make no new default for every model. Where a release finds
    defaults in another way, they are found so.
    """
    find: Callable[[Any, Any], Any] | None = getattr(PropertyDescriptor, "_get_default", None)
    unstable: Callable[[Any, Any], bool] | None = getattr(PropertyDescriptor, "has_unstable_default", None)
    if find is None or unstable is None or hasattr(find, "known"):
        return
    known: dict[tuple[type, str], Any] = {}
    changing: dict[tuple[type, str], bool] = {}

    def is_unstable(descriptor: Any, model: Any) -> bool:
        key = (model.__class__, descriptor.name)
        if key not in changing:
            changing[key] = unstable(descriptor, model)
        return changing[key]

    def remembered(descriptor: Any, model: Any) -> Any:
        themed = model.themed_values()
        if themed and descriptor.name in themed:
            return find(descriptor, model)
        key = (model.__class__, descriptor.name)
        if key in known:
            return known[key]
        value = find(descriptor, model)
        if isinstance(value, _CONSTANTS) and not is_unstable(descriptor, model):
            known[key] = value
        return value

    remembered.known = known  # type: ignore[attr-defined]
    PropertyDescriptor.has_unstable_default = is_unstable
    PropertyDescriptor._get_default = remembered


class _Common(NamedTuple):
    """What the models of a part's instances have in common, and the properties of their data that are their own.

    Style sheets are their text, or the address of one that each document imports once.
    """

    properties: dict[str, Any]
    sheets: tuple[tuple[bool, str], ...]
    data: type[Model]
    own: frozenset[str]

    @classmethod
    def of(cls, part: Any, properties: dict[str, Any]) -> _Common | None:
        """From the properties of a class's first instance; None where they are not as expected."""
        properties = {**properties, "_defs": []}  # the class of the data is defined once
        data, sheets = properties.pop("data", None), properties.pop("stylesheets", [])
        if not isinstance(data, Model) or collect_models(properties):
            return None
        if not all(isinstance(one, (str, ImportedStyleSheet)) for one in sheets):
            return None
        own = frozenset(name for name in data.properties() - Model.properties() if name in part.param)
        return cls(properties, tuple((isinstance(one, str), str(getattr(one, "url", one))) for one in sheets),
                   type(data), own | {"name"})

    def properties_of(self, part: Any, imported: dict[str, ImportedStyleSheet]) -> dict[str, Any]:
        """The properties of another instance; `imported` are the sheets that its document imports, by address."""
        sheets = [text if is_text else imported.get(text) or imported.setdefault(text, ImportedStyleSheet(url=text))
                  for is_text, text in self.sheets]
        return {**self.properties, "stylesheets": sheets,
                "data": self.data(**{name: getattr(part, name) for name in self.own})}


_COMMON: dict[type, _Common | None] = {}
_IMPORTED: weakref.WeakKeyDictionary[Document, dict[str, ImportedStyleSheet]] = weakref.WeakKeyDictionary()


class WithCommonProperties:
    """A Panel component whose class is asked once for the properties of its model, not each instance.

    Instances differ in their data alone. Panel goes through 40 parameters of each part for every visitor, a tenth of an
    opening's work; it still does where a release has other properties than expected here.
    """

    def _get_properties(self, document: Document | None) -> dict[str, Any]:
        known = _COMMON.get(type(self))
        if known is not None and document is not None:
            return known.properties_of(self, _IMPORTED.setdefault(document, {}))
        found: dict[str, Any] = super()._get_properties(document)  # type: ignore[misc]
        if type(self) not in _COMMON:
            _COMMON[type(self)] = _Common.of(self, found)
        return found


class WithoutDesign:
    """A Panel component whose design is asked only when style sheets change: the one thing that it has a say in then.

    Panel works out the design's parameters at every change of every property, half of the time of a change. With a
    release that makes the changes elsewhere, it is asked again.
    """

    def _update_properties(self, *events: Any, doc: Document) -> dict[str, Any]:
        plain = getattr(Syncable, "_update_properties", None)
        if plain is None or any(event.name == "stylesheets" for event in events):
            return super()._update_properties(*events, doc=doc)  # type: ignore[misc]
        changes: dict[str, Any] = plain(self, *events, doc=doc)
        return changes


class WithoutBusyIndicator:
    """A Panel component whose events skip the busy indicator, which this page does not show: it takes 2 of 5 ms.

    Panel calls `_process_bokeh_event`; with a release that calls another method or has no `set_curdoc`, the indicator
    comes back.
    """

    def _process_bokeh_event(self, doc: Document, event: Event) -> None:
        handle = getattr(self, "_process_event", None)
        if handle is None or set_curdoc is None:
            super()._process_bokeh_event(doc, event)  # type: ignore[misc]
            return
        with set_curdoc(doc):
            handle(event)
