"""Eight doubles at a time: a numba vector type with loads, stores and arithmetic, so that inner loops are written as mathematics.

LLVM maps one `Vec` to one AVX-512 register, two AVX2 registers or four NEON/SSE registers; nothing here depends on which.
Arrays must be C-contiguous float64, padded to a multiple of `LANES`; block b of an array covers elements LANES*b .. LANES*b + 7.
"""

from __future__ import annotations

import operator

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic, models, overload, register_model

LANES = 8
_DOUBLE = ir.DoubleType()
_VECTOR = ir.VectorType(_DOUBLE, LANES)
_FAST = ("contract",)  # fused multiply-add allowed; nothing else is reordered


class _VecType(types.Type):
    def __init__(self) -> None:
        super().__init__(name="Vec8f64")


vec = _VecType()


@register_model(_VecType)
class _VecModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, _VECTOR)


def _address(context, builder, array_type, array, index):
    view = context.make_array(array_type)(context, builder, value=array)
    element = builder.gep(view.data, [index])
    return builder.bitcast(element, _VECTOR.as_pointer())


@intrinsic
def load(typingctx, array, index):
    """The eight elements from `array[index]` on; no bounds are checked."""
    if not isinstance(array, types.Array):
        return None

    def codegen(context, builder, signature, args):
        index64 = context.cast(builder, args[1], signature.args[1], types.intp)
        return builder.load(_address(context, builder, signature.args[0], args[0], index64), align=8)

    return vec(array, index), codegen


@intrinsic
def store(typingctx, array, index, value):
    """Write the eight elements of `value` from `array[index]` on; no bounds are checked."""
    if not isinstance(array, types.Array) or value != vec:
        return None

    def codegen(context, builder, signature, args):
        index64 = context.cast(builder, args[1], signature.args[1], types.intp)
        builder.store(args[2], _address(context, builder, signature.args[0], args[0], index64), align=8)
        return context.get_dummy_value()

    return types.void(array, index, vec), codegen


def _splat(builder, scalar):
    undefined = ir.Constant(_VECTOR, ir.Undefined)
    first = builder.insert_element(undefined, scalar, ir.Constant(ir.IntType(32), 0))
    mask = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(first, undefined, mask)


@intrinsic
def splat(typingctx, scalar):
    """Eight copies of a scalar."""

    def codegen(context, builder, signature, args):
        return _splat(builder, context.cast(builder, args[0], signature.args[0], types.float64))

    return vec(scalar), codegen


def _shuffle(offset, doc):
    @intrinsic
    def shuffle(typingctx, first, second):
        if first != vec or second != vec:
            return None

        def codegen(context, builder, signature, args):
            mask = ir.Constant(ir.VectorType(ir.IntType(32), LANES), list(range(offset, offset + LANES)))
            return builder.shuffle_vector(args[0], args[1], mask)

        return vec(vec, vec), codegen

    shuffle.__doc__ = doc
    return shuffle


from_left = _shuffle(
    LANES - 1, "Of two neighbouring blocks (left, this): each element's left neighbour in `this`."
)
from_right = _shuffle(
    1, "Of two neighbouring blocks (this, right): each element's right neighbour in `this`."
)


def _unary(name):
    @intrinsic
    def apply(typingctx, value):
        if value != vec:
            return None

        def codegen(context, builder, signature, args):
            function = cgutils.get_or_insert_function(
                builder.module, ir.FunctionType(_VECTOR, [_VECTOR]), f"llvm.{name}.v{LANES}f64"
            )
            return builder.call(function, [args[0]])

        return vec(vec), codegen

    return apply


def _select_pair(name):
    @intrinsic
    def apply(typingctx, first, second):
        if first != vec or second != vec:
            return None

        def codegen(context, builder, signature, args):
            greater = builder.fcmp_ordered(">" if name == "maximum" else "<", args[0], args[1])
            return builder.select(greater, args[0], args[1])

        return vec(vec, vec), codegen

    return apply


magnitude = _unary("fabs")
maximum = _select_pair("maximum")
minimum = _select_pair("minimum")


@intrinsic
def any_greater(typingctx, first, second):
    """Whether any element of `first` exceeds its partner in `second`."""
    if first != vec or second != vec:
        return None

    def codegen(context, builder, signature, args):
        greater = builder.fcmp_ordered(">", args[0], args[1])
        bits = builder.bitcast(greater, ir.IntType(LANES))
        return builder.icmp_unsigned("!=", bits, ir.Constant(ir.IntType(LANES), 0))

    return types.boolean(vec, vec), codegen


def _binary(operation, emit):
    @intrinsic
    def apply(typingctx, first, second):
        def widen(context, builder, value, kind):
            return (
                value if kind == vec else _splat(builder, context.cast(builder, value, kind, types.float64))
            )

        def codegen(context, builder, signature, args):
            a, b = (widen(context, builder, v, t) for v, t in zip(args, signature.args, strict=True))
            return getattr(builder, emit)(a, b, flags=_FAST)

        return vec(first, second), codegen

    @overload(operation)
    def _typed(a, b):
        numeric = (types.Float, types.Integer)
        if (a == vec and (b == vec or isinstance(b, numeric))) or (b == vec and isinstance(a, numeric)):
            return lambda a, b: apply(a, b)
        return None


_binary(operator.add, "fadd")
_binary(operator.sub, "fsub")
_binary(operator.mul, "fmul")
