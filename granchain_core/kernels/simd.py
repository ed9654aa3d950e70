"""A vector of eight doubles as a Numba type: explicit SIMD, one scene a lane.

LLVM turns it into one 512-bit register, two of 256 bits or four of 128, whatever the machine has. Arithmetic,
square root, maximum and comparison are single LLVM instructions with the same flags as the scalar kernels; a NaN
stays a NaN. `load` and `store` move one row of a C-ordered (rows, 8) array.
"""

from __future__ import annotations

import math
import operator

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import (
    intrinsic,
    lower_builtin,
    models,
    overload,
    register_model,
)

LANES = 8
_FLAGS = ("nsz", "arcp", "contract", "reassoc")
_VECTOR = ir.VectorType(ir.DoubleType(), LANES)


class VectorType(types.Type):
    """The Numba type of one vector."""

    def __init__(self) -> None:
        super().__init__(name=f"vector{LANES}")


vector = VectorType()


@register_model(VectorType)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type) -> None:
        super().__init__(dmm, fe_type, _VECTOR)


def _splat(builder, value):
    """All lanes the same."""
    one = builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(one, ir.Constant(_VECTOR, ir.Undefined), zeros)


def _as_vector(builder, kind, value):
    return value if isinstance(kind, VectorType) else _splat(builder, value)


def _binary(operation, instruction) -> None:
    cases = [signature(vector, vector, vector), signature(vector, vector, types.float64),
             signature(vector, types.float64, vector)]

    @infer_global(operation)
    class _Typing(ConcreteTemplate):
        pass

    _Typing.cases = cases
    for case in cases:

        @lower_builtin(operation, *case.args)
        def _lower(context, builder, sig, args):
            left, right = (_as_vector(builder, k, v) for k, v in zip(sig.args, args, strict=True))
            return getattr(builder, instruction)(left, right, flags=_FLAGS)


for _operation, _instruction in ((operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul"),
                                 (operator.truediv, "fdiv")):
    _binary(_operation, _instruction)


@intrinsic
def splat(typingctx, value):
    """A vector with `value` in all lanes."""

    def codegen(context, builder, sig, args):
        return _splat(builder, args[0])

    return vector(types.float64), codegen


def _row_pointer(context, builder, sig, args):
    """Pointer to row args[1] of a C-ordered (rows, LANES) array."""
    array = context.make_array(sig.args[0])(context, builder, args[0])
    offset = builder.mul(args[1], ir.Constant(args[1].type, LANES))
    return builder.bitcast(builder.gep(array.data, [offset]), _VECTOR.as_pointer())


@intrinsic
def load(typingctx, array, row):
    """Row `row` of a (rows, 8) array."""

    def codegen(context, builder, sig, args):
        return builder.load(_row_pointer(context, builder, sig, args), align=8)

    return vector(array, types.intp), codegen


@intrinsic
def store(typingctx, array, row, value):
    """Write a vector to row `row` of a (rows, 8) array."""

    def codegen(context, builder, sig, args):
        builder.store(args[2], _row_pointer(context, builder, sig, args), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, vector), codegen


def _neighbour(first: int):
    """An intrinsic that takes lanes first, first + 1, … of two registers laid side by side."""

    @intrinsic
    def shifted(typingctx, left, right):
        def codegen(context, builder, sig, args):
            mask = ir.Constant(ir.VectorType(ir.IntType(32), LANES), list(range(first, first + LANES)))
            return builder.shuffle_vector(args[0], args[1], mask)

        return vector(vector, vector), codegen

    return shifted


#: from_left(before, here): every lane's left neighbour; from_right(here, ahead): every lane's right neighbour.
from_left, from_right = _neighbour(LANES - 1), _neighbour(1)


@intrinsic
def with_first(typingctx, value, first):
    """The vector with another number in its first lane."""

    def codegen(context, builder, sig, args):
        return builder.insert_element(args[0], args[1], ir.Constant(ir.IntType(32), 0))

    return vector(vector, types.float64), codegen


@intrinsic
def positive_mask(typingctx, value):
    """One bit a lane: whether it is above zero."""

    def codegen(context, builder, sig, args):
        above = builder.fcmp_ordered(">", args[0], ir.Constant(_VECTOR, [0.0] * LANES))
        return builder.zext(builder.bitcast(above, ir.IntType(LANES)), ir.IntType(64))

    return types.int64(vector), codegen


@intrinsic
def _vector_root(typingctx, value):
    def codegen(context, builder, sig, args):
        function = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(_VECTOR, [_VECTOR]), f"llvm.sqrt.v{LANES}f64")
        return builder.call(function, args)

    return vector(vector), codegen


