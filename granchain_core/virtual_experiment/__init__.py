"""Virtual experiments: records of the model's motion by a rig's sensors, always marked as virtual."""

from ..experiment.sensors import Sensors
from .recorded import virtual_curve_csv, virtual_series_csv

__all__ = ["Sensors", "virtual_curve_csv", "virtual_series_csv"]
