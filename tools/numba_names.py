"""The undocumented names of Numba and LLVM that the kernels use; docs/compiling.md has them as two tables.

`python -m tools.update` writes the tables. `tests/kernels/compiling/test_numba_names.py` compares the names with the
installed Numba and with the code, and `tests/architecture/test_imports.py` finds private names that are missing.
"""

from __future__ import annotations

from app.library_internals import Internal

_EACH_PROCESS = "each process compiles its kernels, and one line says so"
_NO_KERNEL = "kernels do not compile"
_NO_VECTOR = "vectors do not compile"

#: By file of the core: the owners of the names, the names, and what is lost without them.
NUMBA: dict[str, tuple[Internal, ...]] = {
    "kernels/compiling/cache.py": (
        Internal("numba.core.caching.FunctionCache",
                 ("_load_overload", "_index_key", "_guard_against_spurious_io_errors", "_impl_class", "_impl",
                 "_cache_file", "cache_path"), _EACH_PROCESS),
        Internal("numba.core.caching.CompileResultCacheImpl",
                 ("_locator_classes", "locator", "filename_base"), _EACH_PROCESS),
        Internal("numba.core.caching.UserProvidedCacheLocator", ("_cache_path", "_py_file"), _EACH_PROCESS),
        Internal("numba.core.dispatcher.Dispatcher", ("_cache", "overloads"), _EACH_PROCESS),
        Internal("numba.core.runtime", ("rtsys",), _EACH_PROCESS),
        Internal("numba.core.serialize", ("dumps",), _EACH_PROCESS),
        Internal("numba.core.compiler.CompileResult", ("codegen",), _EACH_PROCESS),
    ),
    "kernels/compiling/link_only.py": (
        Internal("numba.core.codegen.JITCodeLibrary",
                 ("_finalize_final_module", "_finalize_dynamic_globals", "_verify_declare_only_symbols",
                 "_ensure_finalized", "_finalized", "_codegen"), "every function is translated, which takes a tenth longer"),
        Internal("numba.core.compiler.Compiler",
                 ("define_pipelines", "state"), "every function is translated, which takes a tenth longer"),
        Internal("numba.core.options.DefaultOptions", ("no_cpython_wrapper",), _NO_KERNEL),
        Internal("numba.core.codegen.CodeLibrary", ("codegen",), _NO_KERNEL),
        Internal("numba.core.compiler.Compiler", ("targetctx", "func_id", "state"), _NO_KERNEL),
        Internal("numba.core.bytecode.FunctionIdentity", ("func_qualname",), _NO_KERNEL),
    ),
    "kernels/compiling/jit.py": (
        Internal("numba.core.dispatcher.Dispatcher", ("_numba_type_",), _NO_KERNEL),
        Internal("numba.core.options.DefaultOptions", ("_nrt", "no_cfunc_wrapper", "forceinline"), _NO_KERNEL),
    ),
    "kernels/compiling/dispatch.py": (
        Internal("numba.core.dispatcher.Dispatcher", ("_numba_type_",), _NO_KERNEL),
        Internal("numba.core.types", ("BaseNamedTuple",), _NO_KERNEL),
        Internal("numba.core.types.NamedTuple", ("instance_class",), _NO_KERNEL),
    ),
    "kernels/compiling/function_types.py": (
        Internal("numba.core.types", ("Dispatcher", "Callable", "Dummy", "unliteral"), _NO_KERNEL),
        Internal("numba.core.types.Dispatcher", ("get_call_type", "get_call_signatures", "get_impl_key"), _NO_KERNEL),
        Internal("numba.core.dispatcher.Dispatcher", ("get_overload",), _NO_KERNEL),
        Internal("numba.core.datamodel.models", ("OpaqueModel",), _NO_KERNEL),
    ),
    "kernels/compiling/entry.py": (
        Internal("numba.core.dispatcher.Dispatcher", ("overloads", "compile", "typeof_pyval"), "no method runs"),
        Internal("numba.core.compiler.CompileResult", ("entry_point",), "no method runs"),
    ),
    "kernels/compiling/by_address.py": (
        Internal("numba.core.compiler.CompileResult", ("library", "fndesc"), "a batch cannot run"),
        Internal("numba.core.codegen.JITCodeLibrary", ("get_pointer_to_function",), "a batch cannot run"),
        Internal("numba.core.funcdesc.FunctionDescriptor", ("llvm_func_name",), "a batch cannot run"),
        Internal("numba.core.callconv.CPUCallConv",
                 ("get_function_type", "call_function", "return_status_propagate"), "a batch cannot run"),
    ),
    "kernels/batch_size.py": (
        Internal("numba.core.codegen", ("get_host_cpu_features",), "a batch has its smaller size"),
    ),
    "kernels/simd/vector.py": (
        Internal("numba.core.typing.templates", ("ConcreteTemplate", "infer_global", "signature"), _NO_VECTOR),
        Internal("numba.core.base.BaseContext", ("make_array", "get_dummy_value"), _NO_VECTOR),
    ),
    "kernels/simd/functions.py": (
        Internal("numba.core.cgutils", ("get_or_insert_function",), _NO_VECTOR),
    ),
    "kernels/simd/sums.py": (
        Internal("numba.core.cgutils", ("get_or_insert_function",), _NO_VECTOR),
        Internal("numba.core.base.BaseContext", ("make_array",), _NO_VECTOR),
    ),
    "kernels/simd/subnormals.py": (
        Internal("numba.core.cgutils",
                 ("get_or_insert_function", "alloca_once"), "no engine runs, whatever its method"),
        Internal("numba.core.base.BaseContext", ("get_dummy_value",), "no engine runs, whatever its method"),
    ),
}

