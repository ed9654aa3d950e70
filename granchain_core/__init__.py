"""granchain: driven granular chains, simulated to a stated accuracy.

    from granchain_core import resonance_curve, run, scene
    result = run(scene("sec2").evolve(f=340.0))

The names in `__all__` are the public API; everything else may change. Most commands have a function of the same name.
README.md lists the others (section "Python"), and docs/python.md lists former names that still work.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from .errors import BadInput, Cancelled, ComputationError, OverBudget
from .former_names import NAMES, present
from .scene import Amplitude, Bead, Scene, scene, scene_names
from .version import __version__

if TYPE_CHECKING:
    from .accuracy import WorkPrecision, work_precision
    from .analysis.bands import bands
    from .analysis.basins import Basins, basins
    from .analysis.bifurcation_diagram import BifurcationDiagram, bifurcation_diagram
    from .analysis.lyapunov_spectrum import LyapunovSpectrum, lyapunov_spectrum
    from .analysis.pulse import Pulse, pulse
    from .analysis.rotation_number import RotationNumber, rotation_number
    from .analysis.spectrum import Spectrum, Transfer, spectrum, transfer
    from .attractor_search import Attractor, Attractors, attractors
    from .bifurcation_continuation import BifurcationCurve, bifurcation_curves
    from .execution.stop import Stop
    from .fitting import Fit, fit
    from .observers import Observation, observe
    from .orbits import Branch, Orbit
    from .orbits import continue_branch as branch
    from .orbits import periodic_orbit as orbit
    from .parameter_maps import ParameterMap, parameter_map
    from .prescribed_drive import Driven, Signal, drive
    from .results.regime import Regime
    from .results.run import Cost, Run
    from .runs.live import LiveChain
    from .runs.many import Runs, run_many
    from .runs.to_accuracy import run
    from .scene.state import State
    from .steady.curve.curve import Curve, CurvePoint
    from .steady.curve.resonance_curve import iter_curve, resonance_curve
    from .steady.settling.outcome import Settled
    from .steady.settling.settle import settle, settling
    from .store import load, save

#: Public names by module, imported at first use so that `import granchain_core` is quick.
_MODULES = {
    "runs.to_accuracy": ("run",), "runs.many": ("Runs", "run_many"), "runs.live": ("LiveChain",),
    "results.run": ("Cost", "Run"), "scene.state": ("State",), "execution.stop": ("Stop",),
    "steady.settling.settle": ("settle", "settling"), "steady.settling.outcome": ("Settled",),
    "results.regime": ("Regime",),
    "steady.curve.curve": ("Curve", "CurvePoint"),
    "steady.curve.resonance_curve": ("iter_curve", "resonance_curve"),
    "orbits": ("Branch", "Orbit", "branch", "orbit"), "fitting": ("Fit", "fit"),
    "parameter_maps": ("ParameterMap", "parameter_map"),
    "attractor_search": ("Attractor", "Attractors", "attractors"),
    "bifurcation_continuation": ("BifurcationCurve", "bifurcation_curves"),
    "prescribed_drive": ("Driven", "Signal", "drive"), "observers": ("Observation", "observe"),
    "accuracy": ("WorkPrecision", "work_precision"), "store": ("load", "save"),
    "analysis.basins": ("Basins", "basins"), "analysis.spectrum": ("Spectrum", "Transfer", "spectrum", "transfer"),
    "analysis.lyapunov_spectrum": ("LyapunovSpectrum", "lyapunov_spectrum"),
    "analysis.rotation_number": ("RotationNumber", "rotation_number"),
    "analysis.bifurcation_diagram": ("BifurcationDiagram", "bifurcation_diagram"),
    "analysis.pulse": ("Pulse", "pulse"), "analysis.bands": ("bands",),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}
#: Names of two public functions inside their modules, where `orbit` and `branch` are variables.
_IN_MODULE = {"orbit": "periodic_orbit", "branch": "continue_branch"}

__all__ = [
    "Amplitude", "Attractor", "Attractors", "BadInput", "Basins", "Bead", "BifurcationCurve", "BifurcationDiagram",
    "Branch", "Cancelled", "ComputationError", "Cost", "Curve", "CurvePoint", "Driven", "Fit", "LiveChain",
    "LyapunovSpectrum", "Observation", "Orbit", "OverBudget", "ParameterMap", "Pulse", "Regime", "RotationNumber",
    "Run", "Runs", "Scene", "Settled", "Signal", "Spectrum", "State", "Stop", "Transfer",
    "WorkPrecision", "__version__", "attractors", "bands", "basins", "bifurcation_curves", "bifurcation_diagram",
    "branch", "drive", "fit", "iter_curve", "load", "lyapunov_spectrum", "observe", "orbit", "parameter_map",
    "pulse", "resonance_curve", "rotation_number", "run", "run_many", "save", "scene", "scene_names", "settle",
    "settling", "spectrum", "transfer", "work_precision",
]
# `import *` imports the former names as well.
__all__ += [row.former for row in NAMES if row.name in __all__]


def __getattr__(name: str) -> Any:
    """Import a public or former name at its first use."""
    public = present(name)
    if public in _MODULE_OF:
        return getattr(importlib.import_module(f".{_MODULE_OF[public]}", __name__), _IN_MODULE.get(public, public))
    if public in __all__:
        return globals()[public]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
