"""A Chromium that can be hidden, frozen and put to sleep; Playwright tells every page that it is visible."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import subprocess
import time
import urllib.request
from concurrent.futures import Future
from contextlib import suppress
from pathlib import Path
from threading import Thread
from typing import Any

from server import CHROMIUM_OPTIONS
from tornado.websocket import WebSocketClientConnection, websocket_connect

from app.headless.chromium import installed_browser

#: Timeout of all waits [s].
_PATIENCE = 120.0


class SleepingBrowser:
    """One page in a separate Chromium, driven by the Chrome DevTools Protocol. Its event loop has its own thread."""

    def __init__(self, profile: Path) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        self._process = subprocess.Popen(
            [_chromium(), *CHROMIUM_OPTIONS, "--headless=new", "--remote-debugging-port=0",
             f"--user-data-dir={profile}", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        self._number = 0
        try:
            self._socket: WebSocketClientConnection = self._wait(_connect(_page(profile / "DevToolsActivePort")))
            self._window = self.send("Browser.getWindowForTarget")["windowId"]
        except BaseException:
            self.close()
            raise

    def _wait(self, work: Any) -> Any:
        future: Future[Any] = asyncio.run_coroutine_threadsafe(work, self._loop)
        return future.result(_PATIENCE)

    def send(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command, and return its result."""
        self._number += 1
        answer = self._wait(_answer(self._socket, {"id": self._number, "method": method, "params": parameters}))
        assert "error" not in answer, answer
        return dict(answer["result"])

    def evaluate(self, expression: str) -> Any:
        """Return the value of a JavaScript expression in the page."""
        answer = self.send("Runtime.evaluate", expression=expression, returnByValue=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def until(self, expression: str) -> None:
        """Wait until an expression is true; one that fails counts as false."""
        end = time.monotonic() + _PATIENCE
        while not self.evaluate(f"(() => {{ try {{ return Boolean({expression}); }} catch {{ return false; }} }})()"):
            assert time.monotonic() < end, f"did not come: {expression}"
            time.sleep(0.05)

    def open(self, address: str, script: str) -> None:
        """Open an address in the page; `script` runs before the page's own scripts."""
        self.send("Page.addScriptToEvaluateOnNewDocument", source=script)
        self.send("Page.enable")
        self.send("Page.navigate", url=address)

    def hide(self) -> None:
        """Minimize the window."""
        self.send("Browser.setWindowBounds", windowId=self._window, bounds={"windowState": "minimized"})
        self.until("document.hidden")

    def show(self) -> None:
        """Show the window again."""
        self.send("Browser.setWindowBounds", windowId=self._window, bounds={"windowState": "normal"})
        self.until("!document.hidden")

    def freeze(self) -> None:
        """Freeze the page, as a browser does with a tab that has been hidden for minutes."""
        self.send("Page.setWebLifecycleState", state="frozen")

    def resume(self) -> None:
        """Resume a frozen page."""
        self.send("Page.setWebLifecycleState", state="active")

    def sleep(self, seconds: float) -> None:
        """Stop all processes of the browser for this long, as in a sleeping computer."""
        os.killpg(self._process.pid, signal.SIGSTOP)
        try:
            time.sleep(seconds)
        finally:
            os.killpg(self._process.pid, signal.SIGCONT)

    def close(self) -> None:
        """Kill all processes of the browser; the first may be a script that started it."""
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait(timeout=60)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(20)


def _chromium() -> str:
    path = installed_browser()
    assert path is not None, "the browser tests need a Chromium on the PATH"
    return path


def _page(port_file: Path) -> str:
    """Return the address of the first page's websocket, once the browser has written its port and answers."""
    end = time.monotonic() + _PATIENCE
    while True:
        try:
            port = int(port_file.read_text(encoding="utf-8").split()[0])
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/json", timeout=5) as answer:
                return str(next(page for page in json.load(answer) if page["type"] == "page")["webSocketDebuggerUrl"])
        except (OSError, IndexError, StopIteration):
            assert time.monotonic() < end, "Chromium did not start"
            time.sleep(0.1)


async def _connect(address: str) -> WebSocketClientConnection:
    return await websocket_connect(address)


async def _answer(socket: WebSocketClientConnection, command: dict[str, Any]) -> dict[str, Any]:
    await socket.write_message(json.dumps(command))
    while True:
        text = await socket.read_message()
        assert text is not None, "the page is gone"
        answer: dict[str, Any] = json.loads(text)
        if answer.get("id") == command["id"]:
            return answer
