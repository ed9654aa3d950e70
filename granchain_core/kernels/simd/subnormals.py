"""Treating subnormal numbers as zero: ahead of a wave, all numbers may be subnormal, which is slow.

`Engine.record` and `Engine.periods`, short chains and batches switch this on; the flow and `run_pieces` do not.
"""

from __future__ import annotations

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from ..batch_size import is_x86
from ..compiling.jit import brief_kernel

#: Bits of MXCSR, a control register of x86: flush results to zero (FTZ, 0x8000), treat arguments as zero (DAZ, 0x40).
_FLUSH = 0x8040
_IS_X86 = is_x86()


def _control_register(builder, name, pointer):
    kind = ir.FunctionType(ir.VoidType(), [ir.IntType(8).as_pointer()])
    function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.x86.sse.{name}mxcsr")
    builder.call(function, [builder.bitcast(pointer, ir.IntType(8).as_pointer())])


@intrinsic
def flush_subnormals(typingctx):
    """Treat subnormal numbers as zero, since arithmetic with them is a hundred times slower; return the old setting."""

    def codegen(context, builder, sig, args):
        if not _IS_X86:
            return ir.Constant(ir.IntType(32), 0)
        pointer = cgutils.alloca_once(builder, ir.IntType(32))
        _control_register(builder, "st", pointer)
        before = builder.load(pointer)
        builder.store(builder.or_(before, ir.Constant(ir.IntType(32), _FLUSH)), pointer)
        _control_register(builder, "ld", pointer)
        return before

    return types.int32(), codegen


@intrinsic
def restore_subnormals(typingctx, before):
    """Restore the setting that `flush_subnormals` returned."""

    def codegen(context, builder, sig, args):
        if _IS_X86:
            pointer = cgutils.alloca_once(builder, ir.IntType(32))
            builder.store(args[0], pointer)
            _control_register(builder, "ld", pointer)
        return context.get_dummy_value()

    return types.void(types.int32), codegen


@brief_kernel
def begin_flushing():
    """`flush_subnormals` for Python, in the calling thread."""
    return flush_subnormals()


@brief_kernel
def end_flushing(before):
    """`restore_subnormals` for Python."""
    restore_subnormals(before)
