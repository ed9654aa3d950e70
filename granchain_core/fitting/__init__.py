"""Fits of parameters to measured data: misfit, search, profile likelihood and verdict; overlays of series on runs."""

from .beginning import Beginning, settled_beginning
from .curve_target import CurveTarget
from .feature_target import FeatureTarget
from .fit import fit
from .parameters import Free, per_frequency
from .records import RecordsTarget
from .result import Fit
from .series_target import SeriesTarget
from .virtual_data import virtual_curve, virtual_series

__all__ = ["Beginning", "CurveTarget", "FeatureTarget", "Fit", "Free", "RecordsTarget", "SeriesTarget", "fit",
           "per_frequency", "settled_beginning", "virtual_curve", "virtual_series"]
