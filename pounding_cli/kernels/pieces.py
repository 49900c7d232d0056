"""How the pieces of a kernel are compiled: not one by one, but as parts of the kernel that they stand in.

By itself numba takes every function, however small, through LLVM's optimiser and on to machine code before another may
call it, and does the same with its copy in each caller. A piece stops at code whose functions are simplified one by
one, beside numba's Python; it is linked into the kernel, and the kernel is optimised as a whole, once."""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from types import ModuleType
from typing import Any, ClassVar

from llvmlite import ir
from llvmlite.binding import parse_assembly
from numba import _dynfunc, types
from numba.core.cgutils import normalize_ir_text
from numba.core.codegen import CodeLibrary, JITCodeLibrary
from numba.core.compiler import Compiler, compile_result
from numba.core.funcdesc import ExternalFunctionDescriptor
from numba.core.registry import cpu_target
from numba.core.targetconfig import ConfigStack
from numba.core.typing.templates import AbstractTemplate, AttributeTemplate, infer_global, signature
from numba.extending import infer_getattr, lower_builtin, lower_getattr_generic

from pounding_cli.kernels.apart import Apart, may_fork
from pounding_cli.kernels.passes import SHARES, WithShares, load_share, nothing_twice, run_passes

_UNPACKING = ("_ZN7cpython", "cfunc.")
"""How the names of functions begin that unpack what a kernel is given."""

_REFUSAL = ctypes.cast(ctypes.pythonapi.PyErr_BadArgument, ctypes.c_void_p).value
"""What Python finds where a piece's entry should be: it raises TypeError."""


def teach_fields(kind: type[types.Type], read: Callable[..., Any]) -> None:
    """Teach numba the fields of all frames at once; with `overload_attribute` each is a function to compile.

    read : (context, builder, type, value, name of a field), emits the code that reads it
    """

    @infer_getattr
    class Fields(AttributeTemplate):
        key = kind

        def generic_resolve(self, frame: Any, field: str) -> Any:
            return frame.fields.get(field)

    lower_getattr_generic(kind)(read)


