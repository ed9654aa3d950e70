"""Reading and writing HDF5 files safely: files are sealed, and nothing in a file is trusted."""

from .border import File, opened
from .seal import SIGNATURE, VERSIONS, seal

__all__ = ["SIGNATURE", "VERSIONS", "File", "opened", "seal"]
