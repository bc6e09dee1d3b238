"""Common parts of all conformance suites: checks, their rows, expected failures, pytest methods.

A check is a method ``test_<name>(self, plugin)`` marked with ``@duty("what the contract says")``.  It calls ``require`` and
may return a note.  pytest sees a method without arguments that runs the check on every example of the plug-in.

Expected failures: a file ``raceway_expected_failures.toml`` beside the plug-in's module, which the plug-in's author owns::

    [contact_law.my_law]            # kind and name
    unit_invariance = "the stiffness table is in N/mm"     # check and reason

It is honoured strictly: a listed check that passes is a failure, and so is a name that no check has.

A check runs in a child process, a fork that has the plug-in as it is here: one that writes beyond an array, has no end or takes all
memory is a failure like others.
"""

from __future__ import annotations

import faulthandler
import inspect
import os
import pickle
import resource
import select
import signal
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import attrs

from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from numba.core.typing.templates import Signature
    from numpy.typing import ArrayLike

    from raceway.bodies.model import Equilibrium, Model
    from raceway.core.jit import Kernel
    from raceway.scene.scene import Scene


def b7206c(**tables: object) -> Tables:
    """The tables of a B7206C under 1000 N, without gyroscopic moments and growth at speed; each keyword replaces or extends one table."""
    scene: Tables = {
        "title": "test", "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0},
        "kinematics": {"gyroscopic": "none", "ring_growth": False},
    }  # fmt: skip
    for name, table in tables.items():
        scene[name] = {**scene.get(name, {}), **table} if isinstance(table, dict) else table
    return scene


def model_of(scene: Scene | Tables) -> Model:
    """The built model of a scene, or of its tables."""
    from raceway import build_model, scene_from_dict

    scene = scene_from_dict(scene) if isinstance(scene, dict) else scene
    return build_model(scene)


def settled(scene: Scene | Tables) -> tuple[Model, Equilibrium]:
    """Model and static equilibrium of a scene, or of its tables."""
    from raceway.pipeline.equilibrium import solve_equilibrium

    model = model_of(scene)
    return model, solve_equilibrium(model)


T = TypeVar("T")

#: Time [s] that a duty may take on busy cores, compiling too, and memory [bytes] that it may take beyond what is there.
LIMIT_S, LIMIT_BYTES = 300.0, 8 * 2**30


class _Died(Exception):
    """How the child ended without an answer, in words."""


PASSED, FAILED, EXPECTED, UNEXPECTED = "passed", "failed", "expected failure", "unexpectedly passed"
EXPECTED_FAILURES = "raceway_expected_failures.toml"


class ConformityError(AssertionError):
    """A duty of the contract that a plug-in does not fulfil."""


def require(condition: object, message: str) -> None:
    """Raise ``ConformityError`` with a message for the plug-in's author unless the condition holds."""
    if not condition:
        raise ConformityError(message)


@attrs.frozen
class DutyResult:
    """The outcome of one check; ``status`` is passed, failed, expected failure or unexpectedly passed."""

    name: str
    duty: str
    status: str
    message: str

    @property
    def good(self) -> bool:
        return self.status in (PASSED, EXPECTED)


@attrs.frozen
class Conformity:
    """All rows of one plug-in."""

    kind: str
    name: str
    rows: tuple[DutyResult, ...]

    @property
    def conforms(self) -> bool:
        return bool(self.rows) and all(row.good for row in self.rows)

    def to_dict(self) -> Tables:
        rows = [attrs.asdict(row) for row in self.rows]
        return {"kind": self.kind, "name": self.name, "conforms": self.conforms, "rows": rows}


Check = Callable[[Any, Any], str | None]


def duty(text: str, unless: Callable[[Any], str] | None = None) -> Callable[[Check], Callable[[Suite], None]]:
    """Make a check out of a method ``test_<name>(self, plugin)``.

    Parameters
    ----------
    unless : of the plug-in; the note of one that the duty does not apply to, else empty
    """

    def decorate(function: Check) -> Callable[[Suite], None]:
        name = function.__name__.removeprefix("test_")

        def method(self: Suite) -> None:
            row = self.row(name)
            if row.status == EXPECTED:
                import pytest

                pytest.xfail(row.message)
            require(row.good, f"{row.duty}: {row.message}")

        def check(self: Suite, plugin: object) -> str | None:
            return (unless(plugin) if unless else "") or function(self, plugin)

        # Not functools.wraps: pytest would take the arguments of the wrapped function for fixtures.
        method.__name__, method.__qualname__, method.__doc__ = function.__name__, function.__qualname__, text
        method.__module__ = function.__module__
        method.check, method.duty = check, text  # type: ignore[attr-defined]
        return method

    return decorate


