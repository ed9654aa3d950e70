"""A virtual experiment: what the sensors of a rig would record of the model's motion, marked so wherever it goes."""

from .recorded import virtual_curve_csv, virtual_series_csv
from .sensors import Sensors

__all__ = ["Sensors", "virtual_curve_csv", "virtual_series_csv"]
