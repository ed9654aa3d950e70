"""Functions run uncompiled, for a debugger, as docs/compiling.md says."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.integrate.uncompiled import uncompiled
from granchain_core.kernels.compiling.jit import brief_kernel, inline_llvm, inline_numba, internal, kernel
from granchain_core.kernels.rk4.run import run_steps
from granchain_core.kernels.status import DONE

_PAGE = Path(__file__).resolve().parents[3] / "docs" / "compiling.md"


def test_the_example_runs_uncompiled_and_gives_the_same_motion() -> None:
    (code,) = re.findall(r"^```python\n(.+?)^```$", _PAGE.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    names: dict[str, Engine] = {}
    exec(compile(code, _PAGE.name, "exec"), names)
    compiled = Engine(scene("sec2"), MethodSetting("rk4-split"), 8)
    compiled.record(1)
    # vectors add in a different order
    np.testing.assert_allclose(names["engine"].y, compiled.y, rtol=0, atol=1e-12 * np.abs(compiled.y).max())
    assert np.abs(compiled.y).max() > 0.0


def test_only_this_engine_runs_uncompiled_and_it_does_so_with_other_values_too(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []
    monkeypatch.setattr(run_steps, "py_func", lambda *arguments: calls.append(arguments) or (DONE, 1))
    engine, other = (Engine(scene("sec2"), MethodSetting("rk4-split"), 8) for _ in range(2))
    uncompiled(engine).use(engine.scaled)
    engine.record(1)
    assert len(calls) == 1 and engine.stepper.work.simd is None
    other.record(1)
    assert len(calls) == 1 and other.stepper.work.simd is not None


def test_error_control_does_not_run_uncompiled() -> None:
    with pytest.raises(TypeError, match="fixed steps run uncompiled, not dop853"):
        uncompiled(Engine(scene("sec2"), MethodSetting("dop853", tolerance=1e-6), 8))


@pytest.mark.parametrize(("decorator", "compiles"), [
    (kernel, True), (brief_kernel, True), (inline_numba, True), (internal, False), (inline_llvm, False)])
def test_callees_of_an_uncompiled_function_run_as_the_table_says(decorator, compiles: bool) -> None:  # type: ignore[no-untyped-def]
    def twice(value):  # type: ignore[no-untyped-def]
        return 2.0 * value

    function = decorator(twice)
    assert function(1.5) == function.py_func(1.5) == 3.0
    dispatcher = getattr(function, "dispatcher", function)
    assert bool(dispatcher.signatures) == compiles
