"""Eight doubles at a time: a numba vector type with loads, stores and arithmetic, so that inner loops are written as
mathematics.

LLVM maps one `Vec` to one AVX-512 register, two AVX2 registers or four NEON/SSE registers; nothing here depends on
which. Multiplications and additions are fused only where `fused` says so, never by the compiler's choice: the same
text gives the same bits wherever it is used. Kernels reach memory through plain pointers (`pointer`), not numpy
arrays: an array drags its reference count through every call and every field of a tuple, and that costs more than the
arithmetic of a small scene. Whoever calls a kernel keeps the arrays alive."""

from __future__ import annotations

import inspect
import operator

from llvmlite import ir
from numba import types
from numba.extending import lower_builtin, models, register_model, type_callable

LANES = 8
_DOUBLE = ir.DoubleType()
_VECTOR = ir.VectorType(_DOUBLE, LANES)


def instruction(definition):
    """As numba's `intrinsic`: `definition(typingctx, *types)` gives (signature, code generator), or None for types that
    are not its own.

    `intrinsic` registers a lowering for each set of argument types, and numba reads all its registries again each time;
    this registers one for all."""

    parameters = inspect.signature(definition)
    parameters = parameters.replace(parameters=list(parameters.parameters.values())[1:])

    @type_callable(definition)
    def typing(context):
        def signature(*args):
            found = definition(context, *args)
            return found and found[0]

        signature.__signature__ = parameters
        return signature

    @lower_builtin(definition, types.VarArg(types.Any))
    def lower(context, builder, signature, args):
        _, codegen = definition(context.typing_context, *signature.args)
        return codegen(context, builder, signature, args)

    return definition


def _llvm(builder, name, values):
    """Call LLVM's own function `name` of vectors or doubles; returns what its arguments are."""
    kind = values[0].type
    suffix = f"v{LANES}f64" if kind == _VECTOR else "f64"
    full = f"llvm.{name}.{suffix}"
    function = builder.module.globals.get(full)
    if function is None:
        function = ir.Function(builder.module, ir.FunctionType(kind, [kind] * len(values)), full)
    return builder.call(function, values)


class _VecType(types.Type):
    def __init__(self) -> None:
        super().__init__(name="Vec8f64")


vec = _VecType()


@register_model(_VecType)
class _VecModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, _VECTOR)


@instruction
def pointer(typingctx, array):
    """Where the data of a C-contiguous array begin; the array must outlive the pointer."""
    if not isinstance(array, types.Array):
        return None

    def codegen(context, builder, signature, args):
        return context.make_array(signature.args[0])(context, builder, value=args[0]).data

    return types.CPointer(array.dtype)(array), codegen


@instruction
def further(typingctx, place, count):
    """The pointer `count` elements on."""
    if not isinstance(place, types.CPointer):
        return None

    def codegen(context, builder, signature, args):
        return builder.gep(args[0], [context.cast(builder, args[1], signature.args[1], types.intp)])

    return place(place, count), codegen


SHORT = 320
"""Doubles of a short array."""


@instruction
def short_array(typingctx):
    """A pointer to SHORT doubles that last as long as the function runs in which this stands; what is in them is not
    defined."""

    def codegen(context, builder, signature, args):
        with builder.goto_entry_block():
            return builder.alloca(_DOUBLE, size=SHORT)

    return types.CPointer(types.float64)(), codegen


def _address(context, builder, signature, args):
    index = context.cast(builder, args[1], signature.args[1], types.intp)
    return builder.bitcast(builder.gep(args[0], [index]), _VECTOR.as_pointer())


@instruction
def load(typingctx, place, index):
    """The eight elements from `place[index]` on; no bounds are checked."""
    if not isinstance(place, types.CPointer):
        return None

    def codegen(context, builder, signature, args):
        return builder.load(_address(context, builder, signature, args), align=8)

    return vec(place, index), codegen


@instruction
def store(typingctx, place, index, value):
    """Write the eight elements of `value` from `place[index]` on; no bounds are checked."""
    if not isinstance(place, types.CPointer) or value != vec:
        return None

    def codegen(context, builder, signature, args):
        builder.store(args[2], _address(context, builder, signature, args), align=8)
        return context.get_dummy_value()

    return types.void(place, index, vec), codegen


def _splat(builder, scalar):
    undefined = ir.Constant(_VECTOR, ir.Undefined)
    first = builder.insert_element(undefined, scalar, ir.Constant(ir.IntType(32), 0))
    mask = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(first, undefined, mask)


@instruction
def splat(typingctx, scalar):
    """Eight copies of a scalar."""

    def codegen(context, builder, signature, args):
        return _splat(builder, context.cast(builder, args[0], signature.args[0], types.float64))

    return vec(scalar), codegen


@instruction
def ramp(typingctx):
    """0, 1, ... 7."""

    def codegen(context, builder, signature, args):
        return ir.Constant(_VECTOR, [float(lane) for lane in range(LANES)])

    return vec(), codegen


