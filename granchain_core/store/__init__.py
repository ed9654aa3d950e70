"""Results as HDF5 that other programs open with labelled axes."""

from .files import load, save, save_curve

__all__ = ["load", "save", "save_curve"]
