"""What numba does otherwise for kernels: its compiler without needless passes, parts of callers without entry points, marks of sources."""

import gc
import hashlib
import marshal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib import import_module
from itertools import count
from pathlib import Path
from types import CodeType, FunctionType, ModuleType, SimpleNamespace
from typing import Any

import llvmlite.binding as llvm
import numba
from numba.core import base, environment, runtime, untyped_passes
from numba.core.bytecode import FunctionIdentity
from numba.core.codegen import CPUCodeLibrary, JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.cpu import CPUContext
from numba.core.registry import CPUDispatcher
from numba.core.serialize import dumps
from numba.core.targetconfig import ConfigStack
from numba.core.typed_passes import AnnotateTypes, DumpParforDiagnostics, NopythonRewrites
from numba.core.types.functions import BaseFunction
from numba.core.typing.templates import Signature, _OverloadFunctionTemplate

from raceway.storage.kernel_cache import SHARED

#: Objects that may wait for Python's search for cycles once kernels were compiled, and how many before.
_WAITING = 3_000_000
_thresholds: list[tuple[int, int, int]] = []


@contextmanager
def collector_off() -> Iterator[None]:
    """Python's search for cycles among the millions of small objects that numba makes takes a tenth of its time.

    Where it is on, it comes at the next of some million objects, so that it comes in few first runs: they take 0.1 GB more.
    """
    before = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if before:
            if not _thresholds:
                _thresholds.append(gc.get_threshold())
                gc.set_threshold(_WAITING, *_thresholds[0][1:])
                gc.callbacks.append(_search_as_before)
            gc.enable()


def _search_as_before(_phase: str, _counts: dict[str, int]) -> None:
    gc.set_threshold(*_thresholds.pop())
    gc.callbacks.remove(_search_as_before)


#: A part of numba's compiler, which types some of itself only.
Numba = Any
_Function: Numba = BaseFunction
_resolve = _Function.get_call_type
_base: Numba = base
_has_location = cache(_base._has_loc)
_size = cache(lambda target_data, kind: kind.get_abi_size(target_data))
#: Signatures and implementations of operators and functions of numba's own, by their arguments' types and the compiler's flags.
_resolved: dict[tuple[Numba, ...], tuple[Signature, Numba]] = {}


@cache
def _load_registries(context: Numba) -> None:
    """Let numba install what it can compile, once instead of for every function.

    As it is imported it asks for BLAS, which scipy would bring with 80 modules; kernels that multiply matrices ask again.
    """
    linalg: Numba = import_module("numba.np.linalg")
    ensure, linalg.ensure_blas = linalg.ensure_blas, lambda: None
    try:
        import_module("numba.np.arraymath")
    finally:
        linalg.ensure_blas = ensure
    _registries(context)


_cpu: Numba = CPUContext
_registries = _cpu.load_additional_registries


@contextmanager
def resolved_once() -> Iterator[None]:
    """numba tries some ten templates at each ``a + b`` and ``a[i]``, an eighth of the time that it compiles for; here once per types.

    Functions of numba's own become parts of their callers, once for all kernels that may allocate and once for the others.  Sizes of
    types are asked for once; neither what callers link nor modules of numba's own that parts come from are read with machine code.
    """

    def resolve(function: Numba, context: Numba, args: Numba, kws: Numba) -> Signature:
        flags = ConfigStack.top_or_none()
        options = None if flags is None else (flags.nrt, flags.error_model, str(flags.fastmath))
        key = function, args, tuple(kws.items()), options
        if key not in _resolved:
            signature = _resolve(function, context, args, kws)
            _resolved[key] = signature, function._impl_keys[signature.args]
        signature, implementation = _resolved[key]
        function._impl_keys[signature.args] = implementation
        return signature

    def compiler(_template: Numba) -> Numba:
        return lambda **options: lambda function: _Helper(function, targetoptions=options)

    def module(name: str) -> ModuleType:
        return import_module(name) if name in sys.modules or not name.startswith("numba.") else ModuleType(name)

    own: tuple[tuple[Numba, str, Numba], ...] = (
        (_Function, "get_call_type", resolve), (_OverloadFunctionTemplate, "_get_jit_decorator", compiler),
        (_base, "_has_loc", _has_location), (llvm.ffi.lib._lock, "_cblist", []), (CPUCodeLibrary, "_unserialize", _Cached.read),
        (_cpu, "load_additional_registries", _load_registries),
        (_base.BaseContext, "get_abi_sizeof", lambda context, kind: _size(context.target_data, kind)),
        (environment, "importlib", SimpleNamespace(import_module=module)),
    )  # fmt: skip
    before = [(holder, name, vars(holder)[name]) for holder, name, _ in own]
    for each in own:
        setattr(*each)
    try:
        yield
    finally:
        for each in before:
            setattr(*each)


@cache
def name_allocator() -> None:
    """Give machine code that is read its allocator; numba would install all that it can compile, in half a second."""
    allocator: Numba = runtime
    for name, address in allocator._nrt_python.c_helpers.items():
        llvm.add_symbol(name if name.startswith("_") else f"NRT_{name}", address)


