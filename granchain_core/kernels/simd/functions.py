"""Roots, absolute value, gate, maximum and peak choice for a number or for every lane of a vector.

A root is computed in one of two ways: by the square-root instruction, which runs on the divider, or from an approximate
inverse root and some terms of the binomial series, which run on the multiply–add units. The approximation is
`vrsqrt14pd` for eight doubles on processors with AVX-512, and `rsqrtps` for four on any x86. With AVX-512, the second
way has more than twice the throughput (1.8 ns instead of 4.4 ns for eight roots). Used together, the two keep both
units busy. The series serves one or two of three roots in a batch (batch/step.py), and every second register of a short
chain (`chain_root`).
"""

from __future__ import annotations

import math

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from ..batch_size import BATCH_SIZE, has_avx512, is_x86
from ..compiling.jit import FAST_MATH
from .vector import VectorType, as_vector

#: Whether the processor has `vrsqrt14pd` for eight doubles, and whether it has `rsqrtps` for four floats.
_HAS_RSQRT14, _HAS_RSQRT_PS = has_avx512(), is_x86()
#: Smallest number whose root is computed; smaller ones are replaced by it. Its power 3/2, the force of such an overlap,
#: is negligible. Where `rsqrtps` is used, it must not underflow to zero in single precision.
_LEAST_ARGUMENT_OF_EIGHT = 1e-280
_LEAST_ARGUMENT = _LEAST_ARGUMENT_OF_EIGHT if BATCH_SIZE == 8 else 1e-30
#: A maximum is smooth if both of its neighbours are above this part of it; the jump of a dashpot force is not.
NEIGHBOUR_PART = 0.8
#: The same for the two values beyond the neighbours. They must not exceed the maximum either, since the quartic through
#: a dip of one step may rise to many times the values.
SECOND_NEIGHBOUR_PART = 0.4


def _llvm_root(builder, kind, value):
    function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(kind, [kind]),
                                              f"llvm.sqrt.v{kind.count}f64")
    return builder.call(function, [value])


def _with_series(builder, value, inverse, coefficients):
    """√x of lanes above zero from an approximate inverse root y: t = x·y, e = 1 − t·y, √x = t (1 + e/2 + 3e²/8 + …).

    `coefficients` are those of e, e², … in the parenthesis.
    """
    kind = value.type

    def constant(number):
        return ir.Constant(kind, [number] * kind.count)

    def times_plus(a, b, c):
        return builder.fadd(builder.fmul(a, b, flags=FAST_MATH), c, flags=FAST_MATH)

    t = builder.fmul(value, inverse, flags=FAST_MATH)
    e = builder.fsub(constant(1.0), builder.fmul(t, inverse, flags=FAST_MATH), flags=FAST_MATH)
    series = constant(coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        series = times_plus(e, series, constant(coefficient))
    return times_plus(builder.fmul(t, e, flags=FAST_MATH), series, t)


def _root_of_eight(builder, value, coefficients=(0.5, 0.375)):
    """√x from the 14 bits of `vrsqrt14pd`: |e| ≤ 2^{−13}, so the first omitted term, 5e³/16, is below 6e-13."""
    kind = value.type
    function = cgutils.get_or_insert_function(
        builder.module, ir.FunctionType(kind, [kind, kind, ir.IntType(8)]), "llvm.x86.avx512.rsqrt14.pd.512")
    zero = ir.Constant(kind, [0.0] * kind.count)
    inverse = builder.call(function, [value, zero, ir.Constant(ir.IntType(8), -1)])
    return _with_series(builder, value, inverse, coefficients)


def _full_root_of_eight(builder, value):
    """A root of any number that is not negative, to rounding: the first omitted term, 35e⁴/128, is below 7e-17."""
    least = ir.Constant(value.type, [_LEAST_ARGUMENT_OF_EIGHT] * value.type.count)
    value = builder.select(builder.fcmp_ordered("<", value, least), least, value)
    return _root_of_eight(builder, value, (0.5, 0.375, 0.3125))


def _root_of_four(builder, value):
    """√x from the 11 bits of `rsqrtps`: |e| ≤ 2^{−10.4}, so the first omitted term, 35e⁴/128, is below 1e-13.

    Above 3e38, the largest float, the root is NaN, so that an overflow is not hidden.
    """
    kind, floats = value.type, ir.VectorType(ir.FloatType(), value.type.count)
    function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(floats, [floats]),
                                              "llvm.x86.sse.rsqrt.ps")
    inverse = builder.fpext(builder.call(function, [builder.fptrunc(value, floats)]), kind)
    is_finite = builder.fcmp_ordered(">", inverse, ir.Constant(kind, [0.0] * kind.count))
    inverse = builder.select(is_finite, inverse, ir.Constant(kind, [float("nan")] * kind.count))
    return _with_series(builder, value, inverse, (0.5, 0.375, 0.3125))


