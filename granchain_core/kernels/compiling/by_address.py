"""Calls from one kernel to another by address, so that the callee is compiled once rather than in every caller.

Numba links every function that a kernel calls into that kernel, and optimises and translates it there again. This pays
for functions called at each step. It does not pay for a long one that is called rarely and is the same for every
structure.
"""

from __future__ import annotations

from typing import Any

from numba import types
from numba.extending import intrinsic

from .entry import specialization_for


def address_of(kernel: Any, *arguments: Any) -> int:
    """Return the address of a kernel's specialization for these argument types, compiling it first if necessary."""
    _, specialization = specialization_for(kernel, arguments)
    # Numba's "library" is the code of this one specialization
    return int(specialization.library.get_pointer_to_function(specialization.fndesc.llvm_func_name))


@intrinsic
def call_at(typing_context, address, arguments):
    """Call a kernel by an address from `address_of`, with exactly the same argument types; it returns a Boolean."""
    signature = types.boolean(address, arguments)

    def generate(context, builder, signature, values):
        where, packed = values
        kinds = tuple(signature.args[1])
        passed = [builder.extract_value(packed, i) for i in range(len(kinds))]
        function = context.call_conv.get_function_type(types.boolean, kinds)
        target = builder.inttoptr(where, function.as_pointer())
        status, result = context.call_conv.call_function(builder, target, types.boolean, kinds, passed)
        with builder.if_then(status.is_error, likely=False):  # an index out of bounds under NUMBA_BOUNDSCHECK
            context.call_conv.return_status_propagate(builder, status)
        return result

    return signature, generate
