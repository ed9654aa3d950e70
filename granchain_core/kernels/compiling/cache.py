"""The files of compiled kernels, and the handling of files that are damaged or cannot be written.

Numba reads its files with `pickle` and runs the machine code in them, even if a disk fault or a crash has damaged them.
So every file here begins with the SHA-256 of the rest, which is checked before the rest is used: a damaged file is
deleted and its kernel is compiled again. A kernel that cannot be written is compiled for this process only.

Numba has no documented interface for this: `KernelCache` replaces the classes with which Numba finds, reads and writes
its files. docs/compiling.md lists the private names used; if one is missing, kernels are not kept on disk.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import pickle
import uuid
from pathlib import Path
from typing import Any

import numba
from numba.core import event

from .cache_folder import CACHE_FOLDER, FILE_RIGHTS, MARK, warn_once
from .compile_lock import CompileLock
from .sources import FOLDER, constants_hash, hash_of_code

_FunctionCache: Any
_Impl: Any
_UserProvidedLocator: Any
try:
    from numba.core.caching import CompileResultCacheImpl as _Impl
    from numba.core.caching import FunctionCache as _FunctionCache
    from numba.core.caching import UserProvidedCacheLocator as _UserProvidedLocator
    from numba.core.runtime import rtsys
    from numba.core.serialize import dumps
except ImportError as missing:  # reported by `keep_on_disk`
    _FunctionCache = _Impl = _UserProvidedLocator = object
    _IMPORT_PROBLEM = str(missing)
else:
    _IMPORT_PROBLEM = ""
#: Private attributes of `FunctionCache` that `KernelCache` uses or replaces.
_NEEDED = ("_load_overload", "_index_key", "_guard_against_spurious_io_errors", "_impl_class")
#: Length of a checksum in bytes.
_DIGEST = 32


class _Files:
    """The specializations of one function, each in its own file, named by a hash of Numba's key for it.

    Numba keeps an index, and two processes that compile at once overwrite each other's and lose specializations. Here
    no index is needed: each file records which specialization it contains, and gets its final name only when it is
    complete.
    """

    def __init__(self, folder: str, name: str, stamp: Any) -> None:
        self._folder, self._name, self._stamp = Path(folder), name, stamp

    def path(self, key: Any) -> Path:
        """Return the path of the specialization with this key, whether or not the file exists."""
        return self._folder / f"{self._name}.{hashlib.sha256(str(key).encode()).hexdigest()[:16]}.nbc"

    def save(self, key: Any, data: Any) -> None:
        """Write one specialization."""
        content = dumps((numba.__version__, self._stamp, key, data))
        path = self.path(key)
        unfinished = path.with_suffix(f".{uuid.uuid4().hex[:16]}.tmp")
        try:
            # kernels in a container image are compiled by one user and used by another
            with open(unfinished, "xb", opener=lambda name, flags: os.open(name, flags, FILE_RIGHTS)) as file:
                file.write(hashlib.sha256(content).digest() + content)
            unfinished.replace(path)
        finally:
            with contextlib.suppress(OSError):
                unfinished.unlink(missing_ok=True)

    def load(self, key: Any) -> Any:
        """Return one specialization, or None if there is no intact file of it."""
        try:
            stored = pickle.loads(read_verified(self.path(key)))
        except FileNotFoundError:
            return None
        return stored[3] if stored[:3] == (numba.__version__, self._stamp, key) else None

    def flush(self) -> None:
        """Delete all specializations, as a function's `recompile` requires."""
        for path in self._folder.glob(f"{self._name}.*.nbc"):
            path.unlink(missing_ok=True)


def read_verified(path: Path) -> bytes:
    """Return the content of a file; if its checksum is wrong, delete it and raise `FileNotFoundError`.

    A damaged file may be part of any structure that is marked as compiled, so all marks are deleted with it.
    """
    stored = path.read_bytes()
    digest, content = stored[:_DIGEST], stored[_DIGEST:]
    if hashlib.sha256(content).digest() == digest:
        return content
    warn_once(f"Damaged kernels in {path.parent.parent} are dropped and compiled again.")
    for file in (path, *path.parent.parent.glob(f"{MARK}*")):
        with contextlib.suppress(OSError):  # another process was first, or the file stays and is never used
            os.unlink(file)
    raise FileNotFoundError(path)


#: Numba asks twice for each function in a file.
_hash_once = functools.cache(hash_of_code)


class _Locator(_UserProvidedLocator):
    """The location of a function's files: always the folder of kernels, even if it cannot be written.

    Numba names a file after the source's path and the function's line number, and stamps it with the source's
    modification time. Here the name comes from the module and the function's constants, and the stamp from the source's
    code. So the same sources in another environment, reinstalled or with different comments, find the code that is
    already compiled.
    """

    _cache_path: str

    def __init__(self, py_func: Any, py_file: str) -> None:
        super().__init__(py_func, py_file)
        _ = self._cache_path  # AttributeError if Numba does not use it
        self._cache_path = str(Path(numba.config.CACHE_DIR) / py_func.__module__)
        self._constants = constants_hash(py_func)

    def get_source_stamp(self) -> str:
        """Return the folder's name, which identifies all its kernels; for one elsewhere, also the hash of its file."""
        here = Path(self._py_file)
        own = "" if here.is_relative_to(FOLDER) else _hash_once(here)
        return f"{Path(numba.config.CACHE_DIR).name} {own}"

    def get_disambiguator(self) -> str:
        """Return a string that distinguishes functions of the same name."""
        return self._constants

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> _Locator:
        """Return the locator of a function's files."""
        return cls(py_func, py_file)


