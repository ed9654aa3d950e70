"""An otherwise empty page with the scripts of `app`, which are served unchanged, without a server."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import Route

from app.scripts import FILES, INLINE_SCRIPTS
from app.session.page_constants import page_constants

APP = Path(__file__).parents[2] / "app"
ORIGIN = "http://scripts.test/"
#: The elements that the inline scripts look up, and a minimal Bokeh.
BLANK = """<!doctype html><div id="dashboard">
  <div id="lost" hidden></div><div id="bar"></div><div id="side"></div><div id="stage"></div><div id="curves"><div id="curve"></div></div>
  <div id="overlay"><div data-overlay="probe" hidden></div></div><div id="foot"></div></div>
<script>window.Bokeh = { documents: [{ on_event: (name, act) => { window.closeSocket = act; } }] };</script>"""


class Answers:
    """The answers at the address of the scripts: modules, the blank page, and `readiness` for whether there is room."""

    readiness = 502
    reason = ""

    def __init__(self) -> None:
        self.opened: list[str] = []
        self.asked = 0

    def __call__(self, route: Route) -> None:
        """Answer a request."""
        path = route.request.url.removeprefix(ORIGIN).partition("?")[0]
        if path == "readiness":
            self.asked += 1
            route.fulfill(status=self.readiness, body=self.reason)
        elif path.endswith(".js"):
            route.fulfill(path=APP / path, content_type="text/javascript")
        else:
            self.opened.append(route.request.url)
            inline = "".join(FILES[name].read_text(encoding="utf-8") for name in INLINE_SCRIPTS)
            scripts = f"window.pageConstants = {page_constants()};" + inline
            route.fulfill(body=f"{BLANK}<script>{scripts}</script>", content_type="text/html")