#: LLVM's intrinsics: the name, with widths and instruction names in braces as in the source, what for, and the file.
LLVM: tuple[tuple[str, str, str], ...] = (
    ("llvm.sqrt.v{kind.count}f64", "the square root of every lane",
     "kernels/simd/functions.py"),
    ("llvm.fabs.v{kind.count}f64", "the absolute value of every lane",
     "kernels/simd/functions.py"),
    ("llvm.x86.avx512.rsqrt14.pd.512", "eight inverse roots to 14 bits; with AVX-512 only",
     "kernels/simd/functions.py"),
    ("llvm.x86.sse.rsqrt.ps", "four inverse roots to 11 bits, in floats; on x86 only",
     "kernels/simd/functions.py"),
    ("llvm.vector.reduce.fadd.v{kind.count}f64", "the sum of all lanes",
     "kernels/simd/sums.py"),
    ("llvm.x86.sse.{name}mxcsr", "reads and writes x86's floating-point control register, to flush subnormal numbers",
     "kernels/simd/subnormals.py"),
)


def names_in(file: str) -> set[str]:
    """Return the names of Numba that a file of the core uses."""
    return {name for row in NUMBA[file] for name in row.names}


def table_of_numba_names() -> str:
    """Return the table of docs/compiling.md: the undocumented names of Numba, and where they are used."""
    rows = []
    for file, table in NUMBA.items():
        for without in dict.fromkeys(row.without for row in table):
            used = "<br>".join(f"`{row.owner}`: {', '.join(f'`{name}`' for name in row.names)}" for row in table
                               if row.without == without)
            rows.append(f"| {used} | `{file}` | {without} |")
    return "\n".join(["| what | where | without it |", "|---|---|---|", *rows])


def table_of_intrinsics() -> str:
    """Return the table of docs/compiling.md: the intrinsics of LLVM that are called by name."""
    rows = [f"| `{name}` | {purpose} | `{file}` |" for name, purpose, file in LLVM]
    return "\n".join(["| intrinsic | what for | where |", "|---|---|---|", *rows])
