"""Results as HDF5 files with labelled axes, which other programs can open."""

from .branches import load_branch, save_branch
from .curves import load_curve, save_curve
from .observations import save_observation
from .runs import load
from .saving import save
from .writing import check_writable

__all__ = [
    "check_writable", "load", "load_branch", "load_curve", "save", "save_branch", "save_curve", "save_observation",
]
