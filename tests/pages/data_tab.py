"""The data tab of a dashboard without a browser: messages with files, and what the tab then shows."""

from __future__ import annotations

import base64
from typing import Any

from headless_dashboard import Dashboard

from app.dashboard.show import show_settled
from app.frames import samples_for
from app.pages.data.page import DataPage
from granchain_core import settle

#: A curve of two points.
FILE = b"frequency_Hz,force_N\n40,5.5\n60,12.1\n"


def data_page(dashboard: Dashboard) -> DataPage:
    """Return the page of the data tab."""
    return next(page for page in dashboard.pages if isinstance(page, DataPage))


def sent(content: bytes) -> dict[str, Any]:
    """Return a message with a file."""
    return {"do": "measurement", "name": "mine.csv", "content": base64.b64encode(content).decode()}


def after(dashboard: Dashboard, message: dict[str, Any], name: str) -> Any:
    """Return `name` in the tab's state after the message is processed, or the sentence if the message is refused."""
    dashboard.receive(message)
    dashboard.run_callbacks_until(lambda: bool(dashboard.session.sentence or dashboard.views.tabs.state.get(name)))
    return dashboard.views.tabs.state.get(name) or dashboard.session.sentence


def show(dashboard: Dashboard) -> None:
    """Show a settled picture as the worker that computes it does."""
    chain = dashboard.session.scene
    dashboard.session.settled = settle(chain, samples=samples_for(chain))
    show_settled(dashboard.views, 1, dashboard.session.settled)
