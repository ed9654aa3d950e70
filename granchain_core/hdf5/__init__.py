"""The one border for HDF5 files: sealed when they are written; nothing in one is trusted when it is read."""

from .border import File, opened
from .seal import VERSIONS, seal

__all__ = ["VERSIONS", "File", "opened", "seal"]
