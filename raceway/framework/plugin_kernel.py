"""Looks at a plug-in's compiled kernel before a loop takes it: numba's own words for a wrong one help nobody."""

from __future__ import annotations

from typing import TYPE_CHECKING

from raceway.core.jit import signature_words
from raceway.errors import PluginError, RacewayError

if TYPE_CHECKING:
    from numba.core.typing.templates import Signature

    from raceway.core.jit import Kernel
    from raceway.framework.contracts import ContactLaw, Excitation

#: Kernels that are compiled for the signature of their kind, by identity; they stay alive in it.
_LOOKED_AT: dict[int, tuple[object, Signature]] = {}


def plugin_kernel(plugin: ContactLaw | Excitation, kind: str, signature: Signature, name: str) -> Kernel:
    """The kernel of a plug-in, compiled for the signature of its kind.

    Parameters
    ----------
    plugin : with ``kernel()``;  kind : "contact law" or "excitation", for messages
    signature : ``raceway.core.signatures.LAW`` or ``FORCE``;  name : "LAW" or "FORCE"

    Raises
    ------
    PluginError
        ``kernel()`` raises, returns something that is not compiled, or is compiled for other arguments.
    """
    label = f"{kind} '{plugin.name}' ({type(plugin).__module__})"
    try:
        kernel = plugin.kernel()
    except RacewayError as why:
        raise PluginError(f"{label}: {why}") from why
    except (Exception, SystemExit) as why:  # a third party's own code
        raise PluginError(f"{label}: kernel() raises {type(why).__name__}: {why}") from why
    check_compiled(kernel, label, signature, name)
    return kernel


def check_compiled(kernel: object, label: str, signature: Signature, name: str) -> None:
    """Refuse what ``kernel()`` returned unless it is compiled for a signature; parameters as ``plugin_kernel``.

    Raises
    ------
    PluginError
        It is not compiled, or for other arguments.
    """
    if _LOOKED_AT.get(id(kernel)) == (kernel, signature):
        return
    remedy = f"decorate it with @jit({name}) of raceway.core.jit and raceway.core.signatures"
    try:
        compiled = getattr(kernel, "nopython_signatures", None)
    except RacewayError as why:  # its first use: it does not compile
        raise PluginError(f"{label}: {why}") from why
    if compiled is None:
        raise PluginError(f"{label}: kernel() returns {type(kernel).__name__}, which is not compiled: {remedy}")
    if not any(has.args == signature.args and has.return_type == signature.return_type for has in compiled):
        found = " or ".join(signature_words(has) for has in compiled) or "no signature"
        raise PluginError(f"{label}: its kernel has {found}, the rule is {signature_words(signature)}: {remedy}")
    _LOOKED_AT[id(kernel)] = kernel, signature
