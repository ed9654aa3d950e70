"""A virtual experiment: what a rig's sensors would record of the model's motion, always marked as virtual."""

from .recorded import virtual_curve_csv, virtual_series_csv
from .sensors import Sensors

__all__ = ["Sensors", "virtual_curve_csv", "virtual_series_csv"]
