"""Fixed-weight sums over rows of an array, sums and maxima over the lanes of a vector, and single lanes."""

from __future__ import annotations

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from ..compiling.jit import FAST_MATH, inline_llvm
from .vector import require_rows


def weighted_rows(weights, latest=-1):
    """Make an intrinsic (vector, array) for Σ weights[s] · row s of an array whose rows are as wide as the vector.

    The vector is row `latest`, which is then not read back from memory; with −1, only its type matters. Rows of weight
    zero are not read either.
    """
    terms = [(s, float(weight)) for s, weight in enumerate(weights) if weight != 0.0]
    terms.sort(key=lambda term: term[0] == latest)  # the newest row last, so that the others need not wait for it

    @intrinsic
    def total(typingctx, vector, array):
        require_rows(array)

        def codegen(context, builder, sig, args):
            kind, sum_ = sig.return_type.ir, None
            rows = builder.bitcast(context.make_array(sig.args[1])(context, builder, args[1]).data, kind.as_pointer())
            for s, weight in terms:
                row = args[0] if s == latest else builder.load(
                    builder.gep(rows, [ir.Constant(ir.IntType(64), s)]), align=8)
                part = builder.fmul(row, ir.Constant(kind, [weight] * kind.count), flags=FAST_MATH)
                sum_ = part if sum_ is None else builder.fadd(sum_, part, flags=FAST_MATH)
            return sum_

        return vector(vector, array), codegen

    return total


def moved_by_rows(weights, latest):
    """Make a function (start, vector, array) for start + Σ weights[s] · row s, where `vector` is row `latest`.

    This newest row is added last, so that the rest need not wait for it.
    """
    earlier, weight = weighted_rows([*weights[:latest], 0.0, *weights[latest + 1 :]]), float(weights[latest])

    @inline_llvm
    def moved(start, vector, array):
        return (start + earlier(start, array)) + weight * vector

    @inline_llvm
    def moved_by_one(start, vector, array):
        return start + weight * vector

    return moved if any(weights[:latest]) else moved_by_one


@intrinsic
def sum_of(typingctx, value):
    """The sum of all lanes."""

    def codegen(context, builder, sig, args):
        kind = sig.args[0].ir
        function = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(ir.DoubleType(), [ir.DoubleType(), kind]),
            f"llvm.vector.reduce.fadd.v{kind.count}f64")
        return builder.call(function, [ir.Constant(ir.DoubleType(), 0.0), args[0]], fastmath=FAST_MATH)

    return types.float64(value), codegen


@intrinsic
def largest_of(typingctx, value):
    """The largest lane, where none is NaN.

    The vector is halved repeatedly. LLVM's own maximum over all lanes filters out NaNs, which takes three times as
    long.
    """

    def codegen(context, builder, sig, args):
        left = args[0]
        while left.type.count > 1:
            half = left.type.count // 2
            one, other = (builder.shuffle_vector(left, ir.Constant(left.type, ir.Undefined), ir.Constant(
                ir.VectorType(ir.IntType(32), half), list(range(first, first + half)))) for first in (0, half))
            left = builder.select(builder.fcmp_ordered(">", one, other), one, other)
        return builder.extract_element(left, ir.Constant(ir.IntType(32), 0))

    return types.float64(value), codegen


@intrinsic
def only_lane(typingctx, value, lane):
    """1 in one lane and 0 in all others of a vector like `value`."""

    def codegen(context, builder, sig, args):
        kind = sig.return_type.ir
        integers = ir.VectorType(ir.IntType(64), kind.count)
        nothing, first = ir.Constant(integers, ir.Undefined), ir.Constant(ir.IntType(32), 0)
        wanted = builder.shuffle_vector(builder.insert_element(nothing, args[1], first), nothing,
                                        ir.Constant(ir.VectorType(ir.IntType(32), kind.count), [0] * kind.count))
        chosen = builder.icmp_signed("==", wanted, ir.Constant(integers, list(range(kind.count))))
        return builder.select(chosen, ir.Constant(kind, [1.0] * kind.count), ir.Constant(kind, [0.0] * kind.count))

    return value(value, types.intp), codegen


@intrinsic
def repeat_like(typingctx, value, eight):
    """A vector of eight doubles, repeated to the width of `value`."""

    def codegen(context, builder, sig, args):
        lanes = [lane % args[1].type.count for lane in range(sig.return_type.ir.count)]
        return builder.shuffle_vector(args[1], ir.Constant(args[1].type, ir.Undefined),
                                      ir.Constant(ir.VectorType(ir.IntType(32), len(lanes)), lanes))

    return value(value, eight), codegen
