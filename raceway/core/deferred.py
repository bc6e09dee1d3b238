"""Kernels in files that are read for the options of their classes, which takes no compiler."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, update_wrapper
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from raceway.core.jit import Kernel


class DeferredKernel:
    """A function whose kernel is made when it is first called for: ``three_halves()``."""

    def __init__(self, function: Callable[..., Any], signature: str) -> None:
        self._function, self._signature = function, signature
        update_wrapper(self, function)

    def __call__(self) -> Kernel:
        return self.kernel

    @cached_property
    def kernel(self) -> Kernel:
        from raceway.core import jit, signatures

        return jit.jit(getattr(signatures, self._signature))(self._function)


def deferred(signature: str) -> Callable[[Callable[..., Any]], Any]:
    """As ``jit`` with a signature of ``raceway.core.signatures``, by its name."""
    return lambda function: DeferredKernel(function, signature)
