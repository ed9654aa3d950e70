"""The methods and settings that are measured: every row of the table of methods, and SciPy's solvers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ..integrate import METHODS, MethodSetting
from .scipy_methods import SOLVERS

#: Settings of fixed-step methods: factors on the default number of steps.
_REFINES = (1, 2, 4, 8, 16)
#: Settings of methods with error control: tolerances per step.
_TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
#: Settings of SciPy's solvers: rtol = atol.
_SCIPY_TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9)
#: Prefix of the names of SciPy's solvers.
SCIPY = "scipy "


@dataclass(frozen=True)
class MeasuredMethod:
    """A method's presentation; `family` is "granchain", "naive" or "scipy"."""

    name: str
    title: str
    family: str
    order: float
    restrictions: str
    reference: str


@dataclass(frozen=True)
class MeasuredSetting:
    """One setting of one method; `value` is its refinement of the default steps, or its tolerance."""

    method: str
    label: str
    value: float
    setting: MethodSetting | None


def compared_methods() -> dict[str, MeasuredMethod]:
    """Return every method that can be measured, by name: the current table of methods, then SciPy's solvers."""
    own = [MeasuredMethod(m.name, m.title, "naive" if m.naive else "granchain", m.observed_order,
                          m.restrictions, m.reference) for m in METHODS.values()]
    others = [MeasuredMethod(SCIPY + s.name, s.title, "scipy", s.order, s.restrictions, s.reference)
              for s in SOLVERS.values()]
    return {method.name: method for method in (*own, *others)}


def label(setting: MethodSetting) -> str:
    """Describe a setting in words."""
    if METHODS[setting.method].error_control:
        return f"tolerance {setting.tolerance:.2g}"
    return f"{setting.refine:.3g} × the default steps"


def measured_settings() -> Iterator[MeasuredSetting]:
    """Yield every setting of every method, cheapest first within each method."""
    for method in METHODS.values():
        values = _TOLERANCES if method.error_control else _REFINES
        for value in values:
            setting = (MethodSetting(method.name, tolerance=value) if method.error_control
                       else MethodSetting(method.name, refine=int(value)))
            yield MeasuredSetting(method.name, label(setting), float(value), setting)
    for solver in SOLVERS:
        for tolerance in _SCIPY_TOLERANCES:
            yield MeasuredSetting(SCIPY + solver, f"tolerance {tolerance:g}", tolerance, None)
