"""CUDA devices: whether there is one, and functions for its kernels, made of the sources of the CPU's kernels.

Nothing here loads a CUDA library before it is called.  With NUMBA_ENABLE_CUDASIM=1 numba runs kernels as Python, for tests.
"""

from __future__ import annotations

import math
import types
from collections.abc import Callable
from functools import cache
from time import perf_counter
from typing import Any

import numpy as np
from numba.core.types import Type

from raceway.core.deferred import DeferredKernel
from raceway.core.jit import Kernel
from raceway.errors import PluginError, extra

#: Bytes of the copies that tell how fast a device's memory is, and how many are timed.
_COPIED, _COPIES = 1 << 26, 5
#: Threads of a block; in the simulator, which makes a thread of Python of each.
_BLOCK, _SIMULATED = 128, 2
#: What the functions of kernels may name beside each other.
_PLAIN = (int, float, bool, tuple, types.BuiltinFunctionType, np.ufunc, type, Type)
#: numpy as devices know it: they have these functions of numbers by another name.
_NUMPY = types.ModuleType("numpy")
_NUMPY.__dict__.update(
    vars(np) | {name: getattr(math, name) for name in ("sqrt", "exp", "log", "log2", "log10", "expm1", "log1p")}
)


def cuda() -> Any:
    """numba.cuda, which the extra ``gpu`` brings; ImportError: a numba without it."""
    from numba import cuda as module

    return module


@cache
def absent() -> str:
    """Why there is no CUDA device; empty where there is one."""
    try:
        module = cuda()
        if module.is_available():
            return ""
        module.current_context()
    except Exception as why:  # of drivers and libraries, of whatever class
        lines = [line.strip() for line in str(why).splitlines() if line.strip(" :")]
        return " ".join(lines[:2]).rstrip(".:") or type(why).__name__
    return "the driver names none"


def title() -> str:
    """The device's name."""
    return "CUDA simulator" if simulated() else str(cuda().get_current_device().name)


def free_bytes() -> float:
    """Memory of the device that is free."""
    return float(cuda().current_context().get_memory_info()[0])


def need_bytes(cells: int, nodes: int) -> int:
    """Memory of the device that explicit steps of hexahedra take: forces, corners, twice, of an element; seven vectors of a node."""
    return cells * (24 * 8 + 2 * 8 * 4 + 4) + nodes * (7 * 24 + 8 + 3 * 4)


def refusal(cells: int, nodes: int, law: Kernel) -> str:
    """Why a device does not take explicit steps of so many hexahedra with a contact law; empty where it does."""
    if reason := absent():
        return f"finds no CUDA device ({reason}): install its driver, and numba-cuda by {extra('gpu')}"
    try:
        device_function(law)
    except PluginError as fault:
        return f"cannot run the contact law: {fault}"
    need, free = need_bytes(cells, nodes), free_bytes()
    if need > free:
        return f"has {free / 2**30:.2g} GiB free, and {cells} elements take {need / 2**30:.2g} GiB: use larger elements"
    return ""


def together(kernel: Any, arguments: tuple[Any, ...]) -> Any:
    """A kernel whose threads wait for each other, with as many as run at once."""
    if simulated():
        return kernel[1, _SIMULATED]
    special = kernel.specialize(*arguments)
    (compiled,) = special.overloads.values()
    return special[compiled.max_cooperative_grid_blocks(_BLOCK), _BLOCK]


@cache
def bandwidth() -> float:
    """Bytes that the device reads and writes in a second, of the quickest of some copies."""
    module = cuda()
    source = module.to_device(np.zeros(_COPIED // 8))
    target, seconds = module.device_array_like(source), []
    for _ in range(_COPIES):
        module.synchronize()
        start = perf_counter()
        target.copy_to_device(source)
        module.synchronize()
        seconds.append(perf_counter() - start)
    return 2.0 * _COPIED / min(seconds)


def device_source(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function with device functions for the kernels and functions that it names."""
    code = function.__code__
    named = {name: function.__globals__[name] for name in code.co_names if name in function.__globals__}
    closed = dict(zip(code.co_freevars, (cell.cell_contents for cell in function.__closure__ or ()), strict=True))
    named, closed = ({name: _translated(function, name, value) for name, value in each.items()} for each in (named, closed))
    cells = tuple(map(types.CellType, closed.values()))
    made = types.FunctionType(code, named | {"__builtins__": __builtins__}, function.__name__, None, cells)
    made.__module__, made.__qualname__ = function.__module__, function.__qualname__
    return made


@cache
def device_function(kernel: Kernel | Callable[..., Any]) -> Any:
    """A kernel, or a plain function, as kernels of the device call it; PluginError: it names what no device can run."""
    compiled = cuda().jit(device=True)(device_source(kernel.py_func if isinstance(kernel, Kernel) else kernel))
    return getattr(compiled, "fn", compiled)  # of the simulator the function itself, which is much quicker


@cache
def simulated() -> bool:
    """Whether kernels run as Python."""
    return bool(cuda().config.ENABLE_CUDASIM)


def _translated(function: Callable[..., Any], name: str, value: object) -> object:
    if isinstance(value, DeferredKernel):
        value = value()
    if isinstance(value, (Kernel, types.FunctionType)):
        return device_function(value)
    if value is np:
        return np if simulated() else _NUMPY
    if isinstance(value, _PLAIN) or value is math or value is cuda():
        return value
    raise PluginError(
        f"kernel `{function.__qualname__}` has no device function: it names `{name}`, {type(value).__name__}, and devices run "
        "numbers, numpy's and math's functions and other kernels only. Use integrator.device = 'cpu'"
    )
