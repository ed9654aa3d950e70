"""The table of mutants; docs/mutation.md says how they were chosen."""

from __future__ import annotations

from .claims import CLAIMS
from .dop853_root import DOP853_ROOT
from .force_free import FORCE_FREE
from .laws import LAWS
from .mutant import Mutant
from .steps import STEPS
from .tangents import TANGENT_FLOW
from .vectors import VECTORS

MUTANTS: tuple[Mutant, ...] = LAWS + STEPS + FORCE_FREE + TANGENT_FLOW + VECTORS + DOP853_ROOT + CLAIMS

#: The eight kinds of mistake that must always be noticed (docs/mutation.md), and the mutants of each.
DEMANDED: dict[str, tuple[str, ...]] = {
    "no saltation": ("no-saltation", "no-saltation-in-second-route", "saltation-at-closing-only"),
    "determinant-only check": ("determinant-only-check", "determinant-only-comparison"),
    "missing last contact": ("missing-last-contact", "motion-without-last-contact", "flow-without-last-contact",
                             "batch-without-last-contact", "tangent-without-last-contact"),
    "t += dt": ("t-plus-dt", "batch-t-plus-dt"),
    "absolute coordinates": ("absolute-coordinates",),
    "`if d > 0` hiding NaN": ("if-d-above-0-hides-nan", "nan-hidden-in-vectors", "nan-hidden-in-batches"),
    "fastmath": ("fastmath", "fastmath-in-vectors", "fastmath-nnan", "fastmath-ninf"),
    "step over a touch": ("step-over-a-touch", "flow-steps-over-a-touch", "wide-steps-over-touch"),
}

#: All tests of the core, those that compile least first; a mutant that survives its own tests is run against these.
BROAD: tuple[str, ...] = ("tests/kernels", "tests/scene", "tests/physics", "tests/integrate", "tests/runs", "tests/numerics",
                          "tests/steady", "tests/orbits", "tests/observers", "tests/parameter_maps", "tests/hard_cases/test_outcomes.py", "tests/hard_cases/test_broken.py",
                          "tests/hard_cases/test_cases.py", "tests/hard_cases/test_fuzz.py",
                          "--deselect", "tests/kernels/test_machine_code.py", "--deselect", "tests/kernels/compiling/test_cache.py",
                          "-k", "not stop_flag")