@intrinsic
def _vector_gate(typingctx, value, chosen):
    def codegen(context, builder, sig, args):
        zero = ir.Constant(_VECTOR, [0.0] * LANES)
        return builder.select(builder.fcmp_ordered("<=", args[0], zero), zero, args[1])

    return vector(vector, vector), codegen


@intrinsic
def _vector_larger(typingctx, a, b):
    def codegen(context, builder, sig, args):
        return builder.select(builder.fcmp_ordered(">", args[1], args[0]), args[1], args[0])

    return vector(vector, vector), codegen


@intrinsic
def _vector_peak(typingctx, a, b, c, d, e, top):
    def codegen(context, builder, sig, args):
        a, b, c, d, e, top = args
        near = builder.fmul(c, ir.Constant(_VECTOR, [NEAR] * LANES))
        far = builder.fmul(c, ir.Constant(_VECTOR, [FAR] * LANES))
        smooth = builder.and_(builder.fcmp_ordered(">", c, b), builder.fcmp_ordered(">=", c, d))
        for value, least in ((b, near), (d, near), (a, far), (e, far)):
            smooth = builder.and_(smooth, builder.fcmp_ordered(">", value, least))
        return builder.select(smooth, top, c)

    return vector(vector, vector, vector, vector, vector, vector), codegen


#: A maximum is smooth if its neighbours are above these parts of it: the jump of a dashpot force is no curved peak.
NEAR, FAR = 0.8, 0.4


def choose_peak(a, b, c, d, e, top):
    """`top` where c is a smooth maximum of five successive values, else c."""
    smooth = b < c >= d and b > NEAR * c and d > NEAR * c and a > FAR * c and e > FAR * c
    return top if smooth else c


@overload(choose_peak)
def _choose_peak(a, b, c, d, e, top):
    if isinstance(c, VectorType):
        return lambda a, b, c, d, e, top: _vector_peak(a, b, c, d, e, top)
    return lambda a, b, c, d, e, top: (
        top if b < c and c >= d and b > NEAR * c and d > NEAR * c and a > FAR * c and e > FAR * c else c)


def root(value):
    """Square root of a number or of every lane."""
    return math.sqrt(value)


@overload(root)
def _root(value):
    return (lambda value: _vector_root(value)) if isinstance(value, VectorType) else (lambda value: math.sqrt(value))


def gate(overlap, value):
    """0 where `overlap` ≤ 0, else `value`; written so that a NaN overlap passes `value` instead of hiding itself."""
    return 0.0 if overlap <= 0.0 else value


@overload(gate)
def _gate(overlap, value):
    if isinstance(overlap, VectorType):
        if isinstance(value, VectorType):
            return lambda overlap, value: _vector_gate(overlap, value)
        return lambda overlap, value: _vector_gate(overlap, splat(value))
    return lambda overlap, value: 0.0 if overlap <= 0.0 else value


def larger(a, b):
    """The larger of two numbers or of every lane; `a` where they cannot be compared."""
    return b if b > a else a


@overload(larger)
def _larger(a, b):
    if isinstance(a, VectorType):
        return lambda a, b: _vector_larger(a, b)
    return lambda a, b: b if b > a else a
