"""Compiled kernels as plain addresses, for solvers that call short compiled loops many times.

Notes
-----
Handing a dispatcher to a compiled loop as a function pointer costs numba some 35 microseconds a call, in which it looks up
the machine code by the signature again; an address whose type is at hand costs 3.  For a loop of milliseconds that is nothing; a periodic motion
is solved for in a few dozen calls of 50 microseconds each.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import attrs
from numba import types
from numba.experimental.function_type import _get_wrapper_address
from numba.extending import typeof_impl

from raceway.core.ring.system import System
from raceway.core.signatures import FORCE_POINTER, LAW_POINTER, SYSTEM_POINTER


class Address(types.WrapperAddressProtocol):
    """A kernel of one signature, its machine code looked up once; can be called from Python too."""

    def __init__(self, kernel: Any, pointer: Any) -> None:
        self.pointer = pointer
        self._kernel, self._signature = kernel, pointer.signature
        self._address = _get_wrapper_address(kernel, pointer.signature)

    def __wrapper_address__(self) -> int:
        return self._address

    def signature(self) -> Any:
        return self._signature

    def __call__(self, *arguments: Any) -> Any:
        return self._kernel(*arguments)


@typeof_impl.register(Address)
def _type_of(address: Address, _context: Any) -> Any:
    """The type that the address was made for; numba would make an equal one anew in every call."""
    return address.pointer


@lru_cache(maxsize=64)
def _address(kernel: Any, pointer: Any) -> Address:
    return kernel if isinstance(kernel, Address) else Address(kernel, pointer)


def plain(kernel: Any) -> Any:
    """The kernel itself, for others that are compiled around it: around an address they could not be kept."""
    return kernel._kernel if isinstance(kernel, Address) else kernel


def by_address(system: System) -> System:
    """The same system with its kernels as addresses."""
    kernel = _address(system.kernel, SYSTEM_POINTER)
    # Identity of the two kernels tells whether forces have a potential.
    base = kernel if system.conservative else _address(system.base_kernel, SYSTEM_POINTER)
    return attrs.evolve(
        system,
        kernel=kernel,
        base_kernel=base,
        law=_address(system.law, LAW_POINTER),
        force=_address(system.force, FORCE_POINTER),
    )
