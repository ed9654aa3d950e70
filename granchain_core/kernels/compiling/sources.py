"""Hashes of the kernels' sources, by which compiled code is found again (cache.py).

Comments, docstrings and line breaks change no instruction, so compiled code is named by a hash of the parsed sources.
Parsing takes a fifth of a second, so the bytes of the sources are hashed as well, which takes hardly any time.
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

#: Sources that decide where compiled code is stored and how it is called but do not change it.
_NOT_IN_CODE = tuple(f"compiling/{name}.py" for name in ("cache", "cache_folder", "compile_lock", "entry", "sources"))
#: Settings of Numba (environment variables with NUMBA_ before them) that change machine code: optimisation level,
#: bounds checks, debug information, vectorisers, AVX, Intel's vector functions, the processor's features.
_SETTINGS = ("OPT", "BOUNDSCHECK", "DEBUGINFO_DEFAULT", "SLP_VECTORIZE", "LOOP_VECTORIZE", "ENABLE_AVX",
             "DISABLE_INTEL_SVML", "CPU_FEATURES")
#: The folder of the kernels. One outside it (hard_cases/touches.py) is kept under its own module's code too (cache.py).
FOLDER = Path(__file__).parents[1]


def sources_hash(folder: Path = FOLDER) -> str:
    """Hash of everything that determines the kernels' machine code.

    That is their parsed sources except `_NOT_IN_CODE`, the versions of Numba and llvmlite, the processor, the batch's
    size, and those settings of Numba that change the code (`_SETTINGS`).
    """
    return _hash_of_all(folder, hash_of_code)


def source_bytes_hash(folder: Path = FOLDER) -> str:
    """Hash of the same, with the bytes of the sources in place of what they parse to."""
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
    """Hash of a source file without its comments, docstrings and layout; of its bytes if it cannot be parsed."""
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
    """Hash of a function's names and constants, which tell functions of the same name in one file apart.

    Numba tells them apart by their lines, which a longer comment above them changes.
    """
    return hashlib.sha256(_constants(function.__code__, function.__doc__).encode()).hexdigest()[:12]


def _constants(code: CodeType, docstring: str | None) -> str:
    constants = [_constants(constant, None) if isinstance(constant, CodeType) else repr(constant)
                 for constant in code.co_consts if constant is not docstring or constant is None]
    return repr((code.co_names, constants))