@contextmanager
def numba_cache_in(folder: Path) -> Iterator[None]:
    config: Numba = numba.config
    before = config.CACHE_DIR
    config.CACHE_DIR = str(folder)
    try:
        yield
    finally:
        config.CACHE_DIR = before


@contextmanager
def numbered_from(base: str) -> Iterator[None]:
    """Number functions from a number of the kernel's own, by the name of its files.

    Symbols of machine code end in numba's count of the functions of a process.  Two variants of a closure that two processes compile
    may have one number, and so one symbol: a process that loads both would run the first one for either.
    """
    before = FunctionIdentity._unique_ids
    first = int.from_bytes(hashlib.blake2b(base.encode(), digest_size=7).digest(), "big")
    FunctionIdentity._unique_ids = count(first)
    try:
        yield
    finally:
        FunctionIdentity._unique_ids = before


#: For closures, ``with``, ``literal_unroll``, functions that are written into their callers, parallel loops, and one loop for several
#: operators of arrays: kernels have none of them.
_NEEDLESS = {
    AnnotateTypes, DumpParforDiagnostics, NopythonRewrites, untyped_passes.FindLiterallyCalls, untyped_passes.InlineClosureLikes,
    untyped_passes.InlineInlinables, untyped_passes.LiteralPropagationSubPipelinePass, untyped_passes.LiteralUnroll,
    untyped_passes.MakeFunctionToJitFunction, untyped_passes.RewriteDynamicRaises, untyped_passes.WithLifting,
}  # fmt: skip


class Compiler(CompilerBase):
    """numba's, without passes that kernels of the core do not need."""

    def define_pipelines(self) -> list[Numba]:
        passes: Numba = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.passes = [each for each in passes.passes if each[0] not in _NEEDLESS]
        passes.finalize()
        return [passes]


Dispatcher: Numba = CPUDispatcher

#: Modules whose kernels need no more than ``Compiler`` does, and whose sources name the folders of compiled kernels.
CORE_MODULES = tuple(f"raceway.{folder.replace('/', '.')}." for folder in SHARED)


def marks(value: Numba, above: list[Numba]) -> Any:
    """Of a function, or of what a closure holds, all that decides machine code, the same in every process.

    numba's own mark of a function in a closure is a random number: kernels around it would never be found again.  ``above`` : functions
    that hold it, for one that calls itself.
    """
    function = getattr(value, "py_func", value)
    if not isinstance(function, FunctionType):
        return dumps(value)
    if function in above:
        return above.index(function)
    code, cells = function.__code__, [marks(cell.cell_contents, [*above, function]) for cell in function.__closure__ or ()]
    stamp: object = None
    if f"{function.__module__}.".startswith(CORE_MODULES):  # whose sources name the folder, wherever they lie
        code = _without_place(code)
    else:
        with suppress(OSError):  # a file that is changed changes globals, too
            status = Path(code.co_filename).stat()
            stamp = status.st_mtime_ns, status.st_size
    options = str(getattr(value, "signature", "")), sorted(getattr(value, "targetoptions", {}).items())
    return function.__module__, marshal.dumps(code, 2), function.__defaults__, stamp, options, cells


def _without_place(code: CodeType) -> CodeType:
    inner = tuple(_without_place(const) if isinstance(const, CodeType) else const for const in code.co_consts)
    return code.replace(co_filename="", co_consts=inner)


class _Cached(JITCodeLibrary):
    """Machine code that was read, with the bytes of what callers link until one is compiled."""

    _shared_module: Numba

    @staticmethod
    def read(codegen: Numba, state: Numba) -> Numba:
        name, _, (code, linked) = state
        library = codegen.create_library(name)
        library.__class__, library._shared_module = _Cached, linked
        library.enable_object_caching()
        library._set_compiled_object(code)
        library._finalize_final_module()
        return library

    def _get_module_for_linking(self) -> Numba:
        if isinstance(self._shared_module, bytes):
            self._shared_module = llvm.parse_bitcode(self._shared_module)
        return self._shared_module

    def get_pointer_to_function(self, name: str) -> int:
        return int(self._codegen._engine.get_function_address(name))


class _Linked(JITCodeLibrary):
    """Code that is linked into callers only: no machine code is made of it."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True


class Inlined(Dispatcher):
    """Code that has no entry points for Python and pointers either: a first run takes a quarter less."""

    @staticmethod
    def _flags(flags: Numba) -> Numba:
        flags.no_compile = flags.no_cpython_wrapper = flags.no_cfunc_wrapper = True
        return flags

    def add_overload(self, cres: Numba) -> None:
        cres.library.__class__ = _Linked
        self.overloads[tuple(cres.signature.args)] = cres = cres._replace(entry_point=object())
        self.targetctx.insert_user_function(cres.entry_point, cres.fndesc, [cres.library])


class _Helper(Inlined):
    """A function of numba's own as a part of kernels."""

    def __init__(self, function: Numba, targetoptions: Numba) -> None:
        super().__init__(function, targetoptions=targetoptions)
        self._compiler._customize_flags = self._flags