def _teach(function: Any, code: Callable[..., Any], kind: types.Type, *more: types.Type, gives: types.Type) -> None:
    """Teach numba `function` of such arguments by its code, where numba has a function to compile.

    code : (builder, values)
    more : kinds of further arguments, all but the last of which are as many as `kind`
    """

    @infer_global(function)
    class Template(AbstractTemplate):
        key = function
        metadata: ClassVar = {"target": "cpu"}  # asked before numba's own, which is for any target

        def generic(self, args: Any, kws: Any) -> Any:
            found = not kws and set(args) == {kind} and (len(args) > 1) == bool(more)
            return signature(gives, *args) if found else None

    def lower(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return code(builder, args)

    lower_builtin(function, kind, *more)(lower)


def _teach_builtins() -> None:
    """`max` and `min` of doubles or of integers, which pass over what is not a number just as numba's do, and `int`."""

    def best(compare: str, sign: str) -> Callable[..., Any]:
        def code(builder: Any, values: Any) -> Any:
            found = values[0]
            for each in values[1:]:
                found = builder.select(getattr(builder, compare)(sign, each, found), each, found)
            return found

        return code

    for function, sign in ((max, ">"), (min, "<")):
        for kind, compare in ((types.float64, "fcmp_ordered"), (types.int64, "icmp_signed")):
            _teach(function, best(compare, sign), kind, types.VarArg(kind), gives=kind)
    _teach(int, lambda builder, values: builder.fptosi(values[0], ir.IntType(64)), types.float64, gives=types.int64)


_BESIDE: list[ThreadPoolExecutor] = []
"""What works beside the compiler of the kernel that is compiled now."""


@contextmanager
def _beside() -> Iterator[None]:
    """While a kernel is compiled: a thread in which LLVM works beside numba's Python."""
    with ThreadPoolExecutor(1) as beside:
        _BESIDE.append(beside)
        try:
            yield
        finally:
            _BESIDE.pop()


def _simplify(codegen: Any, function: Any) -> None:
    """Optimise a function by itself, before it is inlined: that makes faster kernels (Taylor 2 %, Runge-Kutta with
    events 10 %)."""
    passes, builder = codegen._function_pass_manager()
    passes.run(function, builder)


class _Unfinished(JITCodeLibrary):
    """Code whose functions have met the optimiser one by one, and not together."""

    inlined = False
    """Whether the piece is copied to where it is called."""

    def __init__(self, codegen: Any, name: str) -> None:
        CodeLibrary.__init__(self, codegen, name)  # numba's next would make a module that nothing is put into
        self._linking_libraries: list[Any] = []
        self._final_module = self._shared_module = None

    def add_ir_module(self, ir_module: Any) -> None:
        """Take the code of the piece, which is one module. LLVM works on it beside numba's Python, on another core if
        there is one."""
        text = normalize_ir_text(str(ir_module))
        if _BESIDE:
            self._work = _BESIDE[-1].submit(self._simplified, text)
        else:
            self._final_module = self._simplified(text)

    def finalize(self) -> None:
        """Leave the piece by itself; whoever compiles the kernel links it with all that it calls."""
        self._finalized = True

    def _simplified(self, text: str) -> Any:
        module = parse_assembly(text)
        module.verify()
        for function in module.functions:
            if not function.is_declaration:
                function.linkage = "linkonce_odr"
                if self.inlined:
                    function.add_function_attribute("alwaysinline")
                _simplify(self._codegen, function)
        return module

    @property
    def module(self) -> Any:
        """The piece's code for LLVM."""
        if self._final_module is None:
            self._final_module = self._work.result()
        return self._final_module

    def with_called(self) -> list[Any]:
        """The piece and all that it calls, each once."""
        found: dict[Any, None] = {}
        waiting: list[Any] = [self]
        while waiting:
            library = waiting.pop()
            if library not in found:
                found[library] = None
                if isinstance(library, _Unfinished):
                    waiting += library._linking_libraries
        return list(found)

    def link_into(self, module: Any, done: set[Any]) -> None:
        """Link the piece and all that it calls into a module, but what is done."""
        for library in self.with_called():
            if library not in done:
                done.add(library)
                piece = isinstance(library, _Unfinished)
                module.link_in(library.module if piece else library._get_module_for_linking(), preserve=True)

    def _get_module_for_linking(self) -> Any:
        """For a caller that is no kernel of ours: with all that the piece calls."""
        if self._shared_module is None:
            self._shared_module = self.module.clone()
            self.link_into(self._shared_module, {self})
        return self._shared_module


@functools.cache
def _nothing() -> Any:
    """A module without code."""
    return parse_assembly("")


class _Declared(_Unfinished):
    """A piece of a share: here it has a name and a signature, and no code."""

    def __init__(self, codegen: Any, name: str, share: Share) -> None:
        super().__init__(codegen, name)
        self._final_module, self.share = _nothing(), share


class _Kernel(JITCodeLibrary):
    """A kernel with all its pieces, or a share of them."""

    def add_llvm_module(self, ll_module: Any) -> None:
        """Take the module as it is, but for the kernel's own function, which is simplified as its pieces are."""
        for function in ll_module.functions:
            if not function.is_declaration and not function.name.startswith(_UNPACKING):
                _simplify(self._codegen, function)
        self._final_module.link_in(ll_module)

    def finalize(self) -> None:
        """Take in every piece once, whoever calls it."""
        self._shares = self._link()
        super().finalize()

    def machine_code(self, symbols: dict[str, str]) -> bytes:
        """That of a share, all of whose functions but these are its own, by names of its own: LLVM lets another kernel
        call what has the name of one of its pieces, and these may have lost arguments that they do not use.

        symbols : names of functions in the code, and what kernels call them
        """
        self._link()
        for function in self._final_module.functions:
            if not function.is_declaration:
                symbol = symbols.get(function.name)
                function.linkage = "external" if symbol else "internal"
                function.name = symbol or f"{self.name}.{function.name}"
        self._optimize_final_module()
        return self._emitted()

    def serialize_using_object_code(self) -> Any:
        """As it is kept on disk."""
        kept = super().serialize_using_object_code()
        return WithShares(kept, [share.name for share in self._shares]) if self._shares else kept

    def _link(self) -> list[Share]:
        """Take in all pieces; returns the shares that have the rest."""
        done: set[Any] = set()
        for library in self._linking_libraries:
            if isinstance(library, _Unfinished):
                library.link_into(self._final_module, done)
        self._linking_libraries = [each for each in self._linking_libraries if each not in done]
        return list({each.share for each in done if isinstance(each, _Declared)})

    def _emitted(self) -> bytes:
        return bytes(self._codegen._tm.emit_object(self._final_module))

    def _finalize_final_module(self) -> None:
        """Numba would emit the machine code as it loads it, when all that it calls is there. It is emitted first, and
        then waited for the shares."""
        if self._shares:
            self._compiled_object = emitted = self._emitted()
            for share in self._shares:
                load_share(self._codegen, share.name, share.machine_code())
        super()._finalize_final_module()
        if self._shares:
            self._compiled_object = emitted  # numba lets go of it as it loads it

    def _optimize_final_module(self) -> None:
        """With its pieces, once: one more round over the module would make Taylor 1 % faster and take a tenth of the
        wait. What unpacks the arguments runs once a scene, and is left as it is."""
        for function in self._final_module.functions:
            if function.name.startswith(_UNPACKING):
                function.add_function_attribute("noinline")
                function.add_function_attribute("optnone")
        super()._optimize_final_module()


class Share:
    """Pieces that become machine code apart from the kernels that call them, in another process beside this one.

    name : of their machine code, which is the same in every process
    pieces : large ones, which are called and not copied, and their signatures. Whoever calls one must know what it
        gives before it is compiled
    """

    def __init__(self, name: str, pieces: dict[Any, Any]) -> None:
        self.name, self._pieces = name, pieces
        self._other: Apart | None = None

    @contextmanager
    def begun(self, flags: Any) -> Iterator[None]:
        """While a kernel is compiled: its pieces of this share are declared, and another process compiles them.

        Where no other process can, or where this one has compiled the pieces before, they are pieces like others."""
        with ExitStack() as stack:
            if self._begin(stack, flags):
                stack.enter_context(_declaring(self))
            try:
                yield
            finally:
                self._other = None

    def _begin(self, stack: ExitStack, flags: Any) -> bool:
        if self.name in SHARES:
            return True
        if not may_fork() or any(wanted.args in piece.overloads for piece, wanted in self._pieces.items()):
            return False
        try:
            with ConfigStack().enter(flags.copy()):
                self._other = stack.enter_context(Apart(self._compile))
        except OSError:
            return False
        return True

    def declared(self, function: Any, args: Any) -> tuple[str, Any] | None:
        """(name, signature) of a function of such arguments, if it is a piece of this share."""
        for piece, wanted in self._pieces.items():
            if piece.py_func is function and wanted.args == tuple(args):
                return self._symbol(piece), wanted
        return None

    def machine_code(self) -> bytes:
        """The machine code; it is waited for, and made here if need be."""
        return SHARES.get(self.name) or (self._other.result() if self._other else self._compile())

    def _symbol(self, piece: Any) -> str:
        return f"{self.name}.{piece.py_func.__module__}.{piece.py_func.__qualname__}"

    def _compile(self) -> bytes:
        library = _Kernel(cpu_target.target_context.codegen(), self.name)
        symbols = {}
        with _beside(), _declaring(None):
            for piece, wanted in self._pieces.items():
                piece.overloads.pop(wanted.args, None)  # what was declared
                piece.compile(wanted.args)
                found = piece.overloads[wanted.args]
                if found.signature.return_type != wanted.return_type:
                    raise TypeError(
                        f"{self._symbol(piece)} gives {found.signature.return_type}, not {wanted.return_type}"
                    )
                name = found.fndesc.llvm_func_name
                found.library.module.get_function(name).linkage = "weak_odr"  # linked, though no function calls it
                library.add_linking_library(found.library)
                symbols[name] = self._symbol(piece)
            return library.machine_code(symbols)


_DECLARING: list[Share | None] = []
"""The share of the kernel that is compiled now."""


@contextmanager
def _declaring(share: Share | None) -> Iterator[None]:
    _DECLARING.append(share)
    try:
        yield
    finally:
        _DECLARING.pop()


class KernelCompiler(Compiler):
    """A `pipeline_class` for `numba.njit`: what it compiles is called from Python and made of pieces."""

    share: Share | None = None
    """Those of its pieces that are compiled apart."""

    def compile_extra(self, func: Any) -> Any:
        """Compile a function and optimise it together with its pieces."""
        self.state.flags.no_cfunc_wrapper = True  # no kernel is called from C
        self.state.library = _Kernel(self.state.targetctx.codegen(), func.__qualname__)
        self.state.library.enable_object_caching()
        with nothing_twice(), ExitStack() as stack:
            if self.share is not None:
                stack.enter_context(self.share.begun(self.state.flags))
            stack.enter_context(_beside())
            return super().compile_extra(func)


class PieceCompiler(Compiler):
    """A `pipeline_class` for `numba.njit`. What it compiles is called from compiled functions only, and owns no memory:
    it works on pointers, or on arrays that its caller holds."""

    def __init__(
        self, typingctx: Any, targetctx: Any, library: Any, args: Any, return_type: Any, flags: Any, locals: Any
    ) -> None:
        flags.no_compile = True
        flags.no_cpython_wrapper = True
        flags.no_cfunc_wrapper = True
        flags.nrt = False  # no counting of references
        # Numba compiles an attribute of a frame once for each set of flags that its readers have: so they have one.
        self._inlined, flags.forceinline = flags.forceinline, False
        super().__init__(typingctx, targetctx, library, args, return_type, flags, locals)

    def _compile_core(self) -> Any:
        """Called by numba's `compile_extra`."""
        with ConfigStack().enter(self.state.flags.copy()):
            run_passes(self.state)
        return self.state.cr

    def compile_extra(self, func: Any) -> Any:
        """Compile a function as far as it goes without its kernel."""
        share = _DECLARING[-1] if _DECLARING else None
        declared = share.declared(func, self.state.args) if share else None
        if declared:
            return self._known(func, self._declared(share, *declared))
        self.state.library = _Unfinished(self.state.targetctx.codegen(), func.__qualname__)
        self.state.library.inlined = self._inlined
        return self._known(func, super().compile_extra(func))

    def _declared(self, share: Share, symbol: str, signature: Any) -> Any:
        """What numba needs to know of a piece that is called."""
        library = _Declared(self.state.targetctx.codegen(), symbol, share)
        library.finalize()
        return compile_result(
            typing_context=self.state.typingctx, target_context=self.state.targetctx, library=library,
            signature=signature, objectmode=False, environment=_dynfunc.Environment({}),
            fndesc=ExternalFunctionDescriptor(symbol, signature.return_type, signature.args),
        )  # fmt: skip

    def _known(self, func: Any, found: Any) -> Any:
        """Numba knows a compiled function by the object that Python would call."""
        entry = _dynfunc.make_function(
            ModuleType(func.__module__), func.__name__, "", _REFUSAL, found.environment, (found.library,)
        )
        self.state.targetctx.insert_user_function(entry, found.fndesc, [found.library])
        return found._replace(entry_point=entry)


_teach_builtins()
