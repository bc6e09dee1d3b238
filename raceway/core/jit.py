"""The one decorator for compiled kernels, of the core and of third parties.

numba keys a cached function by its own source file alone: a kernel that calls a core function would keep calling
the old one after an edit.  So the cache lives in a folder named by a hash of the core's sources and of the versions
that produce machine code.  numba reads what it finds there as it is, and a damaged file ends the process: ``kernel_cache``
keeps a digest beside each.  A folder that cannot be written is read through links in a temporary one; where there is
nothing to read, or others may write, kernels are compiled in memory, after one warning.  numba's global settings are left
as they were found.
"""

import hashlib
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from functools import cache, cached_property
from importlib import import_module
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core.caching import IndexDataCacheFile, NullCache
from numba.core.compiler import CompileResult
from numba.core.compiler_lock import global_compiler_lock
from numba.core.typing.templates import Signature

from raceway.core import compiler, wheel_kernels
from raceway.core.compiler import Dispatcher, Numba
from raceway.core.signatures import Pointer, signature_words
from raceway.errors import PluginError, RacewayError
from raceway.storage.kernel_cache import FilesOfKernel, OpenFolder, current_folder, opened

if getattr(numba.config, "DISABLE_JIT", 0):
    raise RacewayError(
        "NUMBA_DISABLE_JIT is set: loops of hundreds of thousands of steps are compiled here, or take hours. Unset it."
    )
#: Seconds spent in compiling (until a run takes them) and in reading the cache, how many kernels of each, and how many of those
#: compiled could not be kept.
clock: dict[str, float] = {
    "compile_s": 0.0, "load_s": 0.0, "compiled": 0, "loaded": 0, "of_wheel": 0, "unkept": 0, "compile_processor_s": 0.0
}  # fmt: skip
#: Kernels that another process compiles into the cache, "module:name", each with what yields their names as they are finished.
awaited: dict[str, Iterator[str]] = {}


def working_clock() -> float:
    """Seconds of a clock that stands still while kernels compile; it jumps when compile seconds are taken."""
    return time.perf_counter() - clock["compile_s"]


def working_processor_time() -> float:
    """Processor time of this thread [s] without what its kernels took to compile."""
    return time.thread_time() - clock["compile_processor_s"]


def working_process_time() -> float:
    """Processor time of all threads [s] without what kernels took to compile."""
    return time.process_time() - clock["compile_processor_s"]


def take_compile_seconds() -> float:
    """Seconds of compiling since the last call: each is billed to one run."""
    seconds, clock["compile_s"] = clock["compile_s"], 0.0
    return seconds


@cache
def kernel_folder() -> OpenFolder | None:
    """The folder that this process reads and writes compiled kernels in; None when there is none."""
    folder = opened(current_folder())
    if isinstance(folder, OpenFolder):
        return folder
    remedy = "compiling in memory, which costs some ten seconds a run. Set RACEWAY_CACHE_DIR to a writable folder of yours."
    words = f"compiled kernels cannot be cached in {current_folder()} ({folder}); {remedy}"
    warnings.warn(words, RuntimeWarning, stacklevel=2)
    return None


@cache
def _warn_incomplete(folder: Path, why: str) -> None:
    remedy = "Set RACEWAY_CACHE_DIR to a folder of your own that can be written."
    words = f"{folder} cannot be written ({why}) and lacks some kernels: they are compiled in memory at every run. {remedy}"
    warnings.warn(words, RuntimeWarning, stacklevel=4)