class Suite:
    """Base of the suites.

    Attributes
    ----------
    plugin : an instance of the plug-in's class, or the class; a class whose options have no defaults offers
        ``examples()``, a classmethod that returns instances for the suite
    kind : of plug-in
    apart : whether a duty runs in a child process with limits, so that the suite survives what it tests
    """

    plugin: ClassVar[Any] = None
    kind: ClassVar[str] = ""
    apart: ClassVar[bool] = True

    @duty("a frozen attrs class whose options are declared")
    def test_declaration(self, plugin: attrs.AttrsInstance) -> None:
        check_class(self.kind, plugin)

    @classmethod
    def checks(cls) -> Tables:
        """Check name -> method, in the order of the source."""
        members = ((name, value) for base in reversed(cls.__mro__) for name, value in vars(base).items())
        return {name.removeprefix("test_"): value for name, value in members if hasattr(value, "duty")}

    @classmethod
    def conformity(cls, plugin: object, kind: str = "", name: str = "") -> Conformity:
        """Run every check on a class or instance."""
        suite = type(f"{cls.__name__}Run", (cls,), {"plugin": plugin})()
        rows = [suite.row(check) for check in cls.checks()]
        text = "listed expected failures exist and have reasons"
        try:
            unknown = sorted(set(suite.expected()) - set(cls.checks()))
            rule = f"no check has that name: take it out of {EXPECTED_FAILURES}"
            rows += [DutyResult(name, text, FAILED, rule) for name in unknown]
        except ConformityError as why:
            rows.append(DutyResult("expected_failures", text, FAILED, str(why)))
        return Conformity(kind or cls.kind, name or suite.class_of_plugin.name, tuple(rows))

    @property
    def class_of_plugin(self) -> Any:
        if self.plugin is None:
            raise ConformityError(f"{type(self).__name__} needs a class attribute `plugin`")
        return self.plugin if isinstance(self.plugin, type) else type(self.plugin)

    def examples(self) -> Iterator[object]:
        """Instances to check; suites for plug-ins whose options matter override it or give the class ``examples()``."""
        if not isinstance(self.plugin, type):
            yield self.plugin
            return
        if hasattr(self.plugin, "examples"):
            yield from self.plugin.examples()
            return
        names = ", ".join(a.name for a in attrs.fields(self.plugin) if a.default is attrs.NOTHING and a.init)
        remedy = "give the class a classmethod `examples()` that returns instances for the suite"
        require(not names, f"`{self.plugin.__qualname__}` has options without a default ({names}): {remedy}")
        yield self.plugin()

    def expected(self) -> dict[str, str]:
        """Check name -> reason, from the plug-in's own file."""
        cls = self.class_of_plugin
        try:
            path = Path(inspect.getfile(cls)).parent / EXPECTED_FAILURES
        except (TypeError, OSError):  # a class made in an interactive session
            return {}
        if not path.is_file():
            return {}
        try:
            tables = tomllib.loads(path.read_text(encoding="utf-8"))
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as why:
            raise ConformityError(f"{EXPECTED_FAILURES} is not valid TOML: {why}") from why
        entries = tables.get(self.kind, {}).get(cls.name, {})
        bad = [name for name, reason in entries.items() if not isinstance(reason, str) or not reason.strip()]
        require(not bad, f"{EXPECTED_FAILURES}: {', '.join(bad)} need a reason in words")
        return dict(entries)

    def row(self, name: str) -> DutyResult:
        """Run one check on every example."""
        method = self.checks()[name]
        status, message = PASSED, ""
        try:
            message = apart(lambda: self._notes(method.check)) if self.apart else self._notes(method.check)
        except (ConformityError, _Died) as why:
            status, message = FAILED, str(why)
        try:
            reason = self.expected().get(name)
        except ConformityError as why:
            return DutyResult(name, method.duty, FAILED, str(why))
        if reason is not None and status == FAILED:
            status, message = EXPECTED, f"{reason} ({message})"
        elif reason is not None:
            status, message = UNEXPECTED, f"it passes: remove it from {EXPECTED_FAILURES}"
        return DutyResult(name, method.duty, status, message)

    def _notes(self, check: Check) -> str:
        """Notes of a check on all examples."""
        try:
            examples = list(self.examples())
        except ConformityError:
            raise
        except Exception as why:  # the plug-in's own code
            raise ConformityError(f"no example can be made: {type(why).__name__}: {why}") from why
        notes = [self._run(check, plugin) for plugin in examples]
        require(notes, "there is no example to check")
        return "; ".join(dict.fromkeys(n for n in notes if n))

    def _run(self, check: Check, plugin: object) -> str | None:
        try:
            return check(self, plugin)
        except ConformityError as why:
            raise ConformityError(f"{plugin!r}: {why}") from why
        except Exception as why:  # the plug-in's own code: reported as a failed duty, with its type
            raise ConformityError(f"{plugin!r}: raises {type(why).__name__}: {why}") from why


