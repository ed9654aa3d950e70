"""Compilation in other processes: failures are logged and reported, and the server never compiles in their place."""

from __future__ import annotations

import logging
import os
import signal
import subprocess
import time
from threading import Event
from typing import Any

import pytest
from waiting import until

from app.serve.compiling import compiler
from app.serve.compiling.compiler import ATTEMPTS, CompilationFailed, Compiler, Requests
from granchain_core import scene
from granchain_core.execution.stop import Stop
from granchain_core.precompile.pieces import REGIME_KERNELS
from granchain_core.precompile.warm import is_warm


def not_here(*_: object) -> None:
    """Stand in for `compile_piece`, which must not run in the server: it would hold the GIL for tens of seconds."""
    raise AssertionError("compiled in the server's process")


def kill_first(killed: int, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Kill the first processes as soon as they are started; return the list to which all process ids are added."""
    started: list[int] = []

    class KilledProcess(subprocess.Popen):  # type: ignore[type-arg]
        def __init__(self, *given: Any, **named: Any) -> None:
            super().__init__(*given, **named)
            started.append(self.pid)
            if len(started) <= killed:
                os.kill(self.pid, signal.SIGKILL)

    monkeypatch.setattr(subprocess, "Popen", KilledProcess)
    monkeypatch.setattr(compiler, "compile_piece", not_here)
    return started


def test_a_compiler_that_fails_by_itself_is_reported_with_what_it_said(monkeypatch: pytest.MonkeyPatch,
                                                                      caplog: pytest.LogCaptureFixture,
                                                                      capfd: pytest.CaptureFixture[str]) -> None:
    """Another process would end with the same error."""
    started = kill_first(0, monkeypatch)
    with caplog.at_level(logging.WARNING, logger="granchain"), pytest.raises(CompilationFailed, match="ended with status 1"):
        compiler._compile(scene("sec2"), "no such piece")
    assert len(started) == 1
    assert "compiling no such piece failed: its process ended with status 1, attempt 1 of 3" in caplog.text
    assert "KeyError" in capfd.readouterr().err  # the other process's output


def test_a_compiler_that_is_killed_is_replaced_by_another_process(monkeypatch: pytest.MonkeyPatch,
                                                                  caplog: pytest.LogCaptureFixture) -> None:
    started = kill_first(ATTEMPTS - 1, monkeypatch)
    with caplog.at_level(logging.WARNING, logger="granchain"):
        compiler._compile(scene("sec2"), REGIME_KERNELS)
    assert len(started) == ATTEMPTS and caplog.text.count("ended with status -9") == ATTEMPTS - 1
    assert is_warm(scene("sec2"), [REGIME_KERNELS])


def test_a_compiler_that_is_killed_each_time_is_a_fault_for_who_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    """The next request tries again."""
    one, started = Compiler(), kill_first(2 * ATTEMPTS, monkeypatch)
    monkeypatch.setattr(one, "has", lambda *_: False)
    for tries in (1, 2):
        with pytest.raises(CompilationFailed, match="ended with status -9"):
            one.await_piece(scene("sec2"), REGIME_KERNELS, Stop())
        assert len(started) == tries * ATTEMPTS


def test_a_compiler_that_cannot_be_started_is_tried_again(monkeypatch: pytest.MonkeyPatch) -> None:
    tries: list[object] = []

    def refuse(*given: object, **_: object) -> None:
        tries.append(given)
        raise OSError("no more processes")

    monkeypatch.setattr(subprocess, "Popen", refuse)
    monkeypatch.setattr(compiler, "compile_piece", not_here)
    with pytest.raises(CompilationFailed, match=r"could not be started .no more processes."):
        compiler._compile(scene("sec2"), REGIME_KERNELS)
    assert len(tries) == ATTEMPTS


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
