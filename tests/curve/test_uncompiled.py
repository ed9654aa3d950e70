"""A curve whose kernels cannot be compiled reports this once, and does not wait for them."""

from __future__ import annotations

import pytest

from app.curve import controller
from app.curve.controller import CurveController
from app.curve.curve_bar import CurveBar
from app.curve.view import CurveFigure
from app.serve.compiling import compiler
from app.serve.compiling.compiler import Compiler
from app.session.session import Session
from granchain_core.precompile.pieces import CURVE_KERNELS
from tests.host import FakeHost


class Host(FakeHost):
    """A host with a session."""

    def __init__(self) -> None:
        super().__init__()
        self.session = Session()


@pytest.fixture
def tries(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Record attempts to compile: all kernels but the curve's are present, and those cannot be compiled."""
    found: list[str] = []

    def fails(_: object, piece: str) -> None:
        found.append(piece)
        raise OSError("no space left")

    one = Compiler()
    monkeypatch.setattr(one, "has", lambda _, *pieces: CURVE_KERNELS not in pieces)
    monkeypatch.setattr(compiler, "_compile", fails)
    monkeypatch.setattr(controller, "COMPILER", one)
    return found


def test_a_curve_that_cannot_be_compiled_says_so_once_and_is_not_under_way(tries: list[str]) -> None:
    host, figure, placed = Host(), CurveFigure(lambda _: None), []
    curves = CurveController(host, figure, CurveBar(lambda _: None), lambda: placed.append(True))  # type: ignore[arg-type]
    curves.restart_when_quiet(host.session.scene)
    assert figure.expected
    host.run_callbacks_until(lambda: bool(host.faults))
    (error, sentence), = host.faults
    assert isinstance(error, OSError) and "resonance curve" in sentence and "compiled" in sentence
    assert tries == [CURVE_KERNELS] and not figure.expected and placed and not curves.computing
    assert {detail for _, _, detail in curves.activities() if detail != "not selected"} == {"its kernels could not be compiled"}
    curves.knob_moved(host.session.scene.evolve(D=80.0))
    host.run_callbacks_until(lambda: not host.callbacks)
    assert len(host.faults) == 1 and tries == [CURVE_KERNELS]


def test_a_curve_begins_once_another_attempt_to_compile_has_succeeded(tries: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """For example, the next picture's attempt."""
    host = Host()
    curves = CurveController(host, CurveFigure(lambda _: None), CurveBar(lambda _: None), lambda: None)  # type: ignore[arg-type]
    curves.restart_when_quiet(host.session.scene)
    host.run_callbacks_until(lambda: bool(host.faults))
    begun: list[object] = []
    monkeypatch.setattr(curves, "_begin", begun.append)
    monkeypatch.setattr(controller.COMPILER, "has", lambda *_: True)
    curves.restart_when_quiet(host.session.scene)
    host.run_callbacks_until(lambda: not host.callbacks)
    assert begun == [host.session.scene]
