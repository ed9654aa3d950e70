"""The one place that decides how kernels are compiled and where the compiled code is kept.

* `nogil`, so that a pool of threads really runs kernels side by side.
* No `nnan`/`ninf`: a NaN must stay visible. Only `nsz arcp contract reassoc`, which let an absent effect's
  neutral elements fold away and sums be vectorised.
* Numba does not notice edits in *imported* kernels, so the cache folder is named by a hash of all sources in
  this package and of the kind of processor: any edit starts an empty cache, an unchanged tree compiles nothing in
  the second process.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from pathlib import Path
from typing import Any

import llvmlite.binding
import numba
from numba import types
from numba.extending import overload

#: Kernels allocate nothing, so arrays in them are not counted: that is less code to compile and to run.
_OPTIONS: Any = {"fastmath": {"nsz", "arcp", "contract", "reassoc"}, "error_model": "numpy", "_nrt": False}


def _sources_hash() -> str:
    digest = hashlib.sha256(f"{numba.__version__} {llvmlite.binding.get_host_cpu_name()}".encode())
    for path in sorted(Path(__file__).parent.rglob("*.py")):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def cache_folder() -> Path:
    """Folder of the compiled kernels: $GRANCHAIN_CACHE, else the user's cache, else a temporary one."""
    chosen = os.environ.get("GRANCHAIN_CACHE")
    base = Path(chosen) if chosen else Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "granchain"
    folder = base / f"kernels-{_sources_hash()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError:
        folder = Path(tempfile.gettempdir()) / f"granchain-{os.getuid()}" / folder.name
        folder.mkdir(parents=True, exist_ok=True)
        return folder


CACHE_FOLDER = cache_folder()


def inline_llvm(function):
    """Decorator for what belongs into its caller's code: values that stay in registers."""
    return numba.njit(nogil=True, forceinline=True, **_OPTIONS)(function)


def kernel(function):
    """Decorator for compiled, cached kernels on floats and arrays."""
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(CACHE_FOLDER)
    try:
        return numba.njit(cache=True, nogil=True, **_OPTIONS)(function)
    finally:
        numba.config.CACHE_DIR = before


def inline_numba(function):
    """Decorator for a kernel called at one place: it becomes part of that code, and is not compiled for itself as well.

    Compiled code is linked and optimised again in every caller, up to the kernel that Python calls; of a step of the
    certified method this saves a fifth of the compiler's time.
    """
    return numba.njit(nogil=True, inline="always", **_OPTIONS)(function)


def by_slot(absent, forceinline=False):
    """A function whose code depends on which effect stands in its first argument, decided when it is typed.

    The decorated function is the code for an absent effect (slot None). `function.of(Slot)` registers the code
    for slots of the NamedTuple class `Slot`. An absent effect leaves no code behind, in no caller.
    """
    implementations = {type(None): absent}

    def generic(*args):
        return implementations[type(args[0])](*args)

    generic.__name__ = generic.__qualname__ = absent.__name__
    generic.__doc__ = absent.__doc__

    @overload(generic, strict=False, jit_options=_OPTIONS | {"forceinline": forceinline})
    def _typed(*args):
        slot = args[0]
        found = slot.instance_class if isinstance(slot, types.BaseNamedTuple) else type(None)
        return implementations[found]

    def of(slot_class):
        def register(implementation):
            implementations[slot_class] = implementation
            return implementation

        return register

    def absent_for(*slot_classes):
        """Let slots of these classes be as good as absent to this function."""
        implementations.update(dict.fromkeys(slot_classes, absent))

    generic.of, generic.absent_for = of, absent_for
    return generic


def by_slot_inlined(absent):
    """A term that becomes part of its caller's code: for one that takes many arguments and is called at each step."""
    return by_slot(absent, forceinline=True)