class Kernel(Dispatcher):
    """A function that is compiled for its one signature, or read from the cache, at its first use.

    That is a call from Python, its address being taken, or the compiling of a kernel that calls it.

    signature : the numba signature
    """

    def __init__(self, function: Callable[..., Any], signature: Signature, options: dict[str, Any]) -> None:
        if function.__module__.startswith(compiler.CORE_MODULES):
            super().__init__(function, targetoptions=options, pipeline_class=compiler.Compiler)
        else:
            super().__init__(function, targetoptions=options)
        self.signature = signature
        self._compiler._customize_flags = self._flags
        self._of_wheel = False

    @staticmethod
    def _flags(flags: Numba) -> Numba:
        """Without the entry point that C calls: no kernel is called by that."""
        flags.no_cfunc_wrapper = True
        return flags

    def compile(self, sig: object = None) -> Numba:
        """The machine code's entry point, for ``signature`` whatever is asked for; numba's own calls come here, too."""
        with global_compiler_lock:  # numba's, not one of our own: kernels of others may call this one
            if self._can_compile:
                with compiler.collector_off(), compiler.resolved_once():
                    self._make()
        return self.overloads[tuple(self.signature.args)].entry_point

    @cached_property
    def address(self) -> int:
        """Where its machine code begins, for kernels that it is an argument of."""
        self.compile()
        code = self.overloads[tuple(self.signature.args)]
        return int(code.library.get_pointer_to_function(code.fndesc.llvm_func_name))

    @property
    def nopython_signatures(self) -> list[Any]:
        self.compile()
        return list(super().nopython_signatures)

    def get_compile_result(self, sig: object) -> Numba:
        self.compile()
        return super().get_compile_result(sig)

    def get_call_template(self, args: Numba, kws: Numba) -> Numba:
        """The types of a call by a kernel that is being compiled, which takes a part where this kernel is not compiled by itself."""
        return super().get_call_template(args, kws) if self._links else self._part.get_call_template(args, kws)

    def get_overload(self, sig: object) -> Numba:
        return super().get_overload(sig) if self._links else self._part.get_overload(sig)

    @property
    def _links(self) -> bool:
        """Whether callers link this kernel's code; that of a wheel is another processor's, in whose bits the order of first uses would show."""
        return bool(self.overloads) and not self._of_wheel

    @cached_property
    def _part(self) -> "_Part":
        return _Part(self.py_func, self.signature, self.targetoptions)

    def _compile_for_args(self, *_arguments: object, **_keywords: object) -> "Kernel":
        """What numba calls next with the arguments of a first call: this, which checks their types."""
        self.compile()
        return self

    def __reduce__(self) -> Any:
        """By name, uncompiled, where it has one: a cached kernel made around it is found again by this."""
        module, name = self.py_func.__module__, self.py_func.__qualname__
        found = getattr(sys.modules.get(module), name, None)
        if getattr(found, "kernel", found) is self:  # of a file that is read without this module
            return kernel_named, (module, name)
        return super().__reduce__()

    def _reduce_states(self) -> dict[str, Any]:
        return {"function": self.py_func, "signature": self.signature, "options": self.targetoptions, "uuid": self._uuid}

    @classmethod
    def _rebuild(cls, function: Callable[..., Any], signature: Signature, options: dict[str, Any], uuid: str) -> "Kernel":
        if (kernel := cls._memo.get(uuid)) is None:
            kernel = cls(function, signature, options)
            kernel._set_uuid(uuid)
        return kernel

    @property
    def kept(self) -> bool:
        """Whether its machine code is there, or in the cache."""
        folder = kernel_folder()
        if self.overloads or folder is None:
            return bool(self.overloads)
        with compiler.numba_cache_in(folder.path):
            return self._open_cache().complete

    def _make(self) -> None:
        function, time_before = self.py_func, clock["compile_s"] + clock["load_s"]
        start, processor, processor_billed = time.perf_counter(), time.thread_time(), clock["compile_processor_s"]
        name = f"{function.__module__}:{function.__qualname__}"
        finished = awaited.pop(name, None)
        any(other == name for other in finished or ())  # waits for it
        try:
            if not self._from_wheel():
                self._through_cache()
        except (numba.core.errors.NumbaError, TypeError) as why:  # TypeError: another number of arguments
            code = function.__code__
            raise PluginError(
                f"kernel `{function.__qualname__}` ({Path(code.co_filename).name}, line {code.co_firstlineno}) does not "
                f"compile for the signature {signature_words(self.signature)}: {self._reason(why)}"
            ) from why
        self.disable_compile()
        hit = finished is None and (self._of_wheel or sum(self.stats.cache_hits.values()) > 0)
        # Kernels that this one calls were compiled meanwhile, and have told their own seconds.
        clock["load_s" if hit else "compile_s"] += (
            time.perf_counter() - start - (clock["compile_s"] + clock["load_s"] - time_before)
        )
        if not hit:
            clock["compile_processor_s"] = processor_billed + time.thread_time() - processor
        clock["loaded" if hit else "compiled"] += 1

    @cached_property
    def _digest(self) -> str:
        """Of all that decides the machine code beside signature and processor."""
        return hashlib.sha256(repr(compiler.marks(self.py_func, [])).encode()).hexdigest()

    def _from_wheel(self) -> bool:
        """Take the machine code that came with the package, if it has this kernel's."""
        name = f"{self.py_func.__module__}.{self.py_func.__qualname__}"
        if not name.startswith(compiler.CORE_MODULES) or (wheel_kernels.folder() is None and not wheel_kernels.writing):
            return False
        marks = str(self.signature), self._digest
        if wheel_kernels.writing:
            self._through_cache()
            wheel_kernels.write(name, marks, self.overloads[tuple(self.signature.args)]._reduce())
            return True
        if (payload := wheel_kernels.read(name, marks)) is None:
            return False
        compiler.name_allocator()
        code: Numba = CompileResult._rebuild(self.targetctx, *payload)
        self.targetctx.insert_user_function(code.entry_point, code.fndesc, [code.library])
        self.add_overload(code)
        self._of_wheel = True
        clock["of_wheel"] += 1
        return True

    def _through_cache(self) -> None:
        folder = kernel_folder()
        if folder is None:
            clock["unkept"] += 1
            super().compile(self.signature)
            return
        for attempt in (1, 2):
            files: FilesOfKernel | None = None
            try:
                with compiler.numba_cache_in(folder.path):
                    files = self._open_cache()
                    files.discard_damaged()
                    with compiler.numbered_from(files.base):
                        super().compile(self.signature)
                if not self.stats.cache_hits:
                    files.note_digests()
                    if folder.unwritable:
                        clock["unkept"] += 1
                        _warn_incomplete(current_folder(), folder.unwritable)
                return
            except (numba.core.errors.NumbaError, TypeError, RacewayError):
                raise
            except Exception as why:  # a full disk, or a damaged file: reading one may raise anything
                if files is not None:
                    files.discard()
                if attempt == 2 or self.overloads:
                    words = f"the kernel cache in {folder.path} did not serve `{self.py_func.__qualname__}` ({why}); compiled in memory"
                    warnings.warn(words, RuntimeWarning, stacklevel=3)
        self._cache = NullCache()
        clock["unkept"] += 1
        super().compile(self.signature)

    def _open_cache(self) -> FilesOfKernel:
        """Let numba read and write files of this kernel's own.

        numba numbers the data files of all variants of a closure in one index: of two processes that compile two variants at
        once each would take the same number, and the index of one would name the machine code of the other.
        """
        self.enable_caching()
        cache_: Numba = self._cache
        cache_.load_overload = cache_._load_overload  # numba's own installs all that it can compile first
        compiler.name_allocator()
        machine = self.targetctx.codegen().magic_tuple()
        key = self.signature, machine, self._digest
        cache_._index_key = lambda signature, codegen: key
        base = f"{cache_._impl.filename_base}.{hashlib.blake2b(repr(key).encode(), digest_size=8).hexdigest()}"
        cache_._cache_file = IndexDataCacheFile(cache_.cache_path, base, cache_._impl.locator.get_source_stamp())
        return FilesOfKernel(base, Path(cache_.cache_path))

    def _reason(self, why: Exception) -> str:
        """The telling line of numba's report: not the name of the compiler pass, not the empty ones."""
        if "_nrt" in self.targetoptions:
            try:
                numba.njit(self.signature, error_model="numpy")(self.py_func)
                return "it creates arrays, which kernels must not: use its array arguments, or scalars"
            except (numba.core.errors.NumbaError, TypeError):
                pass
        lines = [line.strip() for line in str(why).splitlines() if line.strip()]
        return next((line for line in lines if not line.startswith("Failed in")), "unknown reason")