class _Placed(_Impl):
    _locator_classes = [_Locator]  # noqa: RUF012 – the attribute that Numba reads


class KernelCache(_FunctionCache):
    """The specializations of one function on disk; AttributeError if Numba lacks a name that it needs."""

    _impl_class = _Placed

    def __init__(self, function: Any) -> None:
        for name in _NEEDED:
            getattr(_FunctionCache, name)
        _ = _Impl._locator_classes, rtsys.initialize
        before = numba.config.CACHE_DIR
        numba.config.CACHE_DIR = str(CACHE_FOLDER)
        try:
            super().__init__(function)
        finally:
            numba.config.CACHE_DIR = before
        _ = self._cache_file  # Numba's own, replaced below
        if not isinstance(self._impl.locator, _Locator):
            raise AttributeError("its cache has a place of its own")
        files = _Files(self.cache_path, self._impl.filename_base, self._impl.locator.get_source_stamp())
        self._cache_file: Any = files
        self._locks: dict[Path, CompileLock] = {}

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return a specialization from disk, or None if it has to be compiled: other processes then wait for this one.

        In that case the lock is kept until `save_overload`, or until the compiler fails (`_ReleaseAfterFailure`).
        """
        overload = self._load(sig, target_context)
        if overload is None:
            path = self._path(sig, target_context.codegen())
            lock = self._locks.setdefault(path, CompileLock(path))
            try:
                lock.acquire()
                overload = self._load(sig, target_context)
            except BaseException:
                self.release(path)
                raise
            if overload is not None:
                self.release(path)
        return overload

    def save_overload(self, sig: Any, data: Any) -> None:
        """Write a specialization; if that is impossible, continue without."""
        try:
            super().save_overload(sig, data)
        except OSError as problem:
            warn_once(f"Compiled kernels cannot be kept in {CACHE_FOLDER} ({problem.strerror or problem}); those that "
                      "are not there are compiled for this process only.")
        finally:
            self.release(self._path(sig, data.codegen))

    def release(self, path: Path) -> None:
        """Let other processes compile the specialization that is stored at `path`."""
        lock = self._locks.pop(path, None)
        if lock is not None:
            lock.release()

    def release_all(self) -> None:
        """Let other processes compile every specialization."""
        for path in list(self._locks):
            self.release(path)

    def _load(self, sig: Any, target_context: Any) -> Any:
        """Return a specialization from disk, or None.

        Numba would first load all types and functions known to its compiler, including SciPy's linear algebra, which
        takes half a second in every process. Code that is already compiled only needs the runtime.
        """
        try:
            rtsys.initialize(target_context)
            with self._guard_against_spurious_io_errors():
                return self._load_overload(sig, target_context)
        except OSError as problem:
            warn_once(f"Compiled kernels in {CACHE_FOLDER} cannot be read ({problem.strerror or problem}); they are "
                      "compiled for this process only.")
            return None

    def _path(self, sig: Any, codegen: Any) -> Path:
        """Return the path of a specialization, whether or not the file exists."""
        path: Path = self._cache_file.path(self._index_key(sig, codegen))
        return path


class _ReleaseAfterFailure(event.Listener):
    """Releases the locks of a function whose compilation has failed, through a typing error or an interruption.

    Nothing is saved in that case. Only one thread compiles at a time, so these are the locks of the failed
    specialization.
    """

    def on_start(self, event: Any) -> None:
        """Do nothing: the lock is already held."""

    def on_end(self, event: Any) -> None:
        """Release the locks unless the specialization is among the function's `overloads` by now and is saved next."""
        what = event.data or {}  # an event without a function does not concern our kernels
        function: Any = what.get("dispatcher")
        kept = getattr(function, "_cache", None)
        if isinstance(kept, KernelCache) and tuple(what["args"]) not in function.overloads:
            kept.release_all()


event.register("numba:compile", _ReleaseAfterFailure())


def keep_on_disk(compiled: Any) -> None:
    """Let a compiled function load its specializations from disk and save them there: `cache=True` with `KernelCache`.

    If this version of Numba lacks something that `KernelCache` needs, warn once and continue without.
    """
    if CACHE_FOLDER is None:
        return
    try:
        if _IMPORT_PROBLEM:
            raise AttributeError(_IMPORT_PROBLEM)
        _ = compiled._cache
        compiled._cache = KernelCache(compiled.py_func)
    except AttributeError as missing:
        warn_once(f"Compiled kernels cannot be kept with Numba {numba.__version__} ({missing}); they are compiled for "
                  "this process only.")
