"""A Numba compiler for functions that only other compiled functions call.

Numba generates machine code for every function it compiles. For a part of a kernel that machine code never runs: the
kernel that Python calls is linked with the part's LLVM code, then optimised and translated as a whole. This compiler
leaves the part as LLVM code, which saves a tenth of the time to compile a structure and half of the disk space. Such a
function has no address: `Internal` in jit.py keeps Python from calling it.

Numba documents no interface for this. If its library class is not as expected here, `compiler_options` leaves this
compiler out, and every function is translated, as is Numba's default.
"""

from __future__ import annotations

from typing import Any

from numba.core import codegen, compiler

#: Undocumented attributes used here of Numba's class for a compiled function's code.
_NEEDED = ("_finalize_final_module", "_finalize_dynamic_globals", "_verify_declare_only_symbols", "_ensure_finalized",
           "_finalized", "codegen")


class _NoAddresses:
    """Numba's code generator, except that it sets no environment address: without machine code there is none."""

    def __init__(self, generator: Any) -> None:
        self._generator = generator

    def __getattr__(self, name: str) -> Any:
        return getattr(self._generator, name)

    def set_env(self, name: str, env: Any) -> None:
        """Do nothing: such a function refers to no Python objects, and the errors it may raise need none either."""


#: Numba's library class; if it is missing, nothing below is used.
_LIBRARY: Any = getattr(codegen, "JITCodeLibrary", object)


class _LinkOnly(_LIBRARY):
    """The optimised LLVM code of one function and of the functions it calls, to be linked into callers."""

    @property
    def codegen(self) -> Any:
        return _NoAddresses(self._codegen)

    def _finalize_final_module(self) -> None:
        """Mark the code as complete without translating it."""
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0: there is no address."""
        self._ensure_finalized()
        return 0


class _LinkOnlyCompiler(compiler.Compiler):
    """Numba's compiler with a `_LinkOnly` library."""

    def define_pipelines(self) -> Any:
        state = self.state
        library = _LinkOnly(state.targetctx.codegen(), state.func_id.func_qualname)
        if hasattr(library, "_codegen"):  # an attribute of instances only
            state["library"] = library
        return super().define_pipelines()


def compiler_options(library: type = _LIBRARY) -> dict[str, Any]:
    """Return `numba.njit` options for a function that only kernels call, with this compiler if `library` fits."""
    options: dict[str, Any] = {"no_cpython_wrapper": True}
    if all(hasattr(library, name) for name in _NEEDED) and hasattr(compiler.Compiler, "define_pipelines"):
        options["pipeline_class"] = _LinkOnlyCompiler
    return options