class _Part(compiler.Inlined, Kernel):
    """A kernel as a part of those that call it, without files of its own."""

    get_call_template, get_overload = Dispatcher.get_call_template, Dispatcher.get_overload

    def _from_wheel(self) -> bool:
        return False

    def _through_cache(self) -> None:
        folder = kernel_folder()
        if folder is None:
            Dispatcher.compile(self, self.signature)
            return
        with compiler.numba_cache_in(folder.path):
            base = self._open_cache().base
        self._cache = NullCache()
        with compiler.numbered_from(f"{base}.part"):
            Dispatcher.compile(self, self.signature)


class _DirectKernel(Kernel):
    """A kernel with named tuples or kernels among its arguments, called from Python without numba's search for a matching signature.

    That search takes 50 microseconds for nested tuples.  numba itself checks of an array what size its numbers have, but not
    that they lie one behind the other.
    """

    _entry = cached_property(Kernel.compile)

    def __call__(self, *arguments: Any) -> Any:
        _prepare(arguments, self.py_func.__name__)
        return self._entry(*arguments)


def _prepare(values: tuple[Any, ...], name: str) -> None:
    """Refuse arrays with strides; compile kernels, while another process may be compiling the one that takes them."""
    for value in values:
        if isinstance(value, np.ndarray):
            if not value.flags.c_contiguous:
                raise PluginError(f"kernel `{name}` got an array that is not C-contiguous: pass np.ascontiguousarray(...)")
        elif isinstance(value, tuple):
            _prepare(value, name)
        elif isinstance(value, Kernel) and not value.overloads:
            value.compile()


