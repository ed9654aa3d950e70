"""An effect whose kernel cannot be compiled says so on the Effects page, and is not tried repeatedly."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from host import FakeHost
from waiting import until

from app.dashboard.tabs import Tabs
from app.pages.effects import page as module
from app.pages.effects.page import EffectsPage
from app.serve.compiling import compiler
from app.serve.compiling.compiler import PICTURE_PIECES, Compiler
from app.session.session import Session


class Host(FakeHost):
    """A host with a session on which nothing else computes."""

    def __init__(self) -> None:
        super().__init__()
        self.session = Session()

    def call_later(self, seconds: float, action: Callable[..., None], *arguments: Any) -> None:
        """Ignore the call: the test repeats the check itself."""

    def activities(self) -> list[Any]:
        return []


def test_each_failing_kernel_is_compiled_once(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[tuple[str, str]] = []

    def fails(scene: Any, piece: str) -> None:
        tried.append((module.structure(scene), piece))
        raise OSError("no space left")

    one, host = Compiler(), Host()
    monkeypatch.setattr(one, "has", lambda _, *pieces: set(pieces) <= set(PICTURE_PIECES))
    monkeypatch.setattr(compiler, "_compile", fails)
    monkeypatch.setattr(module, "COMPILER", one)
    page = EffectsPage(host, Tabs(lambda _: None))  # type: ignore[arg-type]

    def told() -> bool:
        page.visibility_changed(True)  # looks for the next thing to do
        effects = page._view.state["panel"]["effects"]
        return all(one["refused"] or one["state"] == "its kernel could not be compiled" for one in effects)

    until(told)
    assert tried and len(tried) == len(set(tried))
