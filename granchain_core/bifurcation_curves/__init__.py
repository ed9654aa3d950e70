"""Bifurcation curves over two knobs: folds, period doublings, Neimark–Sacker points, from a point or parameter map."""

from .continuation import BifurcationPoint, bifurcation_point, points_of_curve
from .in_map import BifurcationCurve, bifurcation_curves

__all__ = ["BifurcationCurve", "BifurcationPoint", "bifurcation_curves", "bifurcation_point", "points_of_curve"]