@intrinsic
def _vector_root(typingctx, value):
    def codegen(context, builder, sig, args):
        return _llvm_root(builder, sig.args[0].ir, args[0])

    return value(value), codegen


@intrinsic
def root_by_series(typingctx, value):
    """√ of every lane, all above zero; avoids the divider if the processor has an approximate inverse root."""

    def codegen(context, builder, sig, args):
        width = sig.return_type.width
        if width == 8 and _HAS_RSQRT14:
            return _root_of_eight(builder, args[0])
        if width == 4 and _HAS_RSQRT_PS:
            return _root_of_four(builder, args[0])
        return _llvm_root(builder, sig.args[0].ir, args[0])

    return value(value), codegen


@intrinsic
def chain_root(typingctx, value):
    """√ of every lane, none below zero, to rounding; lanes below 1e-280 may have its root.

    Where the vector has several registers of eight, every second one takes its roots from the series: the divider would
    finish them only after those of the first.
    """

    def codegen(context, builder, sig, args):
        width = sig.return_type.width
        if width <= 8 or not _HAS_RSQRT14:
            return _llvm_root(builder, sig.args[0].ir, args[0])
        nothing, parts = ir.Constant(args[0].type, ir.Undefined), []
        for first in range(0, width, 8):
            lanes = ir.Constant(ir.VectorType(ir.IntType(32), 8), list(range(first, first + 8)))
            part = builder.shuffle_vector(args[0], nothing, lanes)
            by_divider = first % 16 == 0
            parts.append(_llvm_root(builder, part.type, part) if by_divider else _full_root_of_eight(builder, part))
        while len(parts) > 1:
            count = 2 * parts[0].type.count
            lanes = ir.Constant(ir.VectorType(ir.IntType(32), count), list(range(count)))
            parts = [builder.shuffle_vector(*pair, lanes) for pair in zip(parts[::2], parts[1::2], strict=True)]
        return parts[0]

    return value(value), codegen


