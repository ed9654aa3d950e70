"""HDF5 files, sealed with a checksum when written and checked when read (docs/reliability.md)."""

from .checked_file import File, opened
from .seal import SIGNATURE, VERSIONS, seal

__all__ = ["SIGNATURE", "VERSIONS", "File", "opened", "seal"]
