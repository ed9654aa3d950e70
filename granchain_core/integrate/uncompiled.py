"""Fixed steps in Python, for a debugger: docs/compiling.md, “In a debugger”."""

from __future__ import annotations

from .engine import Engine
from .fixed import FixedStep


def uncompiled(engine: Engine) -> Engine:
    """Make an engine with fixed steps run `run_steps` in Python, with the scalar code; return the engine.

    What it calls by `kernel`, `brief_kernel` or `inline_numba` stays compiled, in the first call. A step without events
    then takes about half a millisecond with 11 beads.

    Raises
    ------
    TypeError
        The engine's method has no fixed steps.
    """
    if not isinstance(engine.stepper, FixedStep):
        raise TypeError(f"only methods with fixed steps run uncompiled, not {engine.setting.method}")
    engine.stepper.stay_uncompiled()
    return engine
