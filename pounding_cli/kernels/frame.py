"""A frame: what the pieces of a kernel share, read by name through one pointer.

A namedtuple of thirty pointers travels as thirty arguments, through registers that are not there; and a kernel that is
one function instead, so that nothing travels, keeps them all on its stack and moves them about in every loop. A frame
travels as one pointer. Its fields stay as they are for a whole run, which the compiler is told, so that it reads each
before a loop and not in it; those called movable may change."""

from __future__ import annotations

from llvmlite import ir
from numba import types
from numba.extending import models, overload_attribute, register_model

from pounding_cli.kernels import pipelines
from pounding_cli.kernels.layout import PART
from pounding_cli.kernels.simd import instruction

_WORD = ir.IntType(64)

DOUBLES = types.CPointer(types.float64)
INTEGERS = types.CPointer(types.int64)


class Frame(types.Type):
    """The type of a frame: `fields` by name, in the order in which they stand in memory."""

    def __init__(self, name: str, fields: dict[str, types.Type], movable: tuple[str, ...] = ()) -> None:
        super().__init__(name=f"Frame({name})")
        self.fields = fields
        self.places = {field: place for place, field in enumerate(fields)}
        self.movable = movable
        if not pipelines.QUICK:
            for field in fields:
                _readable(self, field)


@register_model(Frame)
class _FrameModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, _WORD.as_pointer())


def _read(context, builder, frame, place, field):
    """Emit `frame.field`."""
    kind = frame.fields[field]
    word = builder.load(builder.gep(place, [_WORD(frame.places[field])]))
    if field not in frame.movable:
        word.set_metadata("invariant.load", builder.module.add_metadata([]))
    if isinstance(kind, types.CPointer):
        return builder.inttoptr(word, context.get_value_type(kind))
    return builder.bitcast(word, ir.DoubleType()) if kind == types.float64 else word


def _readable(frame: Frame, field: str) -> None:
    """Teach numba one field by a function of its own."""

    @instruction
    def read(typingctx, place):
        def codegen(context, builder, signature, args):
            return _read(context, builder, frame, args[0], field)

        return frame.fields[field](place), codegen

    @overload_attribute(frame, field, jit_options=PART)
    def attribute(place):
        return lambda place: read(place)


if pipelines.QUICK:
    pipelines.teach_fields(Frame, _read)


def _as_word(context, builder, value, given, wanted):
    if isinstance(wanted, types.CPointer):
        return builder.ptrtoint(value, _WORD)
    value = context.cast(builder, value, given, wanted)
    return builder.bitcast(value, _WORD) if wanted == types.float64 else value


def filler(frame: Frame):
    """A function of (pointer to integers, tuple of all fields in order): writes them there, returns the frame."""

    @instruction
    def fill(typingctx, place, values):
        if not isinstance(values, types.BaseTuple) or len(values) != len(frame.fields):
            return None

        def codegen(context, builder, signature, args):
            for number, wanted in enumerate(frame.fields.values()):
                value = builder.extract_value(args[1], number)
                word = _as_word(context, builder, value, signature.args[1][number], wanted)
                builder.store(word, builder.gep(args[0], [_WORD(number)]))
            return args[0]

        return frame(place, values), codegen

    return fill


def mover(frame: Frame):
    """A function of (frame, tuple of all movable fields in order) that changes them."""

    @instruction
    def move(typingctx, place, values):
        if place != frame or not isinstance(values, types.BaseTuple) or len(values) != len(frame.movable):
            return None

        def codegen(context, builder, signature, args):
            for number, name in enumerate(frame.movable):
                value = builder.extract_value(args[1], number)
                word = _as_word(context, builder, value, signature.args[1][number], frame.fields[name])
                builder.store(word, builder.gep(args[0], [_WORD(frame.places[name])]))
            return context.get_dummy_value()

        return types.void(place, values), codegen

    return move
