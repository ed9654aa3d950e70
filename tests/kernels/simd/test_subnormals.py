"""Subnormal numbers are zero while kernels flush them, and nonzero again afterwards.

The setting must be restored, because other libraries compute in the same thread.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from granchain_core import Cancelled, scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.integrate.batch import Batch
from granchain_core.integrate.flushed import flushed
from granchain_core.integrate.scaling import scale_chain
from granchain_core.kernels.batch_size import is_x86
from granchain_core.kernels.compiling.jit import kernel
from granchain_core.kernels.simd.subnormals import flush_subnormals, restore_subnormals
from granchain_core.scene.state import rest

SMALL, HALF = 1e-310, 5e-311
#: Half of `SMALL` while subnormal numbers are flushed; only x86 flushes them.
FLUSHED = 0.0 if is_x86() else HALF


def half() -> float:
    """Return half of a subnormal number with this thread's current setting; an array prevents constant folding."""
    return float((np.array([SMALL]) * 0.5)[0])


@pytest.fixture(autouse=True)
def as_numbers() -> Iterator[None]:
    """Check before and after every test that subnormal numbers are not flushed."""
    assert half() == HALF
    yield
    assert half() == HALF


@kernel
def halves(values):
    """Halve three numbers: before subnormal numbers are flushed, while they are, and afterwards."""
    first = values[0] * 0.5
    before = flush_subnormals()
    second = values[1] * 0.5
    values[1] = second
    restore_subnormals(before)
    values[0], values[2] = first, values[2] * 0.5


def test_a_kernel_flushes_between_the_two_calls_alone() -> None:
    values = np.full(3, SMALL)
    halves(values)
    assert values.tolist() == [HALF, FLUSHED, HALF]


def test_a_flushed_function_restores_the_setting_that_it_found() -> None:
    """When flushed functions are nested, the inner one leaves the outer one's setting in place."""
    outer = flushed(lambda: (half(), flushed(half)(), half()))
    assert outer() == (FLUSHED,) * 3


def test_the_setting_is_restored_after_an_exception() -> None:
    @flushed
    def fail() -> None:
        assert half() == FLUSHED
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert half() == HALF


@pytest.mark.parametrize("call", ["periods", "record"])
@pytest.mark.parametrize("cancelled", [False, True], ids=["to the end", "cancelled"])
def test_the_kernel_of_a_short_chain_restores_the_setting(call: str, cancelled: bool) -> None:
    """The kernel does so itself, without `flushed` around it."""
    stop = Stop()
    engine = Engine(scene("sec2"), MethodSetting("rk4-split"), 8, stop=stop)
    inner = getattr(Engine, call).__wrapped__
    if cancelled:
        stop.set()
        with pytest.raises(Cancelled):
            inner(engine, 4)
    else:
        inner(engine, 4)
    assert half() == HALF


@pytest.mark.parametrize("cancelled", [False, True], ids=["to the end", "cancelled"])
def test_the_kernel_of_a_batch_restores_the_setting(cancelled: bool) -> None:
    chain, stop = scene("sec2"), Stop()
    batch, scaled = Batch(chain, stop), scale_chain(chain)
    batch.put(0, scaled, scaled.from_si(rest(chain)), 1.0, return_at=2, earliest=2)
    if cancelled:
        stop.set()
        with pytest.raises(Cancelled):
            batch.run()
    else:
        batch.run()
    assert half() == HALF
