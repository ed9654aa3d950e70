"""Periodic orbits as fixed points of the stroboscopic map: its derivative, Newton's method, multipliers, modes."""

from ..former_names import of_module
from .branch.axis import CONTINUOUS, KnobAxis
from .branch.branch import Branch, Continuation, begin_branch, continue_branch
from .branch.check import check_branch
from .branch.half_branch import HalfBranch
from .branch.normal_forms import NormalForm
from .branch.point import BranchPoint
from .branch.special import SpecialPoint
from .branch.switch import switch_to_doubled
from .find_orbit import periodic_orbit, random_state
from .orbit import Orbit
from .response import Response, response
from .search import orbit_near_motion

__all__ = [
    "CONTINUOUS", "Branch", "BranchPoint", "Continuation", "HalfBranch", "KnobAxis", "NormalForm", "Orbit",
    "Response", "SpecialPoint", "begin_branch", "check_branch", "continue_branch", "orbit_near_motion",
    "periodic_orbit", "random_state", "response", "switch_to_doubled",
]

__getattr__ = of_module(__name__)
