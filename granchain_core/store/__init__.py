"""Results as HDF5 that other programs open with labelled axes."""

from .files import check_writable, load, save, save_curve
from .observations import save_observation

__all__ = ["check_writable", "load", "save", "save_curve", "save_observation"]
