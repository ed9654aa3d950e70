"""Periodic orbits as fixed points of the stroboscopic map, their stability, and branches of them."""

from .branch import Branch, Continuation, begin_branch, continue_branch
from .branch_axis import CONTINUOUS, KnobAxis
from .branch_check import check_branch
from .branch_point import BranchPoint
from .branch_special import SpecialPoint
from .branch_switch import switch_to_doubled
from .branch_walk import Arm
from .orbit import Orbit, periodic_orbit, random_state
from .response import Response, response

__all__ = [
    "CONTINUOUS", "Arm", "Branch", "BranchPoint", "Continuation", "KnobAxis", "Orbit", "Response", "SpecialPoint",
    "begin_branch", "check_branch", "continue_branch", "periodic_orbit", "random_state", "response",
    "switch_to_doubled",
]
