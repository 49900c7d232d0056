"""How numba's Python compiles a piece of a kernel: from bytecode to code for LLVM, with nothing asked twice.

Most of the wait of a first run was numba's own Python, and half of that was events that nobody listens to, messages
that nobody reads, analyses that nothing uses, and questions that were answered before: what the sum of two doubles is
was asked thousands of times. With `POUND_PLAIN_KERNELS=1` numba says where in a function an error is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from numba.core import ir, lowering, types
from numba.core.analysis import dead_branch_prune, rewrite_semantic_constants
from numba.core.base import BaseContext
from numba.core.compiler import Compiler
from numba.core.cpu import CPUContext
from numba.core.ir_utils import build_definitions
from numba.core.rewrites import rewrite_registry
from numba.core.ssa import reconstruct_ssa
from numba.core.transforms import canonicalize_cfg
from numba.core.typed_passes import (
    IRLegalization,
    NativeLowering,
    NoPythonBackend,
    NopythonTypeInference,
    PreLowerStripPhis,
)
from numba.core.typing.context import Context
from numba.core.untyped_passes import FixupArgs, TranslateByteCode


def run_passes(state: Any) -> None:
    """Compile what `state` knows of a function, by those of numba's passes that find something in a piece.

    There are no closures, arithmetic of whole arrays, context managers or unrolling by type; and lives of variables are
    looked at once, as the code is generated, where numba looks at them after each change."""
    for each in _TO_VARIABLES:
        each.run_pass(state)
    code = state.func_ir
    code.blocks = canonicalize_cfg(code.blocks)
    rewrite_semantic_constants(code, state.args)
    dead_branch_prune(code, state.args)
    _rewrite(state)
    reconstruct_ssa(code)
    code._definitions = build_definitions(code.blocks)
    dead_branch_prune(code, state.args)
    _TYPES.run_pass(state)
    _STRIP._strip_phi_nodes(code)
    code._definitions = build_definitions(code.blocks)
    for each in _TO_CODE:
        each.run_pass(state)


def _rewrite(state: Any) -> None:
    """Tuples at constant places, constant powers and the like, told by what numba has for them."""
    code = state.func_ir
    for kind in rewrite_registry.rewrites["before-inference"]:
        each = kind(state)
        for place, block in list(code.blocks.items()):
            while each.match(code, block, state.typemap, state.calltypes):
                code.blocks[place] = block = each.apply()


class _Lower(lowering.Lower):
    """Numba's code generator without words for every instruction: they would be put together and thrown away."""

    def lower_block(self, block: Any) -> None:
        self.pre_block(block)
        for inst in block.body:
            self.loc = inst.loc
            if isinstance(inst, ir.Assign) and not isinstance(inst.value, ir.Arg):
                self.storevar(self.lower_assign(self.typeof(inst.target.name), inst), inst.target.name)
            elif isinstance(inst, ir.Del):
                self.delvar(inst.value)
            else:
                self.lower_inst(inst)
        self.post_block(block)


class _Lowering(NativeLowering):
    """Code of a function whose types are known."""

    lowering_class = _Lower


_TO_VARIABLES, _TYPES, _STRIP = (TranslateByteCode(), FixupArgs()), NopythonTypeInference(), PreLowerStripPhis()
_TO_CODE = (IRLegalization(), _Lowering(), NoPythonBackend())


@contextmanager
def nothing_twice() -> Iterator[None]:
    """While a kernel is compiled, under numba's lock: what was answered once is not looked for again."""
    answers: dict[Any, Any] = {}

    def remembered(owner: type, name: str, key: Callable[..., Any]) -> Callable[..., Any]:
        ask = getattr(owner, name)

        def answer(*question: Any) -> Any:
            asked = name, key(*question)
            if asked not in answers:
                answers[asked] = ask(*question)
            return answers[asked]

        return answer

    def load_additional_registries(self: Any) -> None:
        """What was added to those that were found as the kernel's compiler began: numba imports them all again."""
        for registry in list(self._registries):
            self.install_registry(registry)

    def call(function: types.Type, _: Any, args: Any, kws: Any) -> Any:
        return function, tuple(args), tuple(sorted(kws.items()))

    call_of_any = remembered(types.Dispatcher, "get_call_type", call)

    def call_of_piece(function: Any, context: Any, args: Any, kws: Any) -> Any:
        """A piece takes any number of a type: it is not compiled once more for each that is written out."""
        if function.dispatcher._compiler.pipeline_class is not Compiler:
            args = [types.unliteral(each) for each in args]
        return call_of_any(function, context, args, kws)

    replaced = [
        (types.Function, "get_call_type", remembered(types.Function, "get_call_type", call)),
        (types.Dispatcher, "get_call_type", call_of_piece),
        (Context, "resolve_getattr", remembered(Context, "resolve_getattr", lambda _, kind, name: (kind, name))),
        (BaseContext, "get_abi_sizeof", remembered(BaseContext, "get_abi_sizeof", lambda _, kind: str(kind))),
        (Context, "load_additional_registries", load_additional_registries),
        (CPUContext, "load_additional_registries", load_additional_registries),
    ]
    before = [(owner, name, vars(owner).get(name)) for owner, name, _ in replaced]
    try:
        for owner, name, each in replaced:
            setattr(owner, name, each)
        yield
    finally:
        for owner, name, own in before:
            if own is None:
                delattr(owner, name)
            else:
                setattr(owner, name, own)
