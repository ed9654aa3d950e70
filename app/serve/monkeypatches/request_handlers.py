"""Monkeypatch of Bokeh that puts a guard before every handler of its servers (docs/security.md).

Tornado asks the application for the handler of each request (`get_handler_delegate`). The replacement returns a class
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

#: The name of the setting that contains an application's `Guards`.
_SETTING = "granchain_guards"


class Guards:
    """The guarded handlers of one application: a derived class for each handler class, made once."""

    def __init__(self, rules: Rules) -> None:
        self._rules = rules
        self._derived: dict[type[RequestHandler], type[RequestHandler]] = {}

    def before(self, handler: type[RequestHandler]) -> type[RequestHandler]:
        """Return the handler class with a guard before it; a file handler also sends the files compressed."""
        if handler not in self._derived:
            guard = GuardedSocket if issubclass(handler, WebSocketHandler) else Guard
            files = (CompressedFiles,) if issubclass(handler, StaticFileHandler) else ()
            bases = (guard, *files, handler)
            self._derived[handler] = type(f"Guarded{handler.__name__}", bases, {"rules": self._rules})
        return self._derived[handler]


def install_guards(rules: Rules) -> dict[str, Guards]:
    """Put a guard before every handler of Bokeh's servers in this process; return the setting that turns it on.

    This replaces a method of `BokehTornado`; applications without the setting keep their handlers. Raises `MissingPart`
    if Tornado has no such method. If a release has the method but does not call it, requests have no guard. Then
    `is_guarded` returns False, and none of our pages opens.
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
