"""Fits of parameters to measured data: misfit, search, profile likelihood, verdict; a measured series over a run."""

from .beginning import Beginning, settled_beginning
from .fit import Fit, fit
from .parameters import Free, per_frequency
from .records import RecordsTarget
from .targets import CurveTarget, FeatureTarget, SeriesTarget
from .virtual_data import virtual_curve, virtual_series

__all__ = ["Beginning", "CurveTarget", "FeatureTarget", "Fit", "Free", "RecordsTarget", "SeriesTarget", "fit",
           "per_frequency", "settled_beginning", "virtual_curve", "virtual_series"]
