"""The folder of compiled kernels: its choice, who may write to it, and when folders of other sources are removed.

Its files are unpickled and run (cache.py), so nobody else may ever have been able to write to it.
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

#: Logger for messages to the user: they go to stderr, unless the program keeps a log.
_LOG = logging.getLogger("granchain")
#: Prefix of the names of the files with which warm.py marks structures as compiled.
MARK = "compiled-"
#: Folders of other sources are removed after not being used for this long [s].
_MONTH = 30 * 86400.0
#: Permissions of the folder of kernels and of its files, before the umask: even if the umask would let the group write,
#: only this user may.
FOLDER_RIGHTS, FILE_RIGHTS = 0o755, 0o644
#: Write permissions of anyone but the owner.
_OTHERS = stat.S_IWGRP | stat.S_IWOTH
#: Names of the folders of kernels: each contains a hash of the sources and of everything else that determines the code
#: (sources.py).
_FOLDERS = re.compile(r"kernels-[0-9a-f]{12}")


def cache_folder() -> Path | None:
    """Return the folder of compiled kernels, or None, with one message, if kernels cannot be kept.

    It is in $GRANCHAIN_CACHE or, if that is not set, in the user's cache, provided that only this user and the
    administrator can write to it and that nobody else can replace it with another folder. Links on the way there are
    followed once, here: the returned path has none. If the folder exists but cannot be written, the kernels in it are
    still used. Otherwise a folder in the temporary directory is used, if it belongs to this user alone.
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
    """Return the name of these sources' folder: by their fingerprint in `base` if it is there, else by parsing them."""
    fingerprint = _fingerprint_file()
    with contextlib.suppress(OSError):
        for folder in base.iterdir():
            if _FOLDERS.fullmatch(folder.name) and not folder.is_symlink() and (folder / fingerprint).exists():
                return folder.name
    return f"kernels-{sources_hash()}"


@functools.cache
def _fingerprint_file() -> str:
    """Return the name of an empty file that records the sources' bytes by a hash, to save parsing unchanged sources."""
    return f"sources-{source_bytes_hash()}"


def _chosen_base() -> Path | None:
    """Return the parent of the folders of kernels, with links resolved; None if the system does not know the user."""
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
    """Revoke others' write permission, which earlier versions left in the user's cache if the umask did."""
    state = base.stat()
    if hasattr(os, "getuid") and state.st_uid == os.getuid() and state.st_mode & _OTHERS:
        base.chmod(stat.S_IMODE(state.st_mode) & ~_OTHERS)


def _why_unsafe(base: Path, folder: Path) -> str | None:
    """Return why anyone but this user and the administrator may have written kernels in `folder`; None if nobody could.

    The files are unpickled and run. Anyone who may write to `base`, or to a folder above it, could replace the folder
    that was checked, unless the sticky bit reserves every folder there to its owner. A link in a sticky folder may
    belong to another user, who could point it to this user's folder now and elsewhere later. `base` has contained no
    links since it was chosen, and none is followed here.
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
    """Return a folder in the temporary directory; as others can write there too, it must be this user's alone."""
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
    """Make the folder if it is missing; return whether it is no link and only this user has any permissions."""
    with contextlib.suppress(FileExistsError):
        folder.mkdir(mode=0o700)
    state = folder.lstat()
    return stat.S_ISDIR(state.st_mode) and state.st_uid == os.getuid() and stat.S_IMODE(state.st_mode) == 0o700


def _note_use(base: Path, used: Path) -> None:
    """Record that these sources use a folder, and remove folders that have not been used for a month."""
    (used / _fingerprint_file()).touch()
    os.utime(used)
    for folder in base.iterdir():
        if _FOLDERS.fullmatch(folder.name) and folder != used:
            with contextlib.suppress(OSError):  # another process may be removing it too
                state = folder.lstat()
                if stat.S_ISDIR(state.st_mode) and time.time() - state.st_mtime > _MONTH:
                    shutil.rmtree(folder, ignore_errors=True)


@functools.cache
def warn_once(sentence: str) -> None:
    """Give the user a warning once per process."""
    _LOG.warning(sentence)


if numba.config.DISABLE_JIT:
    raise RuntimeError("NUMBA_DISABLE_JIT is set, but kernels must be compiled; unset it (`py_func` can be debugged).")
CACHE_FOLDER = cache_folder()
