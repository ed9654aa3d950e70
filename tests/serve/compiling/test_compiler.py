"""Compilation in other processes: failures are logged, and the kernels are compiled in this process instead."""

from __future__ import annotations

import logging
import time
from threading import Event

import pytest
from waiting import until

from app.serve.compiling import compiler
from app.serve.compiling.compiler import Compiler, Requests
from granchain_core import scene


def test_a_failing_compiler_is_reported_with_its_output(monkeypatch: pytest.MonkeyPatch,
                                                            caplog: pytest.LogCaptureFixture,
                                                            capfd: pytest.CaptureFixture[str]) -> None:
    compiled: list[str] = []
    monkeypatch.setattr(compiler, "compile_piece", lambda _, piece: compiled.append(piece))
    with caplog.at_level(logging.WARNING, logger="granchain"):
        compiler._compile(scene("sec2"), "no such piece")
    assert compiled == ["no such piece"]
    assert "compiling no such piece in another process failed" in caplog.text
    assert "KeyError" in capfd.readouterr().err  # the other process's output


def test_a_failure_ahead_of_time_is_in_the_log(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    """No request waits for this compilation, so only the log shows that it failed."""
    one = Compiler()

    def fails(*_: object) -> None:
        raise ZeroDivisionError("a kernel that cannot be loaded")

    monkeypatch.setattr(one, "has", lambda *_: True)
    monkeypatch.setattr(one, "load", fails)
    with caplog.at_level(logging.ERROR, logger="granchain"):
        one.prepare(scene("sec2"))
        end = time.monotonic() + 20
        while "a kernel that cannot be loaded" not in caplog.text:
            assert time.monotonic() < end, "was not reported"
            time.sleep(0.01)


def test_a_compilation_that_failed_is_tried_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """If, for example, the disk was full for a moment, later visitors do not get the first visitor's error."""
    one, tries = Compiler(), []

    def fails_once(_: object, piece: str) -> None:
        tries.append(piece)
        if len(tries) == 1:
            raise OSError("no space left")

    monkeypatch.setattr(compiler, "_compile", fails_once)
    first = one.ask(scene("sec2"), "a piece")
    assert isinstance(first.exception(timeout=20), OSError)
    second = one.ask(scene("sec2"), "a piece")
    second.result(timeout=20)
    assert one.ask(scene("sec2"), "a piece") is second and tries == ["a piece"] * 2


def test_the_work_of_one_visitor_tries_a_piece_once_and_that_of_another_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """An attempt that is still running has not failed."""
    one, tries, finish = Compiler(), [], Event()

    def fails(_: object, piece: str) -> None:
        tries.append(piece)
        finish.wait(20)
        raise OSError("no space left")

    monkeypatch.setattr(compiler, "_compile", fails)
    requests, others = Requests(one), Requests(one)
    assert requests.failure(scene("sec2"), "a piece") is None
    assert requests.failure(scene("sec2"), "a piece") is None
    finish.set()
    until(lambda: isinstance(requests.failure(scene("sec2"), "a piece"), OSError))
    assert tries == ["a piece"]
    monkeypatch.setattr(compiler, "_compile", lambda *_: tries.append("again"))
    assert others.failure(scene("sec2"), "a piece") is None
    until(lambda: tries == ["a piece", "again"])
    assert others.failure(scene("sec2"), "a piece") is None
