"""granchain: driven granular chains, simulated to a stated accuracy.

    from granchain_core import scene, run, resonance_curve
    result = run(scene("sec2").evolve(f=340.0))
"""

from .errors import BadInput, Cancelled, NumbersFailed
from .integrate import State
from .live import LiveChain
from .observe import observe
from .result import Cost, Run
from .run import run
from .scene import Scene, scene, scene_names
from .steady.curve import Curve, CurvePoint, iter_curve, resonance_curve
from .steady.regime import Regime
from .steady.settle import Settled, settled, settling

__version__ = "0.1.0"

__all__ = [
    "BadInput", "Cancelled", "Cost", "Curve", "CurvePoint", "LiveChain", "NumbersFailed", "Regime", "Run", "Scene",
    "Settled", "State", "iter_curve", "observe", "resonance_curve", "run", "scene", "scene_names",
    "settled", "settling",
]