def kernel_named(module: str, name: str) -> Kernel:
    """A kernel of a module, imported."""
    found = getattr(import_module(module), name)
    return found if isinstance(found, Kernel) else found.kernel


def jit(
    signature: Signature, allocates: bool = False, inline: bool = False, releases: bool = False
) -> Callable[[Callable[..., Any]], Kernel]:
    """Make a function a kernel of one explicit signature, compiled at its first use, through the cache.

    Parameters
    ----------
    signature : numba signature
        For instance ``raceway.core.signatures.LAW``.
    allocates : whether the kernel may create arrays
        Time loops do, once; laws, excitations and bodies may not: without allocation numba counts no references, and
        those atomic operations take as long as the arithmetic of a whole step.
    inline : whether LLVM must write the function into its callers
        For the parts of an element's arithmetic: a loop that calls is not vectorised.
    releases : whether the kernel lets other Python threads run meanwhile

    Notes
    -----
    A function that numba cannot compile for the signature raises ``PluginError`` at its first use; the message names
    function and file.

    Division by zero gives an infinity or NaN, as in numpy, and is not an exception: an exception cannot leave a function
    pointer, and its check keeps loops from being vectorised.

    Examples
    --------
    A linear spring; gaps [m] are negative where bodies overlap, forces are in N:

    >>> from raceway import LAW, jit
    >>> @jit(LAW)
    ... def spring(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    ...     for i in range(gap.size):
    ...         touching = gap[i] < 0.0
    ...         force[i] = -params[i, 0] * gap[i] if touching else 0.0
    ...         d_gap[i] = -params[i, 0] if touching else 0.0
    ...         d_rate[i] = 0.0
    """
    options: dict[str, Any] = {"nopython": True, "error_model": "numpy"}
    if not allocates and hasattr(numba.core.registry.cpu_target.options, "_nrt"):  # an option that numba does not promise
        options["_nrt"] = False
    if inline:
        options["forceinline"] = True
    if releases:
        options["nogil"] = True
    direct = any(isinstance(kind, (numba.types.BaseNamedTuple, Pointer)) for kind in signature.args)
    return lambda function: (_DirectKernel if direct else Kernel)(function, signature, options)
