"""Former names that still work, one row for each. Deleting a row removes the name from code, files and docs.

All other code uses present names. Modules, classes, tables of files and environment variables get their former names
from here, and docs/python.md lists them. Former names of the command line and the server are in app/former_names.py.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

_Class = TypeVar("_Class", bound=type)

#: Names of the values of `SpecialPoint.gained` in JSON and files.
EVENTS = {"closed interval": "touch", "open interval": "separation"}


class FormerName(NamedTuple):
    """A former name, the present one, and the version that removes the former name ("stays" if none does).

    `values` maps present values to former ones where the values have changed too.
    """

    former: str
    name: str
    removed_in: str = "1.0"
    values: Mapping[Any, Any] = MappingProxyType({})

    @property
    def last(self) -> str:
        """The former name without its class or table."""
        return self.former.rpartition(".")[2]

    def of(self, owner: Any) -> Any:
        """Return the value under the former name, read from the object that has the present name."""
        value = getattr(owner, self.name.rpartition(".")[2])
        return self.values.get(value, value) if self.values else value


#: Names in modules of this package.
NAMES = (
    FormerName("settled", "settle"),
    FormerName("periodic_orbit", "orbit"),
    FormerName("continue_branch", "branch"),
    FormerName("diagram", "parameter_map"),
    FormerName("Diagram", "ParameterMap"),
    FormerName("iter_diagram", "iter_parameter_map"),
    FormerName("strobe_diagram", "bifurcation_diagram"),
    FormerName("StrobeDiagram", "BifurcationDiagram"),
    FormerName("NumbersFailed", "ComputationError"),
    FormerName("Arm", "HalfBranch"),
    FormerName("Setting", "MethodSetting"),
)
#: Attributes of classes.
ATTRIBUTES = (
    FormerName("Branch.arms", "Branch.half_branches"),
    FormerName("BranchPoint.unstable", "BranchPoint.unstable_multipliers"),
    FormerName("BranchPoint.liouville", "BranchPoint.liouville_error"),
    FormerName("BranchPoint.turns", "BranchPoint.overlap_extrema"),
    FormerName("BranchPoint.turning", "BranchPoint.knob_direction"),
    FormerName("SpecialPoint.event", "SpecialPoint.gained", values=EVENTS),
    FormerName("Response.kind", "Response.in_step", values={True: "resonance", False: "anti-resonance", None: ""}),
    FormerName("Orbit.changes", "Orbit.contact_events"),
    FormerName("Orbit.liouville", "Orbit.liouville_error"),
    FormerName("LyapunovSpectrum.liouville", "LyapunovSpectrum.liouville_error"),
    FormerName("Regime.contraction", "Regime.assumed_contraction"),
    FormerName("Regime.decay", "Regime.observed_contraction"),
    FormerName("Regime.followed", "Regime.is_approach"),
    FormerName("Regime.followed_by", "Regime.orbit_found_by", values={"settling": None, "not stated": None}),
    FormerName("Fit.freedom", "Fit.degrees_of_freedom"),
    FormerName("Pulse.speed", "Pulse.speed_beads_s"),
    FormerName("Pulse.speed_in_metres", "Pulse.speed_m_s"),
    FormerName("WorkPrecision.lesson", "WorkPrecision.naive"),
)
#: Columns in the tables of results, and therefore in files.
COLUMNS = (
    FormerName("pulse.speed", "pulse.speed_beads_s", "stays"),
    FormerName("pulse.speed_in_metres", "pulse.speed_m_s", "stays"),
)
#: Keys of JSON and attributes of files, each preceded by the result that has it.
KEYS = (FormerName("fit.freedom", "fit.degrees_of_freedom", "stays"),)
#: Parameters of functions, which accept the former names themselves.
PARAMETERS = (FormerName("fit(design)", "fit(initial_points)"),)
#: Environment variables.
VARIABLES = (FormerName("GRANCHAIN_LANES", "GRANCHAIN_BATCH_SIZE", "stays"),)
#: Optional dependencies of the package, defined in pyproject.toml.
EXTRAS = (FormerName("granchain[files]", "granchain[frames]"),)

ALL = (*NAMES, *ATTRIBUTES, *COLUMNS, *KEYS, *PARAMETERS, *VARIABLES, *EXTRAS)

_PRESENT = {row.former: row.name for row in NAMES}


def present(name: str) -> str:
    """Return the present name of a module's public name; `name` itself if it has not changed."""
    return _PRESENT.get(name, name)


def of_module(module: str) -> Callable[[str], Any]:
    """Return a module's `__getattr__`, which resolves former names of the module's contents."""

    def value_of(name: str) -> Any:
        has = vars(sys.modules[module])
        if name in _PRESENT and _PRESENT[name] in has:
            return has[_PRESENT[name]]
        raise AttributeError(f"module {module!r} has no attribute {name!r}")

    return value_of


def with_former_names(owner: _Class) -> _Class:
    """Class decorator that adds the attributes under their former names."""
    for row in ATTRIBUTES:
        if row.former.startswith(f"{owner.__name__}."):
            setattr(owner, row.last, property(row.of, doc=f"The former name of `{row.name.rpartition('.')[2]}`."))
    return owner


def with_former_keys(owner: str, values: dict[str, Any], rows: tuple[FormerName, ...] = KEYS) -> dict[str, Any]:
    """Add the former names to the keys of a result's or command's JSON object, or to the attributes of its file."""
    return values | {row.last: values[row.name.rpartition(".")[2]]
                     for row in rows if row.former.startswith(f"{owner}.")}


def former_columns(table: str) -> dict[str, str]:
    """Return the former names of a table's columns, each with the present name."""
    return {row.last: row.name.rpartition(".")[2] for row in COLUMNS if row.former.startswith(f"{table}.")}