def check_class(kind: str, plugin: attrs.AttrsInstance) -> None:
    """The duties that every kind shares: attributes that exist, a frozen attrs class, options that declare themselves."""
    from raceway.framework.contracts import broken_duties

    cls = type(plugin)
    faults = broken_duties(kind, cls)
    require(not faults, f"`{cls.__qualname__}` " + ", ".join(faults))
    example: Any = plugin
    name = next((f.name for f in attrs.fields(cls)), "name")
    try:
        setattr(attrs.evolve(example), name, getattr(plugin, name))
        frozen = False
    except AttributeError as why:  # else a class without slots for it
        frozen = isinstance(why, attrs.exceptions.FrozenInstanceError)
    require(frozen, f"`{cls.__qualname__}` is not frozen: decorate it with @attrs.frozen")
    options = [f.name for f in attrs.fields(cls) if f.init and "unit" not in f.metadata]
    words = ", ".join(options)
    require(not options, f"options {words} are not declared with raceway.option: no unit, no help, no rule")


def check_kernel(kernel: Kernel, signature: Signature, word: str) -> None:
    """A dispatcher compiled for exactly the contract's signature."""
    from raceway.core.signatures import signature_words

    signatures = getattr(kernel, "nopython_signatures", None)  # compiles it
    if signatures is None:
        raise ConformityError(f"kernel() returns {kernel!r}, which is not compiled: decorate it with @jit({word})")
    present = [signature_words(has) for has in signatures] or "nothing"
    fits = [tuple(has.args) for has in signatures] == [tuple(signature.args)]
    require(fits, f"kernel() is compiled for {present}, not for {word} alone: decorate it with @jit({word})")


def check_shape(word: str, values: ArrayLike, shape: tuple[int, ...]) -> None:
    """An array of the contract's shape."""
    import numpy as np

    require(np.shape(values) == shape, f"{word} has the shape {np.shape(values)}, not {shape}")


def apart(work: Callable[[], T]) -> T:
    """What ``work()`` returns or raises, which can be pickled, from a child process with limits.

    _Died: It ended by a signal or an exit of its own, or was stopped.
    """
    _import_compiler()
    sys.stdout.flush()
    sys.stderr.flush()
    reader, writer = os.pipe()
    child = os.fork()
    if not child:
        os.close(reader)
        code = 1
        try:
            faulthandler.disable()
            os.setpgid(0, 0)
            os.dup2(2, 1)  # what is printed here is no part of an answer in JSON
            with open("/proc/self/statm", encoding="ascii") as file:
                limit = int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE") + LIMIT_BYTES
            _, hard = resource.getrlimit(resource.RLIMIT_AS)
            resource.setrlimit(resource.RLIMIT_AS, (limit if hard == resource.RLIM_INFINITY else min(limit, hard), hard))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            try:
                output = pickle.dumps((True, work()))
            except Exception as why:  # handed over
                output = pickle.dumps((False, why))
            with os.fdopen(writer, "wb") as pipe:
                pipe.write(output)
            code = 0
        except SystemExit as why:
            code = why.code if isinstance(why.code, int) else 1
        finally:
            os._exit(code)
    os.close(writer)
    try:
        answer, late = _output(reader)
    finally:
        os.close(reader)
        with suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
    if late:
        raise _Died(f"died: it had not ended after {LIMIT_S:g} s")
    if not answer:
        code = os.waitstatus_to_exitcode(status)
        end = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
        raise _Died(f"died: its process ended {end}")
    has_answer, result = pickle.loads(answer)
    if has_answer:
        return result
    raise result


@cache
def _import_compiler() -> None:
    """Once for all children, with a small kernel, whose first use starts the compiler: most duties take less time than that."""
    for name in ("scipy.sparse.linalg", "scipy.optimize", "raceway.pipeline.run"):
        import_module(name)
    import_module("raceway.contact_laws.hertz").three_halves().compile()


def _output(reader: int) -> tuple[bytes, bool]:
    """All that the child writes, and whether its time was over before."""
    parts: list[bytes] = []
    end = time.monotonic() + LIMIT_S
    while True:
        ready, _, _ = select.select([reader], [], [], max(end - time.monotonic(), 0.0))
        if not ready:
            return b"", True
        part = os.read(reader, 65536)
        if not part:
            return b"".join(parts), False
        parts.append(part)
