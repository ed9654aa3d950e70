"""Results as HDF5 that other programs open with labelled axes."""

from .branches import load_branch, save_branch
from .files import check_writable, load, save, save_curve
from .observations import save_observation

__all__ = ["check_writable", "load", "load_branch", "save", "save_branch", "save_curve", "save_observation"]
