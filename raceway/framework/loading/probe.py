"""Calls a plug-in's kernel a few times before a run, so that a broken one is refused by name and not met inside a loop.

This takes less than a millisecond.  It finds what would corrupt a run; ``raceway dev check-plugin`` finds the rest.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from raceway.core.jit import Kernel
from raceway.core.signatures import FORCE, LAW, signature_words
from raceway.errors import PluginError, RacewayError
from raceway.framework.contracts import ContactLaw, Excitation
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from numba.core.typing.templates import Signature

#: Kernels that are compiled for the signature of their kind, by identity; they stay alive in it.
_LOOKED_AT: dict[int, tuple[object, Signature]] = {}


def plugin_kernel(plugin: ContactLaw | Excitation, kind: str, signature: Signature, name: str) -> Kernel:
    """The kernel of a plug-in, compiled for the signature of its kind.

    PluginError: ``kernel()`` raises, returns something that is not compiled, or is compiled for other arguments.

    plugin : with ``kernel()``;  kind : "contact law" or "excitation", for messages
    signature : ``raceway.core.signatures.LAW`` or ``FORCE``;  name : "LAW" or "FORCE"
    """
    label = f"{kind} '{plugin.name}' ({type(plugin).__module__})"
    try:
        kernel = plugin.kernel()
    except RacewayError as why:
        raise PluginError(f"{label}: {why}") from why
    except (Exception, SystemExit) as why:  # a third party's own code
        raise PluginError(f"{label}: kernel() raises {type(why).__name__}: {why}") from why
    _check_compiled(kernel, label, signature, name)
    return _kernel_of(kernel, signature)


@lru_cache(maxsize=64)
def _kernel_of(function: Kernel, signature: Signature) -> Kernel:
    """A function that numba's own decorator compiled as a kernel; a kernel itself."""
    return function if isinstance(function, Kernel) else Kernel(function.py_func, signature, dict(function.targetoptions))


