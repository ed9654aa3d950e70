"""Hashes of the kernels' sources, by which compiled code is found (cache.py).

Comments, docstrings and line breaks do not change the compiled code, so it is named by a hash of the parsed sources.
Parsing takes a fifth of a second. So the bytes of the sources are hashed too, which takes hardly any time, and sources
with a known hash are not parsed.
"""

from __future__ import annotations

import ast
import contextlib
import hashlib
from collections.abc import Callable
from pathlib import Path
from types import CodeType, FunctionType

import llvmlite
import numba

from ..batch_size import BATCH_SIZE, processor

#: Sources that determine where compiled code is stored and how it is called, but do not change the code.
_NOT_IN_CODE = tuple(f"compiling/{name}.py" for name in ("cache", "cache_folder", "compile_lock", "entry", "sources"))
#: Settings of Numba (environment variables with the prefix NUMBA_) that change machine code: optimisation level, bounds
#: checks, debug information, vectorisers, AVX, Intel's vector functions, the processor's features.
_SETTINGS = ("OPT", "BOUNDSCHECK", "DEBUGINFO_DEFAULT", "SLP_VECTORIZE", "LOOP_VECTORIZE", "ENABLE_AVX",
             "DISABLE_INTEL_SVML", "CPU_FEATURES")
#: The folder of the kernels' sources. For a kernel outside it (hard_cases/touches.py), the cache key also contains a
#: hash of its own module (cache.py).
FOLDER = Path(__file__).parents[1]


def sources_hash(folder: Path = FOLDER) -> str:
    """Return a hash of everything that determines the kernels' machine code.

    This is their parsed sources except `_NOT_IN_CODE`, the versions of Numba and llvmlite, the processor, the batch
    size, and the settings of Numba that change the code (`_SETTINGS`).
    """
    return _hash_of_all(folder, hash_of_code)


def source_bytes_hash(folder: Path = FOLDER) -> str:
    """Return a hash of the same, with the bytes of the sources instead of their parsed code."""
    return _hash_of_all(folder, _hash_of_bytes)


def _hash_of_all(folder: Path, hash_of: Callable[[Path], str]) -> str:
    settings = [getattr(numba.config, name) for name in _SETTINGS]
    compiler = f"{numba.__version__} {llvmlite.__version__} {settings!r}"
    digest = hashlib.sha256(f"{compiler} {processor()} {BATCH_SIZE}".encode())
    for path in sorted(folder.rglob("*.py")):
        name = path.relative_to(folder).as_posix()
        if name not in _NOT_IN_CODE:
            digest.update(f"{name} {hash_of(path)}\n".encode())
    return digest.hexdigest()[:12]


def _hash_of_bytes(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def hash_of_code(path: Path) -> str:
    """Return a hash of a source file without comments, docstrings and layout; of its bytes if it cannot be parsed."""
    content = path.read_bytes()
    with contextlib.suppress(SyntaxError, ValueError, RecursionError):
        tree = ast.parse(content)
        for node in ast.walk(tree):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
                _drop_docstring(node)
        content = ast.dump(tree).encode()
    return hashlib.sha256(content).hexdigest()


def _drop_docstring(node: ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) -> None:
    if ast.get_docstring(node, clean=False) is not None:
        del node.body[0]


def constants_hash(function: FunctionType) -> str:
    """Return a hash of a function's names and constants, which distinguishes functions of the same name in one file.

    Numba distinguishes them by line number, which a longer comment above them would change.
    """
    return hashlib.sha256(_constants(function.__code__, function.__doc__).encode()).hexdigest()[:12]


def _constants(code: CodeType, docstring: str | None) -> str:
    constants = [_constants(constant, None) if isinstance(constant, CodeType) else repr(constant)
                 for constant in code.co_consts if constant is not docstring or constant is None]
    return repr((code.co_names, constants))
