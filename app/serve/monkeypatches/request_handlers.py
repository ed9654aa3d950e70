"""Monkeypatch of Bokeh: a guard stands before every handler of its servers (docs/security.md).

Tornado asks the application for the handler of each request (`get_handler_delegate`). The replacement gives it a class
with a guard.
"""

from __future__ import annotations

from typing import Any

from bokeh.server.tornado import BokehTornado
from tornado.web import Application, RequestHandler, StaticFileHandler
from tornado.websocket import WebSocketHandler

from ...library_internals import MissingPart
from ..http.compressed import CompressedFiles
from ..http.guard import Guard
from ..http.guarded_socket import GuardedSocket
from ..http.rules import Rules

#: The name of the setting that has an application's `Guards`.
_SETTING = "granchain_guards"


class Guards:
    """The guarded handlers of one application: for each class of handlers a derived class, which is made once."""

    def __init__(self, rules: Rules) -> None:
        self._rules = rules
        self._derived: dict[type[RequestHandler], type[RequestHandler]] = {}

    def before(self, handler: type[RequestHandler]) -> type[RequestHandler]:
        """The handler class with a guard before it; a handler of files also sends them compressed."""
        if handler not in self._derived:
            guard = GuardedSocket if issubclass(handler, WebSocketHandler) else Guard
            files = (CompressedFiles,) if issubclass(handler, StaticFileHandler) else ()
            bases = (guard, *files, handler)
            self._derived[handler] = type(f"Guarded{handler.__name__}", bases, {"rules": self._rules})
        return self._derived[handler]


def install_guards(rules: Rules) -> dict[str, Guards]:
    """Put a guard before every handler of Bokeh's servers in this process; return the setting that turns it on.

    The function replaces a method of `BokehTornado`; applications without the setting keep their handlers. Raises
    `MissingPart` if Tornado has no such method. If a release has the method and does not call it, requests have no
    guard. `is_guarded` then returns False, and no page of ours may open.
    """
    if not hasattr(Application, "get_handler_delegate"):
        raise MissingPart("tornado.web.Application.get_handler_delegate", "requests would be answered without checks")
    BokehTornado.get_handler_delegate = _guarded_delegate
    return {_SETTING: Guards(rules)}


def _guarded_delegate(application: Application, request: Any, handler: type[RequestHandler], *args: Any,
                      **kwargs: Any) -> Any:
    guards = application.settings.get(_SETTING)
    checked = handler if guards is None else guards.before(handler)
    return Application.get_handler_delegate(application, request, checked, *args, **kwargs)
