"""Monkeypatch of Bokeh: a guard stands before every handler of its servers (docs/security.md).

Tornado asks the application for the handler of each request (`get_handler_delegate`). There a class with a guard takes
the place of the handler's own.
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

#: The name of the setting that has an application's `Rules`.
_SETTING = "granchain_rules"


def guarded(handler: type[RequestHandler], rules: Rules) -> type[RequestHandler]:
    """The handler class with a guard before it; a handler of files also sends them compressed."""
    if handler not in rules.handlers:
        guard = GuardedSocket if issubclass(handler, WebSocketHandler) else Guard
        files = (CompressedFiles,) if issubclass(handler, StaticFileHandler) else ()
        rules.handlers[handler] = type(f"Guarded{handler.__name__}", (guard, *files, handler), {"rules": rules})
    return rules.handlers[handler]


def install_guards(rules: Rules) -> dict[str, Rules]:
    """Put a guard before every handler of Bokeh's servers in this process; returns the setting that turns it on.

    It replaces a method of `BokehTornado`, which does nothing for applications without the setting. Raises
    `MissingPart` where Tornado has no such method. Should a release have it and no longer use it, requests would have
    no guard, and `is_guarded` says so: a page of ours must not open then.
    """
    if not hasattr(Application, "get_handler_delegate"):
        raise MissingPart("tornado.web.Application.get_handler_delegate", "requests would be answered without checks")
    BokehTornado.get_handler_delegate = _guarded_delegate
    return {_SETTING: rules}


def _guarded_delegate(application: Application, request: Any, handler: type[RequestHandler], *args: Any,
                      **kwargs: Any) -> Any:
    rules = application.settings.get(_SETTING)
    checked = handler if rules is None else guarded(handler, rules)
    return Application.get_handler_delegate(application, request, checked, *args, **kwargs)
