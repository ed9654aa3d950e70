"""A real dashboard process and a real browser, for the browser tests and the latency figures."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, BrowserContext, Error, Page, Playwright

from app.headless.chromium import installed_browser

#: A number for every call of `at_rest`, so that a call ignores values seen by earlier ones.
_CALLS = count()

ROOT = Path(__file__).resolve().parents[2]

CHROMIUM_OPTIONS = [
    "--no-sandbox", "--disable-gpu", "--in-process-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync",
]


def until(page: Page, holds: Callable[[], bool], seconds: float = 60.0) -> None:
    """Wait until a condition is true that the browser alone cannot check; during navigation, it counts as false."""
    def holds_now() -> bool:
        try:
            return holds()
        except Error as gone:
            if "context was destroyed" not in str(gone):
                raise
            return False

    end = time.monotonic() + seconds
    while not holds_now():
        assert time.monotonic() < end, "did not come"
        page.wait_for_timeout(50)


def at_rest(page: Page, value: str, still: int = 700) -> Any:
    """Wait until a JavaScript expression has kept its value for `still` milliseconds, and return that value.

    Results that were under way when the page was told to stop may still arrive; endless changes fail here.
    """
    page.wait_for_function(f"""([still, call]) => {{
      const now = performance.now(), value = JSON.stringify({value});
      if (window.resting?.call !== call || window.resting.value !== value) window.resting = {{ call, value, since: now }};
      return now - window.resting.since > still;
    }}""", arg=[still, next(_CALLS)], polling=50)
    return page.evaluate(value)


def free_port() -> int:
    """Return a free port."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextmanager
def dashboard(log: Path, **environment: str) -> Iterator[str]:
    """Yield the address of a dashboard that runs until the block ends."""
    server = Server(log, **environment)
    server.start()
    try:
        yield server.address
    finally:
        server.process.terminate()
        server.process.wait(timeout=60)


class Server:
    """A dashboard on its own port that can be stopped and started again on the same port.

    `before` is Python code that runs before serving, for example to set a constant.
    """

    process: subprocess.Popen[bytes]

    def __init__(self, log: Path, before: str = "", **environment: str) -> None:
        self.log, self._before, self._environment = log, before, environment
        self._port = free_port()
        self.address = f"http://127.0.0.1:{self._port}/"

    def start(self) -> None:
        """Start the dashboard and wait until it answers."""
        code = f"{self._before}\nfrom app.server import serve\nserve(port={self._port})"
        with self.log.open("ab") as output:
            self.process = subprocess.Popen([sys.executable, "-c", code], cwd=ROOT, stdout=output, stderr=output,
                                            env={**os.environ, **self._environment})
        try:
            _wait_until_alive(self.process, self.address, self.log)
        except BaseException:
            self.kill()
            raise

    def kill(self) -> None:
        """Kill the process at once, even if it is stopped."""
        self.process.kill()
        self.process.wait(timeout=60)


def _wait_until_alive(process: subprocess.Popen[bytes], address: str, log: Path) -> None:
    end = time.monotonic() + 180
    while time.monotonic() < end:
        if process.poll() is not None:
            break
        try:
            with urllib.request.urlopen(address + "liveness", timeout=2):
                return
        except OSError:
            time.sleep(0.1)
    raise RuntimeError(f"The dashboard did not start:\n{log.read_text(errors='replace')[-3000:]}")


def launch(playwright: Playwright) -> Browser:
    """Launch the system's Chromium, or the one installed by Playwright. Without one, this fails instead of skipping.

    With `GRANCHAIN_HEADED=1` in the environment, its window is shown.
    """
    return playwright.chromium.launch(**_how(playwright))


def launch_with_profile(playwright: Playwright, profile: Path, **options: Any) -> BrowserContext:
    """Launch it with a profile in this folder, and return the profile's context. One process renders all its pages."""
    how = _how(playwright)
    how["args"] = [*how["args"], "--process-per-site"]
    return playwright.chromium.launch_persistent_context(profile, **how, **options)


def _how(playwright: Playwright) -> dict[str, Any]:
    headed = bool(os.environ.get("GRANCHAIN_HEADED"))
    system = installed_browser(with_window=headed)
    if system is None and not Path(playwright.chromium.executable_path).exists():
        raise RuntimeError("The browser tests need Chromium: install the system's chromium package, "
                           "or run `playwright install chromium`.")
    return {"executable_path": system, "args": CHROMIUM_OPTIONS, "headless": not headed}


def resize(page: Page, width: int, height: int) -> None:
    """Resize the window, and wait until the page has this width; figures follow a little later."""
    page.set_viewport_size({"width": width, "height": height})
    page.wait_for_function("(width) => document.documentElement.scrollWidth === width", arg=width)