@intrinsic
def inverse_sixteenth_root(typingctx, value):
    """value^{−1/16} of a positive number to about 4 %, from its bits as an approximate logarithm.

    With order 8, the step size changes as error^{−1/8}, which is (error²)^{−1/16}; 4 % of a step size does no harm.
    """

    def codegen(context, builder, sig, args):
        bits = ir.IntType(64)
        part = builder.ashr(builder.bitcast(args[0], bits), ir.Constant(bits, 4))
        one = 1023 << 52
        return builder.bitcast(builder.sub(ir.Constant(bits, one + one // 16 - (1 << 47)), part), ir.DoubleType())

    return types.float64(types.float64), codegen


@intrinsic
def at_least_tiny(typingctx, value):
    """The vector with every lane raised to `_LEAST_ARGUMENT`; a NaN stays a NaN."""

    def codegen(context, builder, sig, args):
        least = ir.Constant(args[0].type, [_LEAST_ARGUMENT] * args[0].type.count)
        return builder.select(builder.fcmp_ordered("<", args[0], least), least, args[0])

    return value(value), codegen


@intrinsic
def _vector_gate(typingctx, value, chosen):
    def codegen(context, builder, sig, args):
        kind = sig.args[0].ir
        zero = ir.Constant(kind, [0.0] * kind.count)
        chosen = as_vector(builder, sig.args[0], sig.args[1], args[1])
        return builder.select(builder.fcmp_ordered("<=", args[0], zero), zero, chosen)

    return value(value, chosen), codegen


@intrinsic
def _vector_larger(typingctx, a, b):
    def codegen(context, builder, sig, args):
        return builder.select(builder.fcmp_ordered(">", args[1], args[0]), args[1], args[0])

    return a(a, a), codegen


@intrinsic
def _vector_peak(typingctx, a, b, c, d, e, top):
    def codegen(context, builder, sig, args):
        a, b, c, d, e, top = args
        kind = sig.return_type.ir
        near = builder.fmul(c, ir.Constant(kind, [NEIGHBOUR_PART] * kind.count))
        far = builder.fmul(c, ir.Constant(kind, [SECOND_NEIGHBOUR_PART] * kind.count))
        smooth = builder.and_(builder.fcmp_ordered(">", c, b), builder.fcmp_ordered(">=", c, d))
        for value, least in ((b, near), (d, near), (a, far), (e, far)):
            smooth = builder.and_(smooth, builder.fcmp_ordered(">", value, least))
        for value in (a, e):
            smooth = builder.and_(smooth, builder.fcmp_ordered("<=", value, c))
        return builder.select(smooth, top, c)

    return c(c, c, c, c, c, c), codegen


def choose_peak(a, b, c, d, e, top):
    """`top` where c is a smooth maximum of five successive values, otherwise c."""
    largest = b < c >= d and a <= c >= e
    near, far = NEIGHBOUR_PART * c, SECOND_NEIGHBOUR_PART * c
    smooth = b > near and d > near and a > far and e > far
    return top if largest and smooth else c


@overload(choose_peak)
def _choose_peak(a, b, c, d, e, top):
    if isinstance(c, VectorType):
        return lambda a, b, c, d, e, top: _vector_peak(a, b, c, d, e, top)
    return choose_peak


def root(value):
    """Square root of a number or of every lane."""
    return math.sqrt(value)


@overload(root)
def _root(value):
    return (lambda value: _vector_root(value)) if isinstance(value, VectorType) else root


@intrinsic
def _vector_abs(typingctx, value):
    def codegen(context, builder, sig, args):
        kind = sig.args[0].ir
        function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(kind, [kind]),
                                                  f"llvm.fabs.v{kind.count}f64")
        return builder.call(function, [args[0]])

    return value(value), codegen


@overload(abs)
def _abs(value):
    if isinstance(value, VectorType):
        return lambda value: _vector_abs(value)
    return None  # Numba has its own for numbers


@intrinsic
def _vector_positive_part(typingctx, value):
    def codegen(context, builder, sig, args):
        zero = ir.Constant(args[0].type, [0.0] * args[0].type.count)
        return builder.select(builder.fcmp_ordered("<", args[0], zero), zero, args[0])

    return value(value), codegen


def positive_part(value):
    """[x]_+, 0 where x < 0; a NaN stays a NaN, so a NaN overlap opens no contact. A single instruction for vectors."""
    return 0.0 if value < 0.0 else value


@overload(positive_part)
def _positive_part(value):
    if isinstance(value, VectorType):
        return lambda value: _vector_positive_part(value)
    return positive_part


def gate(overlap, value):
    """0 where `overlap` ≤ 0, otherwise `value`; a NaN overlap passes `value`, so that a failure is not hidden."""
    return 0.0 if overlap <= 0.0 else value


@overload(gate)
def _gate(overlap, value):
    if isinstance(overlap, VectorType):
        return lambda overlap, value: _vector_gate(overlap, value)
    return gate


def larger(a, b):
    """The larger of two numbers, or of two vectors lane by lane; `a` where they cannot be compared."""
    return b if b > a else a


@overload(larger)
def _larger(a, b):
    if isinstance(a, VectorType):
        return lambda a, b: _vector_larger(a, b)
    return larger