def _shuffle(offset, doc):
    @instruction
    def shuffle(typingctx, first, second):
        if first != vec or second != vec:
            return None

        def codegen(context, builder, signature, args):
            mask = ir.Constant(ir.VectorType(ir.IntType(32), LANES), list(range(offset, offset + LANES)))
            return builder.shuffle_vector(args[0], args[1], mask)

        return vec(vec, vec), codegen

    shuffle.__doc__ = doc
    return shuffle


from_left = _shuffle(LANES - 1, "Of two neighbouring blocks (left, this): each element's left neighbour in `this`.")
from_right = _shuffle(1, "Of two neighbouring blocks (this, right): each element's right neighbour in `this`.")


def _unary(name, doc):
    @instruction
    def apply(typingctx, value):
        if value != vec:
            return None

        def codegen(context, builder, signature, args):
            return _llvm(builder, name, args)

        return vec(vec), codegen

    apply.__doc__ = doc
    return apply


magnitude = _unary("fabs", "Absolute value, element by element.")
square_root = _unary("sqrt", "Square root, element by element.")


def _select_pair(name):
    @instruction
    def apply(typingctx, first, second):
        if first != vec or second != vec:
            return None

        def codegen(context, builder, signature, args):
            greater = builder.fcmp_ordered(">" if name == "maximum" else "<", args[0], args[1])
            return builder.select(greater, args[0], args[1])

        return vec(vec, vec), codegen

    return apply


maximum = _select_pair("maximum")
minimum = _select_pair("minimum")


@instruction
def greater(typingctx, first, second):
    """Eight bits: bit i is set where element i of `first` exceeds its partner in `second`."""
    if first != vec or second != vec:
        return None

    def codegen(context, builder, signature, args):
        lanes = builder.fcmp_ordered(">", args[0], args[1])
        return builder.zext(builder.bitcast(lanes, ir.IntType(LANES)), ir.IntType(64))

    return types.int64(vec, vec), codegen


@instruction
def lowest(typingctx, bits):
    """Number of the lowest set bit; at least one must be set. A loop over set bits: `bits &= bits - 1`."""

    def codegen(context, builder, signature, args):
        return builder.cttz(args[0], ir.Constant(ir.IntType(1), 1))

    return types.int64(types.int64), codegen


def _widen(context, builder, value, kind):
    return value if kind == vec else _splat(builder, context.cast(builder, value, kind, types.float64))


@instruction
def fused(typingctx, first, second, third):
    """first * second + third with one rounding; element by element where one of them is a vector."""
    wide = vec in (first, second, third)

    def codegen(context, builder, signature, args):
        if wide:
            values = [_widen(context, builder, v, t) for v, t in zip(args, signature.args, strict=True)]
        else:
            values = [context.cast(builder, v, t, types.float64) for v, t in zip(args, signature.args, strict=True)]
        return _llvm(builder, "fma", values)

    return (vec if wide else types.float64)(first, second, third), codegen


@instruction
def choose(typingctx, bits, first, second):
    """Element i of `first` where bit i is set, else that of `second`."""
    if first != vec or second != vec:
        return None

    def codegen(context, builder, signature, args):
        mask = builder.trunc(args[0], ir.IntType(LANES))
        return builder.select(builder.bitcast(mask, ir.VectorType(ir.IntType(1), LANES)), args[1], args[2])

    return vec(types.int64, vec, vec), codegen


@instruction
def gather(typingctx, place, start, index, first):
    """The eight elements place[start + index[first + i]], i from 0 to 7; no bounds are checked."""
    if not (isinstance(place, types.CPointer) and isinstance(index, types.CPointer)):
        return None

    def codegen(context, builder, signature, args):
        row, begin = (context.cast(builder, args[j], signature.args[j], types.intp) for j in (1, 3))
        base, numbers = builder.gep(args[0], [row]), builder.gep(args[2], [begin])
        value = ir.Constant(_VECTOR, ir.Undefined)
        for lane in range(LANES):
            number = builder.load(builder.gep(numbers, [ir.Constant(ir.IntType(64), lane)]))
            element = builder.load(builder.gep(base, [number]))
            value = builder.insert_element(value, element, ir.Constant(ir.IntType(32), lane))
        return value

    return vec(place, start, index, first), codegen


@instruction
def no_inline(typingctx):
    """Called in a function: that function is compiled once and called, not copied to where it is used."""

    def codegen(context, builder, signature, args):
        builder.function.attributes.add("noinline")
        return context.get_dummy_value()

    return types.void(), codegen


def _binary(operation, emit):
    """Teach numba `operation` for vectors: a type rule and one instruction, with no function behind it to compile."""

    @type_callable(operation)
    def typing(context):
        def result(first, second):
            args = first, second
            if vec in args and all(kind == vec or isinstance(kind, types.Float | types.Integer) for kind in args):
                return vec
            return None

        return result

    def lower(context, builder, signature, args):
        a, b = (_widen(context, builder, v, t) for v, t in zip(args, signature.args, strict=True))
        return getattr(builder, emit)(a, b)

    for pair in ((vec, vec), (vec, types.Float), (types.Float, vec), (vec, types.Integer), (types.Integer, vec)):
        lower_builtin(operation, *pair)(lower)


_binary(operator.add, "fadd")
_binary(operator.sub, "fsub")
_binary(operator.mul, "fmul")
_binary(operator.truediv, "fdiv")
