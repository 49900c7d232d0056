"""How numba's Python compiles a piece of a kernel: from bytecode to code for LLVM, with nothing asked twice.

Most of the wait of a first run was numba's own Python, and half of that was events that nobody listens to, messages
that nobody reads, analyses that nothing uses, and questions that were answered before: what the sum of two doubles is
was asked thousands of times. With `POUND_PLAIN_KERNELS=1` numba says where in a function an error is."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, nullcontext
from typing import Any

from llvmlite import binding
from numba.core import ir, lowering, typeinfer, types
from numba.core.analysis import dead_branch_prune, rewrite_semantic_constants
from numba.core.base import BaseContext
from numba.core.caching import Cache
from numba.core.compiler import Compiler
from numba.core.compiler_lock import global_compiler_lock
from numba.core.cpu import CPUContext
from numba.core.interpreter import Interpreter, peep_hole_delete_with_exit
from numba.core.ir_utils import build_definitions
from numba.core.registry import cpu_target
from numba.core.rewrites import rewrite_registry
from numba.core.runtime import rtsys
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


def run_passes(state: Any) -> None:
    """Compile what `state` knows of a function, by those of numba's passes that find something in a piece.

    There are no closures, arithmetic of whole arrays, context managers or unrolling by type; and lives of variables are
    looked at once, as the code is generated, where numba looks at them after each change."""
    state.func_ir = code = _Interpreter(state.func_id).interpret(state.bc)
    state.nargs = code.arg_count
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


class _Interpreter(Interpreter):
    """Numba's reader of bytecode; it does not look for what context managers leave."""

    def post_process(self, peepholes: Any, func_ir: Any) -> Any:
        return super().post_process([each for each in peepholes if each is not peep_hole_delete_with_exit], func_ir)


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


_TYPES, _STRIP = NopythonTypeInference(), PreLowerStripPhis()
_TO_CODE = (IRLegalization(), _Lowering(), NoPythonBackend())


@contextmanager
def nothing_twice() -> Iterator[None]:
    """While kernels are compiled or loaded: what was answered once is not looked for again. Numba's lock is held."""
    before: list[tuple[Any, str, Any]] = []

    def replace(owner: Any, name: str, new: Any) -> None:
        before.append((owner, name, vars(owner).get(name, _INHERITED)))
        setattr(owner, name, new)

    with global_compiler_lock:
        if typeinfer.new_error_context is _no_context:  # by a caller of this one
            yield
            return
        try:
            for owner, name, question in (
                (types.Function, "get_call_type", _call),
                (types.Dispatcher, "get_call_type", _call),
                (Context, "resolve_getattr", lambda _, *question: question),
                (BaseContext, "get_abi_sizeof", lambda _, kind: str(kind)),
            ):
                replace(owner, name, _remembered(getattr(owner, name), question))
            replace(types.Dispatcher, "get_call_type", _of_any_number(types.Dispatcher.get_call_type))
            replace(CPUContext, "refresh", _when_there_is_more(CPUContext.refresh))
            replace(Context, "refresh", _when_there_is_more(Context.refresh))
            replace(Cache, "load_overload", _load)
            # What asks LLVM waits for what works beside: LLVM answers one thread at a time.
            replace(binding, "get_process_triple", _remembered(binding.get_process_triple, lambda: None))
            replace(binding.newpassmanagers, "dump_refprune_stats", lambda: _NO_STATISTICS)
            replace(ir.Inst, "_rec_list_vars", _variables)
            replace(typeinfer, "new_error_context", _no_context)
            yield
        finally:
            for owner, name, old in reversed(before):
                if old is _INHERITED:
                    delattr(owner, name)
                else:
                    setattr(owner, name, old)


_INHERITED, _NO_CONTEXT = object(), nullcontext()
_NO_STATISTICS = binding.newpassmanagers.PruneStats(0, 0, 0, 0)


def _no_context(*_: Any, **__: Any) -> Any:
    """In place of the words that numba puts before an error."""
    return _NO_CONTEXT


def _remembered(ask: Callable[..., Any], question: Callable[..., Any]) -> Callable[..., Any]:
    """`ask`, which is asked each question once; `question`: of its arguments, those that the answer depends on."""
    answers: dict[Any, Any] = {}

    def answer(*given: Any) -> Any:
        asked = question(*given)
        if asked not in answers:
            answers[asked] = ask(*given)
        return answers[asked]

    return answer


def _call(function: types.Type, _: Any, args: Any, kws: Any) -> Any:
    return function, tuple(args), tuple(sorted(kws.items()))


def _of_any_number(call_type: Callable[..., Any]) -> Callable[..., Any]:
    """The type of a call of a piece is that for any number of a type: it is not compiled again for each one that is
    written out."""

    def call_of_piece(function: Any, context: Any, args: Any, kws: Any) -> Any:
        if function.dispatcher._compiler.pipeline_class is not Compiler:
            args = [types.unliteral(each) for each in args]
        return call_type(function, context, args, kws)

    return call_of_piece


def _when_there_is_more(refresh: Callable[..., None]) -> Callable[..., None]:
    """Look at numba's registries if they have more than the last time. Numba looks again for each attribute that it
    finds there, 250 times before the first kernel is compiled."""
    last, busy = -1, False

    def look(context: Any) -> None:
        nonlocal last, busy
        if busy:
            return
        size = sum(
            len(each) for place in context._registries for each in vars(place).values() if isinstance(each, list)
        )
        if size != last:
            last, busy = size, True
            try:
                refresh(context)
            finally:
                busy = False

    return look


def _load(cache: Cache, signature: Any, context: Any) -> Any:
    """A kernel that is kept on disk, or None. Numba imports all that it can compile first, and scipy.linalg with it."""
    rtsys.initialize(context)
    with cache._guard_against_spurious_io_errors():
        return cache._load_overload(signature, context)


SHARES: dict[str, bytes] = {}
"""Machine code that kernels call and that this process has, by name (`pieces.Share`)."""


def load_share(codegen: Any, name: str, machine_code: bytes) -> None:
    """Have machine code that kernels call, once however many they are."""
    if name not in SHARES:
        codegen._engine._ee.add_object_file(binding.ObjectFileRef.from_data(machine_code))
        SHARES[name] = machine_code


class WithShares:
    """What numba keeps on disk of a kernel: who reads it back has the shares too, and gets what numba would keep."""

    def __init__(self, kept: Any, names: Iterable[str]) -> None:
        self._kept, self._shares = kept, {name: SHARES[name] for name in names}

    def __reduce__(self) -> Any:
        return _read_back, (self._kept, self._shares)


def _read_back(kept: Any, shares: dict[str, bytes]) -> Any:
    for name, machine_code in shares.items():
        load_share(cpu_target.target_context.codegen(), name, machine_code)
    return kept


_WITHOUT = {str, int, float, bool, type(None), ir.Loc}


def _variables(inst: ir.Inst, value: Any) -> list[ir.Var]:
    """The variables in what an instruction holds."""
    if isinstance(value, ir.Var):
        return [value]
    if isinstance(value, ir.Inst):
        return value.list_vars()
    found: list[ir.Var] = []
    if isinstance(value, dict | list | tuple):
        for each in value.values() if isinstance(value, dict) else value:
            kind = type(each)
            if kind is ir.Var:
                found.append(each)
            elif kind not in _WITHOUT:
                found += _variables(inst, each)
    return found
