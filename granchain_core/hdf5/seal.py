"""The seal of a file: the SHA-256 of its bytes in a last line, checked before HDF5 opens it.

HDF5 stores its own length and ignores everything after it, so h5py, xarray, h5dump and other programs open a sealed
file like any other. h5py removes the line when it opens a file for writing. Sealed files have HDF5's superblock version
2. Files of earlier versions of granchain have superblock version 0 and no seal, so a sealed file that loses its seal
cannot pass for an old one.

The seal detects damage and careless changes. It is not a signature: anyone who forges a file can also seal it.
"""

from __future__ import annotations

import hashlib
import os
import re
from pathlib import Path
from typing import BinaryIO

from .plain import Refused

#: HDF5 version bounds that give superblock version 2, which distinguishes sealed files from older ones (HDF5 1.8,
#: 2008).
VERSIONS = ("v108", "v108")
#: First bytes of every HDF5 file, and therefore of every netCDF-4 file.
SIGNATURE = b"\x89HDF\r\n\x1a\n"
_LINE = "\ngranchain: SHA-256 of the {:020d} bytes before this line is {}\n"
_PATTERN = re.compile(rb"\ngranchain: SHA-256 of the (\d{20}) bytes before this line is ([0-9a-f]{64})\n")
_LENGTH = len(_LINE.format(0, "0" * 64))
_BLOCK = 1 << 20


def seal(path: Path) -> None:
    """Append the seal to a complete file, and wait until it is on disk."""
    with path.open("r+b") as file:
        size = file.seek(0, os.SEEK_END)
        file.write(_LINE.format(size, _digest(file, size)).encode())
        file.flush()
        os.fsync(file.fileno())


def is_sealed(path: Path, required: bool = True) -> bool:
    """Return whether a file has a valid seal; False for a file of an earlier version. Raises `Refused` for damage.

    If a seal is not `required`, files written by other programs may have any version of HDF5's superblock.
    """
    if not path.is_file():
        path.stat()  # raises with the reason if it is not there
        raise Refused("it is not a file")
    with path.open("rb") as file:
        head = file.read(len(SIGNATURE) + 1)
        if head[:-1] != SIGNATURE:
            raise Refused("it is not an HDF5 file, or its beginning is damaged")
        size = file.seek(0, os.SEEK_END) - _LENGTH
        file.seek(max(size, 0))
        seal = _PATTERN.fullmatch(file.read(_LENGTH))
        if seal is None:
            if head[-1] == 0 or not required:
                return False
            raise Refused("the line with its checksum is missing: the file is damaged, cut short, or was changed by "
                          "another program")
        if int(seal[1]) != size or seal[2].decode() != _digest(file, size):
            raise Refused("its checksum does not match: the file is damaged or was changed by another program")
    return True


def _digest(file: BinaryIO, size: int) -> str:
    """Return the SHA-256 of the first `size` bytes."""
    digest = hashlib.sha256()
    file.seek(0)
    while size > 0 and (block := file.read(min(_BLOCK, size))):
        digest.update(block)
        size -= len(block)
    return digest.hexdigest()
