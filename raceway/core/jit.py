"""The one decorator for compiled kernels, of the core and of third parties.

numba keys a cached function by its own source file alone: a kernel that calls a core function would keep calling
the old one after an edit.  So the cache lives in a folder named by a hash of the core's sources and of the versions
that produce machine code.  numba reads what it finds there as it is, and a damaged file ends the process: ``kernel_files``
keeps a digest beside each.  A folder that cannot be written is read through links in a temporary one; where there is
nothing to read, or others may write, kernels are compiled in memory, after one warning.  numba's global settings are left
as they were found.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numba

from raceway.errors import PluginError, RacewayError
from raceway.storage.cache_folder import current_folder
from raceway.storage.kernel_files import FilesOfKernel, KernelFolder, opened

if getattr(numba.config, "DISABLE_JIT", 0):
    raise RacewayError(
        "NUMBA_DISABLE_JIT is set: loops of hundreds of thousands of steps are compiled here, or take hours. Unset it."
    )
#: Seconds spent in compiling (until a run takes them) and in reading the cache, and how many kernels of each.
clock: dict[str, float] = {"compile_s": 0.0, "load_s": 0.0, "compiled": 0, "loaded": 0, "compile_processor_s": 0.0}


def working_clock() -> float:
    """Seconds of a clock that stands still while kernels compile; it jumps when compile seconds are taken."""
    return time.perf_counter() - clock["compile_s"]


def working_processor_time() -> float:
    """Processor time of this thread [s] without what its kernels took to compile."""
    return time.thread_time() - clock["compile_processor_s"]


def take_compile_seconds() -> float:
    """Seconds of compiling since the last call: each is billed to one run."""
    seconds, clock["compile_s"] = clock["compile_s"], 0.0
    return seconds


@cache
def kernel_folder() -> KernelFolder | None:
    """The folder that this process reads and writes compiled kernels in; None when there is none."""
    found = opened(current_folder())
    if isinstance(found, KernelFolder):
        return found
    warnings.warn(
        f"compiled kernels cannot be kept in {current_folder()} ({found}); compiling in memory, which costs some ten seconds "
        "a run. Set RACEWAY_CACHE_DIR to a folder of your own that can be written.",
        RuntimeWarning,
        stacklevel=2,
    )
    return None


@cache
def _warn_incomplete(place: Path, why: str) -> None:
    warnings.warn(
        f"{place} cannot be written ({why}) and lacks some kernels: they are compiled in memory at every run. Set "
        "RACEWAY_CACHE_DIR to a folder of your own that can be written.",
        RuntimeWarning,
        stacklevel=4,
    )


@contextmanager
def _numba_cache_in(folder: Path) -> Iterator[None]:
    config: Any = numba.config
    before = config.CACHE_DIR
    config.CACHE_DIR = str(folder)
    try:
        yield
    finally:
        config.CACHE_DIR = before


def jit(
    signature: Any, allocates: bool = False, inline: bool = False, releases: bool = False
) -> Callable[[Callable[..., Any]], Any]:
    """Compile a kernel for one explicit signature, now, through the cache.

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

    Raises
    ------
    PluginError
        When numba cannot compile the function for that signature; the message names function and file.

    Notes
    -----
    Division by zero gives an infinity or NaN, as in numpy, and is not an exception: an exception cannot leave a function
    pointer, and its check keeps loops from being vectorised.
    """
    options: dict[str, Any] = {"error_model": "numpy"}
    if not allocates and hasattr(numba.core.registry.cpu_target.options, "_nrt"):  # an option that numba does not promise
        options["_nrt"] = False
    if inline:
        options["forceinline"] = True
    if releases:
        options["nogil"] = True

    def decorate(function: Callable[..., Any]) -> Any:
        start, processor = time.perf_counter(), time.thread_time()
        try:
            kernel = _compile(function, signature, options)
        except (numba.core.errors.NumbaError, TypeError) as why:  # TypeError: another number of arguments
            code = function.__code__
            raise PluginError(
                f"kernel `{function.__qualname__}` ({Path(code.co_filename).name}, line {code.co_firstlineno}) does "
                f"not compile for the signature {signature_words(signature)}: {_reason(why, function, signature, options)}"
            ) from why
        hit = sum(kernel.stats.cache_hits.values()) > 0
        clock["load_s" if hit else "compile_s"] += time.perf_counter() - start
        clock["compile_processor_s"] += 0.0 if hit else time.thread_time() - processor
        clock["loaded" if hit else "compiled"] += 1
        return kernel

    return decorate


def signature_words(signature: Any) -> str:
    """A numba signature as one writes it: ``none(float64[::1], float64[:, ::1])``."""

    def word(kind: Any) -> str:
        if not isinstance(kind, numba.types.Array):
            return str(kind)
        last = "::1" if kind.layout == "C" else ":"
        return f"{kind.dtype}[{', '.join([':'] * (kind.ndim - 1) + [last])}]"

    return f"{signature.return_type}({', '.join(word(kind) for kind in signature.args)})"


def _reason(why: Exception, function: Callable[..., Any], signature: Any, options: dict[str, Any]) -> str:
    """The telling line of numba's report: not the name of the compiler pass, not the empty ones."""
    if "_nrt" in options:
        try:
            numba.njit(signature, error_model="numpy")(function)
            return "it creates arrays, which no kernel may; use the arrays that it is given, or scalars"
        except (numba.core.errors.NumbaError, TypeError):
            pass
    lines = [line.strip() for line in str(why).splitlines() if line.strip()]
    return next((line for line in lines if not line.startswith("Failed in")), "unknown reason")


def _compile(function: Callable[..., Any], signature: Any, options: dict[str, Any]) -> Any:
    folder = kernel_folder()
    if folder is None:
        return numba.njit(signature, **options)(function)
    files: FilesOfKernel | None = None
    for attempt in (1, 2):
        try:
            with _numba_cache_in(folder.path):
                if files is None:
                    files = FilesOfKernel(function, _place_of(function, options))
                    files.discard_damaged()
                kernel = numba.njit(signature, cache=True, **options)(function)
            if not kernel.stats.cache_hits:
                files.note_digests()
                if folder.unwritable:
                    _warn_incomplete(current_folder(), folder.unwritable)
            return kernel
        except (numba.core.errors.NumbaError, TypeError):
            raise
        except Exception as why:  # a full disk, or a damaged file: reading one may raise anything
            if attempt == 1 and files is not None:
                files.discard()
                continue
            warnings.warn(
                f"the kernel cache in {folder.path} did not serve `{function.__qualname__}` ({why}); compiled in memory",
                RuntimeWarning,
                stacklevel=3,
            )
            break
    return numba.njit(signature, **options)(function)


def _place_of(function: Callable[..., Any], options: dict[str, Any]) -> Path:
    """The folder that numba chooses for a function's files; it exists then."""
    dispatcher = numba.njit(**options)(function)
    dispatcher.enable_caching()
    return Path(dispatcher.stats.cache_path)
