"""How the pieces of a kernel are compiled: not one by one, but as parts of the kernel that they stand in.

By itself numba takes every function, however small, through LLVM's optimiser and on to machine code before another may
call it, and does the same with its copy in each caller. A piece stops at code whose functions are simplified one by
one, beside numba's Python; it is linked into the kernel, and the kernel is optimised as a whole, once."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from types import ModuleType
from typing import Any, ClassVar

from llvmlite import ir
from llvmlite.binding import parse_assembly
from numba import _dynfunc, types
from numba.core.cgutils import normalize_ir_text
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.targetconfig import ConfigStack
from numba.core.typing.templates import AbstractTemplate, AttributeTemplate, infer_global, signature
from numba.extending import infer_getattr, lower_builtin, lower_getattr_generic

from pounding_cli.kernels.passes import nothing_twice, run_passes

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


def _simplify(codegen: Any, function: Any) -> None:
    """Optimise a function by itself, before it is inlined: that makes faster kernels (Taylor 2 %, Runge-Kutta with
    events 10 %)."""
    passes, builder = codegen._function_pass_manager()
    passes.run(function, builder)


class _Unfinished(JITCodeLibrary):
    """Code whose functions have met the optimiser one by one, and not together."""

    inlined = False
    """Whether the piece is copied to where it is called."""

    def add_ir_module(self, ir_module: Any) -> None:
        """Take the code of the piece, which is one module. LLVM works on it beside numba's Python, on another core if
        there is one."""
        text = normalize_ir_text(str(ir_module))
        if _BESIDE:
            self._final_module, self._work = None, _BESIDE[-1].submit(self._simplified, text)
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


class _Kernel(JITCodeLibrary):
    """A kernel with all its pieces."""

    def add_llvm_module(self, ll_module: Any) -> None:
        """Take the module as it is, but for the kernel's own function, which is simplified as its pieces are."""
        for function in ll_module.functions:
            if not function.is_declaration and not function.name.startswith(_UNPACKING):
                _simplify(self._codegen, function)
        self._final_module.link_in(ll_module)

    def finalize(self) -> None:
        """Take in every piece once, whoever calls it."""
        done: set[Any] = set()
        for library in self._linking_libraries:
            if isinstance(library, _Unfinished):
                library.link_into(self._final_module, done)
        self._linking_libraries = [each for each in self._linking_libraries if each not in done]
        super().finalize()

    def _optimize_final_module(self) -> None:
        """With its pieces, once: one more round over the module would make Taylor 1 % faster and take a tenth of the
        wait. What unpacks the arguments runs once a scene, and is left as it is."""
        for function in self._final_module.functions:
            if function.name.startswith(_UNPACKING):
                function.add_function_attribute("noinline")
                function.add_function_attribute("optnone")
        super()._optimize_final_module()


class KernelCompiler(Compiler):
    """A `pipeline_class` for `numba.njit`: what it compiles is called from Python and made of pieces."""

    def compile_extra(self, func: Any) -> Any:
        """Compile a function and optimise it together with its pieces."""
        self.state.flags.no_cfunc_wrapper = True  # no kernel is called from C
        self.state.library = _Kernel(self.state.targetctx.codegen(), func.__qualname__)
        self.state.library.enable_object_caching()
        with nothing_twice(), ThreadPoolExecutor(1) as beside:
            _BESIDE.append(beside)
            try:
                return super().compile_extra(func)
            finally:
                _BESIDE.pop()


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
        context = self.state.targetctx
        self.state.library = _Unfinished(context.codegen(), func.__qualname__)
        self.state.library.inlined = self._inlined
        found = super().compile_extra(func)
        # Numba knows a compiled function by the object that Python would call.
        entry = _dynfunc.make_function(
            ModuleType(func.__module__), func.__name__, "", _REFUSAL, found.environment, (found.library,)
        )
        context.insert_user_function(entry, found.fndesc, [found.library])
        return found._replace(entry_point=entry)


_teach_builtins()
