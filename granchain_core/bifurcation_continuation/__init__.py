"""Bifurcation curves over two knobs (folds, period doublings, Neimark–Sacker points), from a point or a parameter map.
"""

from .continuation import CURVE_ENDS, follow_curve, points_of_curve
from .in_map import BifurcationCurve, bifurcation_curves
from .point import BifurcationPoint, bifurcation_point

__all__ = [
    "CURVE_ENDS", "BifurcationCurve", "BifurcationPoint", "bifurcation_curves", "bifurcation_point", "follow_curve",
    "points_of_curve",
]
