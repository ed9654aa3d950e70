"""Parts of kernels are linked into their callers and not translated separately; everything works without this, too."""

from __future__ import annotations

from operator import attrgetter
from typing import Any

import numba
import pytest

from granchain_core.kernels.compiling import link_only
from granchain_core.kernels.compiling.jit import Internal
from granchain_core.kernels.compiling.link_only import compiler_options
from tools.numba_names import names_in

#: The code library that Numba keeps of a compiled function.
code_of = attrgetter("library")


class AnotherLibrary:
    """A class for compiled code, as in another Numba, without the attributes that link_only.py uses."""


#: The private names of Numba that link_only.py uses.
NAMES = sorted(name for name in names_in("kernels/compiling/link_only.py") if name.startswith("_"))


def sum_of_squares(options: dict[str, Any]) -> tuple[Any, Any]:
    """Return a kernel, and the part of it that is compiled with these options."""

    @Internal
    @numba.njit(error_model="numpy", **options)
    def square(x):
        return x * x

    @numba.njit
    def kernel(x, y):
        return square(x) + square(y)

    return kernel, square


@pytest.mark.parametrize("options", [compiler_options(), compiler_options(AnotherLibrary)], ids=["linked", "translated"])
def test_a_kernel_is_right_with_parts_of_either_kind(options: dict[str, Any]) -> None:
    kernel, square = sum_of_squares(options)
    assert kernel(3.0, 4.0) == 25.0
    assert kernel(3, 4) == 25
    assert square(5.0) == 25.0, "called from Python, it runs uncompiled"


def test_only_the_kernel_is_translated() -> None:
    assert "pipeline_class" in compiler_options(), "this version of Numba lacks attributes that link_only.py uses"
    kernel, square = sum_of_squares(compiler_options())
    kernel(3.0, 4.0)
    (whole,), (part,) = kernel.overloads.values(), square.dispatcher.overloads.values()
    name = part.fndesc.llvm_func_name
    assert code_of(whole).get_pointer_to_function(whole.fndesc.llvm_cpython_wrapper_name) != 0
    assert code_of(part).get_pointer_to_function(name) == 0
    assert name in code_of(part).get_llvm_str()


@pytest.mark.parametrize("name", [name for name in NAMES if name != "_codegen"])
def test_without_any_attribute_of_the_class_every_function_is_translated(name: str) -> None:
    held = [one for one in (*link_only._NEEDED, "get_pointer_to_function") if one != name]
    assert "pipeline_class" not in compiler_options(type("Library", (), dict.fromkeys(held)))
    assert "pipeline_class" in compiler_options(type("Library", (), dict.fromkeys([*held, name])))


def test_without_the_attribute_of_an_instance_every_function_is_translated(monkeypatch: pytest.MonkeyPatch) -> None:
    begin = link_only._LinkOnly.__init__

    def init(self: Any, *arguments: Any) -> None:
        begin(self, *arguments)
        del self._codegen

    monkeypatch.setattr(link_only._LinkOnly, "__init__", init)
    kernel, square = sum_of_squares(compiler_options())
    assert kernel(3.0, 4.0) == 25.0
    (part,) = square.dispatcher.overloads.values()
    assert code_of(part).get_pointer_to_function(part.fndesc.llvm_func_name) != 0


def test_where_numba_is_another_every_function_is_translated() -> None:
    assert "pipeline_class" not in compiler_options(AnotherLibrary)
    kernel, square = sum_of_squares(compiler_options(AnotherLibrary))
    kernel(3.0, 4.0)
    (part,) = square.dispatcher.overloads.values()
    assert code_of(part).get_pointer_to_function(part.fndesc.llvm_func_name) != 0
