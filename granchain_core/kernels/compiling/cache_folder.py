"""The folder of compiled kernels: which one it is, who may write to it, and when those of other sources are removed.

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

from .sources import source_bytes_hash, sources_hash

#: Where messages for the user go: to stderr, unless the program keeps a log.
_LOG = logging.getLogger("granchain")
#: How the names of the files begin by which warm.py marks what is compiled.
MARK = "compiled-"
#: Folders of other sources are removed when they have not been used for this long [s].
_MONTH = 30 * 86400.0
#: Rights of the folder of kernels and of its files, less those that the umask takes away: whatever it leaves to the
#: group, only this user writes.
FOLDER_RIGHTS, FILE_RIGHTS = 0o755, 0o644
#: Rights of others than the owner to write.
_OTHERS = stat.S_IWGRP | stat.S_IWOTH
#: Names of the folders of kernels: each has a hash of the sources, and of what else decides the code (sources.py).
_FOLDERS = re.compile(r"kernels-[0-9a-f]{12}")


def cache_folder() -> Path | None:
    """The folder of the compiled kernels; None, with one message, where nothing can be kept.

    It is in $GRANCHAIN_CACHE, else in the user's cache, if only this user or the administrator can write to it, and
    nobody else can put another folder in its place. Links on the way there are followed once, here: the path that is
    returned has none. Where it cannot be written, kernels that are there already are used; else a folder in the
    temporary directory is, if it is this user's alone.
    """
    base, problem = _chosen_base(), "there is no home folder"
    if base is not None:
        name = _name_in(base)
        try:
            base.mkdir(mode=FOLDER_RIGHTS, parents=True, exist_ok=True)
            if not os.environ.get("GRANCHAIN_CACHE"):
                _close_to_others(base)
            (base / name).mkdir(mode=FOLDER_RIGHTS, exist_ok=True)
            with tempfile.TemporaryFile(dir=base / name):
                pass
            unsafe = _why_unsafe(base, base / name)
            if unsafe is None:
                _note_use(base, base / name)
                return base / name
            problem = unsafe
        except OSError as denied:
            problem = f"{base}: {denied.strerror or denied}"
            if _holds_kernels(base / name) and _why_unsafe(base, base / name) is None:
                return base / name
    return _temporary_folder(problem)


def _name_in(base: Path) -> str:
    """Name of the folder of these sources: that of the one in `base` with their fingerprint, else by parsing them."""
    fingerprint = _fingerprint_file()
    with contextlib.suppress(OSError):
        for folder in base.iterdir():
            if _FOLDERS.fullmatch(folder.name) and not folder.is_symlink() and (folder / fingerprint).exists():
                return folder.name
    return f"kernels-{sources_hash()}"


@functools.cache
def _fingerprint_file() -> str:
    """Name of the empty file that records a hash of the sources' bytes, so that unchanged sources are not parsed."""
    return f"sources-{source_bytes_hash()}"


def _chosen_base() -> Path | None:
    """The folder for folders of kernels, without links; None where the system does not know the user."""
    chosen = os.environ.get("GRANCHAIN_CACHE")
    try:
        base = Path(chosen or Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "granchain")
    except RuntimeError:
        return None
    return Path(os.path.realpath(base))


def _holds_kernels(folder: Path) -> bool:
    try:
        return any(folder.rglob("*.nbc"))
    except OSError:
        return False


def _close_to_others(base: Path) -> None:
    """Take the right to write from others: earlier versions left it to them in the user's cache where the umask did."""
    state = base.stat()
    if hasattr(os, "getuid") and state.st_uid == os.getuid() and state.st_mode & _OTHERS:
        base.chmod(stat.S_IMODE(state.st_mode) & ~_OTHERS)


def _why_unsafe(base: Path, folder: Path) -> str | None:
    """Why others than this user and the administrator may have written kernels in `folder`; None if they cannot.

    The files are unpickled and run. Whoever may write to `base`, or to a folder above it, could put another folder in
    the place of the one that was looked at, unless the sticky bit leaves every folder in it to its owner. A link in a
    sticky folder may be another user's, who could let it point to this user's folder now and elsewhere later: `base`
    has had none since it was chosen, and none is followed here.
    """
    if not hasattr(os, "getuid"):
        return None
    for path in (*reversed(base.parents), base, folder):
        state, sticky = path.lstat(), 0 if path == folder else stat.S_ISVTX
        if stat.S_ISLNK(state.st_mode):
            return f"{path} is a link"
        if state.st_uid not in (0, os.getuid()) or (state.st_mode & _OTHERS and not state.st_mode & sticky):
            return f"others may write to {path}"
    return None


def _temporary_folder(problem: str) -> Path | None:
    """A folder in the temporary directory, which others write to as well: only one that is ours alone is used."""
    if hasattr(os, "getuid"):
        base = Path(tempfile.gettempdir()) / f"granchain-{os.getuid()}"
        try:
            if _is_ours(base):
                folder = base / _name_in(base)
                if _is_ours(folder):
                    _note_use(base, folder)
                    return folder
            else:
                folder = base
            problem = f"{problem}, and {folder} is not a folder of ours with mode 700"
        except OSError as denied:
            problem = f"{problem}, and {base}: {denied.strerror or denied}"
    warn_once(f"Compiled kernels cannot be kept ({problem}); they are compiled for this process only.")
    return None


def _is_ours(folder: Path) -> bool:
    """Make the folder, or find it there: no link, with this user as owner and no rights for anybody else."""
    with contextlib.suppress(FileExistsError):
        folder.mkdir(mode=0o700)
    state = folder.lstat()
    return stat.S_ISDIR(state.st_mode) and state.st_uid == os.getuid() and stat.S_IMODE(state.st_mode) == 0o700


def _note_use(base: Path, used: Path) -> None:
    """Note that a folder is used and by which sources, and remove folders that have not been used for a month."""
    (used / _fingerprint_file()).touch()
    os.utime(used)
    for folder in base.iterdir():
        if _FOLDERS.fullmatch(folder.name) and folder != used:
            with contextlib.suppress(OSError):  # another process may remove it as well
                state = folder.lstat()
                if stat.S_ISDIR(state.st_mode) and time.time() - state.st_mtime > _MONTH:
                    shutil.rmtree(folder, ignore_errors=True)


@functools.cache
def warn_once(sentence: str) -> None:
    """Warn the user of something once in the life of this process."""
    _LOG.warning(sentence)


if numba.config.DISABLE_JIT:
    raise RuntimeError("NUMBA_DISABLE_JIT is set, but kernels must be compiled; unset it (`py_func` can be debugged).")
CACHE_FOLDER = cache_folder()
