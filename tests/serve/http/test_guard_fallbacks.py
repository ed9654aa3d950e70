"""The guards and page of a real server when a release of Bokeh, Panel or Tornado lacks internals that they use."""

from __future__ import annotations

import asyncio
import json
import logging
import re
import subprocess
import sys

import pytest
from bokeh.document.models import DocumentModelManager
from bokeh.server.tornado import BokehTornado
from event_loop import run_async
from listening import Listening
from missing_attribute import hide
from tornado.httpclient import HTTPRequest
from tornado.web import Application
from tornado.websocket import websocket_connect

from app.serve.document import document_models
from app.serve.document.part_messages import dispatch
from app.serve.http import guard, guarded_socket
from app.server import Access
from tools.visitors.visitor import Visitor


async def visit(address: str) -> int:
    """Open the page, move a knob and leave; return the number of pictures received."""
    visitor = Visitor(address)
    await visitor.open()
    assert await visitor.move("f", 400.51) is not None
    await visitor.leave()
    return visitor.pictures


def test_without_the_class_of_handlers_that_open_pages_visitors_are_still_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guard, "SessionHandler", None)
    one = Listening(Access(max_sessions=2))
    try:
        there = [one.open(one.token()) for _ in range(2)]
        assert [status for status, _ in there] == [101, 101] and one.ask()[0] == 503
        assert [one.ask(path)[0] for path in ("/liveness", "/metrics", "/static/js/bokeh.min.js")] == [200] * 3
        for _, each in there:
            each.close()
    finally:
        one.stop()


def test_a_page_whose_models_are_collected_anew_each_time_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    hide(monkeypatch, document_models, DocumentModelManager, "freeze")
    one = Listening(Access())
    try:
        assert run_async(visit(f"http://127.0.0.1:{one.port}")) >= 2
    finally:
        one.stop()


def test_actions_reach_the_parts_without_bokehs_decoding(monkeypatch: pytest.MonkeyPatch) -> None:
    """The guard finds the session by the id in its token."""
    taken: list[bool] = []

    def noted(session: object, content: dict[str, object]) -> bool:
        taken.append(dispatch(session, content))
        return taken[-1]

    monkeypatch.setattr(guarded_socket, "dispatch", noted)
    one = Listening(Access())
    try:
        run_async(visit(f"http://127.0.0.1:{one.port}"))
        assert sum(taken) >= 3, "ready, a moved knob and a painted picture"
    finally:
        one.stop()


def test_a_request_without_a_guard_gets_no_page(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    """This simulates a Tornado that finds request handlers in another way."""
    one = Listening(Access())
    try:
        assert 'id="knobs"' in one.ask()[2]
        monkeypatch.setattr(BokehTornado, "get_handler_delegate", Application.get_handler_delegate)
        with caplog.at_level(logging.CRITICAL):
            _, headers, text = one.ask()
        assert "X-Request-Id" not in headers, "there was a guard"
        assert 'id="knobs"' not in text
    finally:
        one.stop()


def test_an_error_on_a_websocket_has_an_id_that_is_in_the_log_and_no_traceback(caplog: pytest.LogCaptureFixture) -> None:
    async def fail(one: Listening) -> list[str]:
        address = f"127.0.0.1:{one.port}"
        request = HTTPRequest(f"ws://{address}/ws", headers={"Origin": f"http://{address}"})
        socket = await websocket_connect(request, subprotocols=["bokeh", one.token()], max_message_size=10**8)
        frames = [str(await socket.read_message()) for _ in range(3)]
        assert json.loads(frames[0])["msgtype"] == "ACK"
        change = {"kind": "ModelChanged", "model": {"id": "p0"}, "attr": "inner_width", "new": 1}
        for part in ({"msgid": "1", "msgtype": "PATCH-DOC"}, {}, {"events": [change]}):
            await socket.write_message(json.dumps(part))
        frames = [str(await socket.read_message()) for _ in range(3)]
        for part in ({"msgid": "2", "msgtype": "PULL-DOC-REQ"}, {}, {}):
            await socket.write_message(json.dumps(part))
        frames += [str(await socket.read_message()) for _ in range(3)]
        socket.close()
        return frames

    one = Listening(Access())
    try:
        with caplog.at_level(logging.ERROR, logger="granchain.requests"):
            frames = run_async(asyncio.wait_for(fail(one), 60))
    finally:
        one.stop()
    header, _, content, next_header, _, document = map(json.loads, frames)
    assert header["msgtype"] == "ERROR" and header["reqid"] == "1" and content["traceback"] is None
    found = re.fullmatch(r"The message could not be handled \(request ([0-9a-f]{12})\)\.", content["text"])
    assert found is not None
    (record,) = [one for one in caplog.records if getattr(one, "request", "") == found[1]]
    assert "p0" in record.getMessage()
    assert next_header["msgtype"] == "PULL-DOC-REPLY" and document["doc"]["roots"], "the next answer is unaffected"


_PROGRAM = """
import asyncio, importlib, sys, panel
lost = [("bokeh.server.views.session_handler", "SessionHandler"), ("bokeh.core.property.wrappers", "PropertyValueContainer"),
        ("bokeh.core.property.descriptors", "PropertyDescriptor"), ("panel.io.resources", "patch_stylesheet"),
        ("panel.io.resources", "BASE_TEMPLATE")]
kept = [(importlib.import_module(module), name) for module, name in lost]
values = [vars(module).pop(name) for module, name in kept]
import app.server as server
from app.serve.http import guard
assert guard.SessionHandler is None
server.install_defaults_cache()
server.install_resources_cache()
for (module, name), value in zip(kept, values):
    setattr(module, name, value)
sys.path[:0] = ["tests", "tests/serve", "tests/serve/http"]
from listening import Listening
from test_guard_fallbacks import visit
one = Listening(server.Access())
print("pictures", asyncio.run(visit(f"http://127.0.0.1:{one.port}")))
one.stop()
"""


def test_a_server_starts_and_serves_without_the_names_that_its_modules_would_import() -> None:
    """The libraries keep these names: they are missing only while the dashboard is imported and prepared."""
    done = subprocess.run([sys.executable, "-c", _PROGRAM], capture_output=True, text=True, timeout=200, check=False)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout.split()[-1]) >= 2
