"""granchain: driven granular chains, simulated to a stated accuracy.

    from granchain_core import scene, run, resonance_curve
    result = run(scene("sec2").evolve(f=340.0))
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from .errors import BadInput, Cancelled, NumbersFailed
from .integrate import State
from .observe import observe
from .result import Cost, Run
from .run.live import LiveChain
from .run.run import run
from .scene import Scene, scene, scene_names
from .steady.curve import Curve, CurvePoint, iter_curve, resonance_curve
from .steady.regime import Regime
from .steady.settle import Settled, settled, settling
from .version import __version__

if TYPE_CHECKING:
    from .accuracy import work_precision
    from .orbits import continue_branch, periodic_orbit
    from .store import load, save

#: Imported when they are first asked for: a page or a run that needs none of them starts sooner.
_LATER = {"work_precision": "accuracy", "continue_branch": "orbits", "periodic_orbit": "orbits", "load": "store",
          "save": "store"}

__all__ = [
    "BadInput", "Cancelled", "Cost", "Curve", "CurvePoint", "LiveChain", "NumbersFailed", "Regime", "Run", "Scene",
    "Settled", "State", "__version__", "continue_branch", "iter_curve", "load", "observe", "periodic_orbit",
    "resonance_curve", "run", "save", "scene", "scene_names", "settled", "settling", "work_precision",
]


def __getattr__(name: str) -> Any:
    """The names that are imported late."""
    if name in _LATER:
        return getattr(importlib.import_module(f".{_LATER[name]}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
