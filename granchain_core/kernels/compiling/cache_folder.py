"""The folder of compiled kernels: which one it is, who may write to it, and when folders of other versions are removed.

Its files are unpickled and run (cache.py), so it must be one that nobody else can have written to.
"""

from __future__ import annotations

import contextlib
import functools
import logging
import os
import re
import shutil
import stat
import tempfile
import time
from pathlib import Path

import numba

from .sources import sources_hash, wording_hash

#: Where messages for the user go: to stderr, unless the program keeps a log.
_LOG = logging.getLogger("granchain")
#: How the names of the files begin by which warm.py marks what is compiled.
MARK = "compiled-"
#: Folders of other versions are removed when they have not been used for this long [s].
_MONTH = 30 * 86400.0
#: Rights of the folder of kernels and of its files, less those that the umask takes away: whatever it leaves to the
#: group, only this user writes.
FOLDER_RIGHTS, FILE_RIGHTS = 0o755, 0o644
#: Names of the folders of all versions.
_VERSIONS = re.compile(r"kernels-[0-9a-f]{12}")


def cache_folder() -> Path | None:
    """The folder of the compiled kernels; None, with one message, where nothing can be kept.

    It is in $GRANCHAIN_CACHE, else in the user's cache, if only this user or the administrator can write to it. Where
    it cannot be written, kernels that are there already are used; else a folder in the temporary directory is, if it is
    this user's alone.
    """
    base, problem = _chosen_base(), "there is no home folder"
    if base is not None:
        name = _version_in(base)
        try:
            (base / name).mkdir(mode=FOLDER_RIGHTS, parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=base / name):
                pass
            if _is_trusted(base / name):
                _note_use(base, base / name)
                return base / name
            problem = f"others may write to {base / name}"
        except OSError as denied:
            problem = f"{base}: {denied.strerror or denied}"
            if _holds_kernels(base / name) and _is_trusted(base / name):
                return base / name
    return _temporary_folder(problem)


def _version_in(base: Path) -> str:
    """Name of the folder of these sources: the one in `base` that knows their wording, else by parsing them."""
    wording = _wording_file()
    with contextlib.suppress(OSError):
        for folder in base.iterdir():
            if _VERSIONS.fullmatch(folder.name) and (folder / wording).exists():
                return folder.name
    return f"kernels-{sources_hash()}"


@functools.cache
def _wording_file() -> str:
    """Name of the empty file by which a folder knows a wording of its sources."""
    return f"sources-{wording_hash()}"


def _chosen_base() -> Path | None:
    chosen = os.environ.get("GRANCHAIN_CACHE")
    if chosen:
        return Path(chosen)
    try:
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "granchain"
    except RuntimeError:  # a user whom the system does not know
        return None


def _holds_kernels(folder: Path) -> bool:
    try:
        return any(folder.rglob("*.nbc"))
    except OSError:
        return False


def _is_trusted(folder: Path) -> bool:
    """Whether only this user or the administrator can have written a folder: its files are unpickled and run."""
    found, others = folder.stat(), stat.S_IWGRP | stat.S_IWOTH
    return not hasattr(os, "getuid") or (found.st_uid in (0, os.getuid()) and not found.st_mode & others)


def _temporary_folder(problem: str) -> Path | None:
    """A folder in the temporary directory, which others write to as well: only one that is ours alone is used."""
    if hasattr(os, "getuid"):
        base = Path(tempfile.gettempdir()) / f"granchain-{os.getuid()}"
        try:
            if _is_ours(base):
                folder = base / _version_in(base)
                if _is_ours(folder):
                    _note_use(base, folder)
                    return folder
            else:
                folder = base
            problem = f"{problem}, and {folder} is not a folder of ours with mode 700"
        except OSError as denied:
            problem = f"{problem}, and {base}: {denied.strerror or denied}"
    say_once(f"Compiled kernels cannot be kept ({problem}); they are compiled for this process only.")
    return None


def _is_ours(folder: Path) -> bool:
    """Make the folder, or find it there: no link, with this user as owner and no rights for anybody else."""
    with contextlib.suppress(FileExistsError):
        folder.mkdir(mode=0o700)
    found = folder.lstat()
    return stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and stat.S_IMODE(found.st_mode) == 0o700


def _note_use(base: Path, used: Path) -> None:
    """Note that a folder is used and by which wording, and remove folders that have not been used for a month."""
    (used / _wording_file()).touch()
    os.utime(used)
    for folder in base.iterdir():
        if _VERSIONS.fullmatch(folder.name) and folder != used:
            with contextlib.suppress(OSError):  # another process may remove it as well
                found = folder.lstat()
                if stat.S_ISDIR(found.st_mode) and time.time() - found.st_mtime > _MONTH:
                    shutil.rmtree(folder, ignore_errors=True)


@functools.cache
def say_once(sentence: str) -> None:
    """Tell the user something once in the life of this process."""
    _LOG.warning(sentence)


if numba.config.DISABLE_JIT:
    raise RuntimeError("NUMBA_DISABLE_JIT is set, but kernels must be compiled; unset it (`py_func` can be debugged).")
CACHE_FOLDER = cache_folder()
