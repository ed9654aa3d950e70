"""Numba types of the functions that kernels call: how a call finds the one specialization it shares with others.

By itself Numba compiles a function again for each number that is written out in a call, and a function made by
`overload` again for each set of options of its callers. Here a call asks for a version by the types of its arguments
alone, which saves a sixth of the versions and of the compiler's time.
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
        """The signature of a call; compiles the function for it, or finds that version."""
        return super().get_call_type(context, *_without_literals(args, kws))


class ChoiceType(types.Callable, types.Dummy):
    """The type of a function whose code is chosen by the type of its first argument.

    `choose` returns the compiled function for the type of a first argument; TypeError where there is none.
    """

    def __init__(self, name: str, choose: Callable[[Any], Any]) -> None:
        self._choose = choose
        self._versions: dict[Any, Any] = {}
        super().__init__(f"choice({name})")

    @property
    def key(self) -> Any:
        """Types are compared by this: there is one for each such function."""
        return id(self._choose)

    def get_call_type(self, context: Any, args: Any, kws: Any) -> Any:
        """The signature of a call; compiles the chosen function for it, or finds that version."""
        dispatcher = self._choose(args[0])
        signature: Any = types.Dispatcher(dispatcher).get_call_type(context, *_without_literals(args, kws))
        self._versions[signature.args] = dispatcher.get_overload(signature.args)
        return signature

    def get_call_signatures(self) -> Any:
        """The signatures of the calls so far, for error messages."""
        return list(self._versions), True

    def get_impl_key(self, sig: Any) -> Any:
        """The version that a call with this signature runs."""
        return self._versions[sig.args]


register_model(FunctionType)(models.OpaqueModel)
register_model(ChoiceType)(models.OpaqueModel)


def _without_literals(args: Any, kws: Any) -> Any:
    """The arguments' types without the values of numbers that are written out."""
    return tuple(types.unliteral(each) for each in args), {name: types.unliteral(each) for name, each in kws.items()}
