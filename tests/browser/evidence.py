"""Evidence of a failed browser test: a screenshot, the console's messages and the server's log."""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from playwright.sync_api import Error, Page


@dataclass
class Watched:
    """A page of a test, its console messages, and the log of its server."""

    page: Page
    log: Path
    messages: list[str] = field(default_factory=list)


#: Stash key: the pages of a test, in the order in which they were opened.
WATCHED = pytest.StashKey[list[Watched]]()


def watch(item: pytest.Item, page: Page, log: Path) -> None:
    """Record the page's console messages in case the test fails."""
    one = Watched(page, log)
    page.on("console", lambda message: one.messages.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: one.messages.append(f"error: {error}"))
    item.stash.setdefault(WATCHED, []).append(one)


def folder_of(item: pytest.Item) -> Path:
    """Return the folder for a test's evidence, below `build/`, which git ignores."""
    name = re.sub(r"[^\w.=-]+", "-", item.nodeid.rpartition("/")[2]).strip("-")
    return item.config.rootpath / "build" / "browser-failures" / name


def leave(watched: list[Watched], folder: Path) -> str:
    """Write the evidence into a folder, replacing that of an earlier run, and return the names of its files."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for number, one in enumerate(watched, 1):
        (folder / f"console-{number}.txt").write_text("\n".join([one.page.url, *one.messages]) + "\n", encoding="utf-8")
        try:
            one.page.screenshot(path=folder / f"page-{number}.png", timeout=10_000)
        except Error as problem:  # a page that is closed or hangs
            (folder / f"page-{number}.txt").write_text(f"no screenshot: {problem}\n", encoding="utf-8")
        if one.log.exists():
            shutil.copy(one.log, folder / "server.log")
    return ", ".join(sorted(path.name for path in folder.iterdir()))
