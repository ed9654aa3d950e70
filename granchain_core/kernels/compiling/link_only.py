"""A Numba compiler for functions that only other compiled functions call.

Numba makes machine code of every function it compiles. The machine code of a part of a kernel is never run: the kernel
that Python calls is linked with the part's LLVM code, optimised and translated as a whole. This compiler leaves the
part as LLVM code, which saves a tenth of the time to compile a structure and half of the space on disk. Such a function
has no address: `Internal` in jit.py keeps Python from calling it.

Numba names no interface for this. Where its library class is not what is expected here, `compiler_options` leaves the
compiler out and every function is translated, as Numba does by itself.
"""

from __future__ import annotations

from typing import Any

from numba.core import codegen, compiler

#: What is used of Numba's class for a compiled function's code, beyond its documentation.
_NEEDED = ("_finalize_final_module", "_finalize_dynamic_globals", "_verify_declare_only_symbols", "_ensure_finalized",
           "_finalized", "codegen")


class _NoAddresses:
    """Numba's code generator, but for the address of a function's environment: what has no machine code has none."""

    def __init__(self, generator: Any) -> None:
        self._generator = generator

    def __getattr__(self, name: str) -> Any:
        return getattr(self._generator, name)

    def set_env(self, name: str, env: Any) -> None:
        """Nothing: such a function holds no Python objects; what it may raise needs none either."""


#: Numba's class for it; where there is none, nothing below is used.
_LIBRARY: Any = getattr(codegen, "JITCodeLibrary", object)


class _LinkOnly(_LIBRARY):
    """The LLVM code of one function and of what it calls, optimised, to be linked into callers."""

    @property
    def codegen(self) -> Any:
        return _NoAddresses(self._codegen)

    def _finalize_final_module(self) -> None:
        """Declare the code complete without translating it."""
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """No address."""
        self._ensure_finalized()
        return 0


class _LinkOnlyCompiler(compiler.Compiler):
    """Numba's compiler with such a library."""

    def define_pipelines(self) -> Any:
        state = self.state
        library = _LinkOnly(state.targetctx.codegen(), state.func_id.func_qualname)
        if hasattr(library, "_codegen"):  # which only an instance has
            state["library"] = library
        return super().define_pipelines()


def compiler_options(library: type = _LIBRARY) -> dict[str, Any]:
    """Options of `numba.njit` for a function that only kernels call: the compiler too, where `library` fits."""
    options: dict[str, Any] = {"no_cpython_wrapper": True}
    if all(hasattr(library, name) for name in _NEEDED) and hasattr(compiler.Compiler, "define_pipelines"):
        options["pipeline_class"] = _LinkOnlyCompiler
    return options
