"""HDF5 files as such: sealed when they are written, and checked in everything when they are read."""

from .border import File, opened
from .seal import SIGNATURE, VERSIONS, seal

__all__ = ["SIGNATURE", "VERSIONS", "File", "opened", "seal"]
