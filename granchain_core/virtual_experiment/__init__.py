"""Virtual experiments: what a rig's sensors would record of the model's motion, always marked as virtual."""

from ..experiment.sensors import Sensors
from .recorded import virtual_curve_csv, virtual_series_csv

__all__ = ["Sensors", "virtual_curve_csv", "virtual_series_csv"]