def _check_compiled(kernel: object, label: str, signature: Signature, name: str) -> None:
    """Refuse what ``kernel()`` returned unless it is compiled for a signature; parameters as ``plugin_kernel``.

    PluginError: it is not compiled, or for other arguments.
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
        signatures = " or ".join(signature_words(has) for has in compiled) or "no signature"
        raise PluginError(f"{label}: its kernel has {signatures}, the rule is {signature_words(signature)}: {remedy}")
    _LOOKED_AT[id(kernel)] = kernel, signature


#: Gaps [m] and rates [m/s] that are tried, all contacts at once.
_GAPS = (1e-3, 1e-9, 0.0, -1e-9, -1e-6, -1e-5)
_RATES = (0.0, -0.02, 0.02)
#: Relative step of the differences that slopes are held against, and how far they may be apart: the force is not a line, and
#: one side of a kink may be given.
_STEP, _SLOPE = 1e-4, 1e-3
#: Stands in outputs before a call; no force is so small.
_MARK = -7.25e-301
#: Probes that found nothing, by all that their outcome follows from: neighbours in a study repeat them.  How many are remembered.
_PASSED: set[tuple[Hashable, ...]] = set()
_MOST_PASSED = 4096
#: The last law that passed, by its kernel: what it was tried with; parameters and depths that differ less try nothing new.
_LAST_LAW: dict[Kernel, tuple[ContactLaw, np.ndarray, np.ndarray, np.ndarray]] = {}
_NEAR = 0.05


def probe_law(law: ContactLaw, kernel: Kernel, params: np.ndarray, state: np.ndarray, depths: Iterable[float] = ()) -> None:
    """Refuse a contact law that breaks its contract on a few gaps and rates: ``PluginError`` with what was found, and the contract.

    law : the plug-in, for its name;  kernel : what its ``kernel()`` returned
    params : what its ``build()`` returned, (n, k);  state : (n, m), a row for each contact; not changed
    depths : approaches [m] of the scene at hand, tried besides the fixed ones
    """
    depths = tuple(float(depth) for depth in depths if depth > 0.0)
    if _passed_near(law, kernel, params, state, np.array(depths)):
        return
    mark = _mark(kernel, params, state, depths)
    if mark in _PASSED:
        return
    who = _who("contact law", law)
    n = len(state)
    _check_array(params, who, "build()", f"({n}, k): a row for each contact", (n, None))
    _check_compiled(kernel, who, LAW, "LAW")
    state = np.ascontiguousarray(state, dtype=float)
    _probe_alone(kernel, params, state, who)  # first: what lies behind all rows may be anything
    for gap in (*_GAPS, *(-depth for depth in depths)):
        for rate in _RATES:
            where = f"at gap {gap:g} m, rate {rate:g} m/s"
            force, d_gap, d_rate, new = _call_law(kernel, params, state, gap, rate, who, where)
            outputs = {"force": force, "d_gap": d_gap, "d_rate": d_rate, "state_new": new}
            _check_outputs(outputs, who, where)
            if gap >= 0.0 and force.any():
                worst = force[np.argmax(np.abs(force))]
                raise PluginError(f"{who}: force {worst:.4g} {where}, outside contact; the contract says zero for gap >= 0")
            if (force < 0.0).any():
                raise PluginError(f"{who}: force {force.min():.4g} {where}; the contract says never negative")

    for depth in depths or (-min(_GAPS),):
        _probe_slopes(kernel, params, state, -depth, _RATES[1], who)
    _remember(mark)
    _LAST_LAW[kernel] = law, params.copy(), state.copy(), np.array(depths)


def _passed_near(law: ContactLaw, kernel: Kernel, params: np.ndarray, state: np.ndarray, depths: np.ndarray) -> bool:
    """Whether the same law with the same options passed at parameters and depths that differ by less than ``_NEAR`` of themselves."""
    last = _LAST_LAW.get(kernel)
    if last is None or last[0] != law or not np.array_equal(last[2], state) or not isinstance(params, np.ndarray):
        return False
    for now, then in ((params, last[1]), (depths, last[3])):
        if now.shape != then.shape or not (np.abs(now - then) <= _NEAR * np.abs(then)).all():
            return False
    return True


def _probe_slopes(kernel: Kernel, params: np.ndarray, state: np.ndarray, gap: float, rate: float, who: str) -> None:
    """Refuse derivatives that differences of the force contradict: with them an iteration converges, if it does, to a wrong stiffness."""
    where = f"at gap {gap:g} m, rate {rate:g} m/s"
    force, *slopes, _ = _call_law(kernel, params, state, gap, rate, who, where)
    for word, slope, step in (("d_gap", slopes[0], (_STEP * gap, 0.0)), ("d_rate", slopes[1], (0.0, _STEP * rate))):
        size = abs(sum(step))
        sides = []
        for sign in (1.0, -1.0):
            beside = _call_law(kernel, params, state, gap + sign * abs(step[0]), rate + sign * abs(step[1]), who, where)[0]
            sides.append(sign * (beside - force) / size)
        low, high = np.minimum(*sides), np.maximum(*sides)
        # Rounding of the differences: 1e-16 of the force over the step.
        slack = _SLOPE * np.maximum(np.abs(low), np.abs(high)) + 1e-12 * np.abs(force) / size
        off = np.maximum(low - slack - slope, slope - high - slack)
        if len(off) and off.max() > 0.0:
            worst = int(np.argmax(off))
            words = f"`{word}` = {slope[worst]:.6g} {where}, where differences of the force give {high[worst]:.6g}"
            raise PluginError(f"{who}: {words}; the contract says the derivative, memory held")


def probe_excitation(excitation: Excitation, kernel: Kernel, params: np.ndarray) -> None:
    """Refuse an excitation that breaks its contract at a few times.

    kernel : what its ``kernel()`` returned;  params : what its ``parameters()`` returned, (k,)

    PluginError: As ``probe_law``.
    """
    period = excitation.period_s or 1.0 / excitation.frequency_hz
    mark = _mark(kernel, params, period)
    if mark in _PASSED:
        return
    who = _who("excitation", excitation)
    _check_array(params, who, "parameters()", "(k,)", (None,))
    _check_compiled(kernel, who, FORCE, "FORCE")
    for part in (0.0, 0.13, 0.5, 3.7):
        out = np.full(5, _MARK)
        where = f"at t = {part * period:g} s"
        _guarded(kernel, who, where, {"params": params}, part * period, params, out)
        _check_outputs({"out": out}, who, where)
    _remember(mark)


def _mark(kernel: Kernel, *arguments: object) -> tuple[Hashable, ...]:
    """A kernel, which stays alive in it, and what it is tried with, arrays by content."""
    return kernel, *(_content(argument) for argument in arguments)


def _content(argument: object) -> Hashable:
    if not isinstance(argument, np.ndarray):
        return repr(argument)
    return argument.dtype.str, argument.shape, argument.flags.c_contiguous, argument.tobytes()


def _remember(mark: tuple[Hashable, ...]) -> None:
    if len(_PASSED) >= _MOST_PASSED:
        _PASSED.clear()
    _PASSED.add(mark)


def _probe_alone(kernel: Kernel, params: np.ndarray, state: np.ndarray, who: str) -> None:
    """One contact whose parameters are followed by NaN in memory: a kernel that reads beyond its columns shows it."""
    if not len(state):
        return
    columns = params.shape[1]
    for gap in _GAPS:
        where = f"at gap {gap:g} m, one contact alone"
        finite = []
        for behind in (np.nan, 0.0):
            memory = np.full(columns + 64, behind)
            memory[:columns] = params[0]
            alone = memory[:columns].reshape(1, columns)
            force, d_gap, d_rate, _ = _call_law(kernel, alone, state[:1].copy(), gap, 0.0, who, where)
            finite.append(bool(np.isfinite([force[0], d_gap[0], d_rate[0]]).all()))
        if finite == [False, True]:
            words = f"{who}: not finite {where}: the kernel reads beyond the {columns} columns of parameters that build() returned"
            raise PluginError(words)


def _call_law(
    kernel: Kernel, params: np.ndarray, state: np.ndarray, gap: float, rate: float, who: str, where: str
) -> tuple[np.ndarray, ...]:
    n = len(state)
    force, d_gap, d_rate = np.full((3, n), _MARK)
    new = np.full_like(state, _MARK)
    inputs = {"gap": np.full(n, gap), "gap_rate": np.full(n, rate), "params": params, "state_old": state}
    _guarded(kernel, who, where, inputs, *inputs.values(), new, 1e-6, force, d_gap, d_rate)
    return force, d_gap, d_rate, new


def _guarded(kernel: Kernel, who: str, where: str, inputs: Mapping[str, np.ndarray], *arguments: object) -> None:
    """Call a kernel; refused where it raises or writes into what it only may read."""
    before = {word: array.copy() for word, array in inputs.items()}
    try:
        kernel(*arguments)
    except Exception as why:  # the plug-in's own code
        rule = "the contract says it never raises: inside a compiled loop an exception is lost"
        raise PluginError(f"{who}: the kernel raises {type(why).__name__}: {why} {where}; {rule}") from why
    for word, array in inputs.items():
        if not np.array_equal(array, before[word]):
            array[...] = before[word]
            raise PluginError(f"{who}: changes {word} {where}; the contract says inputs are read only")


def _check_outputs(outputs: Tables, who: str, where: str) -> None:
    for word, values in outputs.items():
        if (values == _MARK).any():
            rule = "the contract says that outputs are overwritten whole"
            raise PluginError(f"{who}: the kernel leaves `{word}` as it was {where}; {rule}")
        if not np.isfinite(values).all():
            bad = values[~np.isfinite(values)][0]
            raise PluginError(f"{who}: the kernel gives `{word}` = {bad:g} {where}; the contract says finite")


def _check_array(values: Any, who: str, source: str, expected: str, shape: tuple[int | None, ...]) -> None:
    array = isinstance(values, np.ndarray)
    shown = f"{values.dtype} of shape {values.shape}" if array else type(values).__name__
    fits = array and values.ndim == len(shape) and all(w in (None, s) for w, s in zip(shape, values.shape, strict=False))
    if not fits or values.dtype != np.float64 or not values.flags.c_contiguous:
        raise PluginError(f"{who}: {source} returned {shown}; the contract says a C-contiguous float64 array {expected}")
    if not np.isfinite(values).all():
        raise PluginError(f"{who}: {source} returned values that are not finite")


def _who(kind: str, plugin: ContactLaw | Excitation) -> str:
    from raceway.framework.loading.registry import default_registry

    entries = default_registry().entries.get((kind.replace(" ", "_"), plugin.name), [])
    owners = [entry.distribution for entry in entries if entry.plugin is type(plugin)]
    return f"{kind} '{plugin.name}' of {owners[0] if owners else type(plugin).__module__}"
