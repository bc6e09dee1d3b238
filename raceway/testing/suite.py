"""Common parts of all conformance suites: checks, their rows, expected failures, pytest methods.

A check is a method ``test_<name>(self, plugin)`` marked with ``@duty("what the contract says")``.  It calls ``require`` and
may return a note.  pytest sees a method without arguments that runs the check on every example of the plug-in.

Expected failures: a file ``raceway_expected_failures.toml`` beside the plug-in's module, which the plug-in's author owns::

    [contact_law.my_law]            # kind and name
    unit_invariance = "the stiffness table is in N/mm"     # check and reason

A check that ends its process, by a wrong shape or for want of an end, is a failure like others: it runs in a child.

It is honoured strictly: a listed check that passes is a failure, and so is a name that no check has.
"""

from __future__ import annotations

import inspect
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import attrs

from raceway.storage.tables import Tables
from raceway.testing.child import Died, apart

if TYPE_CHECKING:
    from numba.core.typing.templates import Signature

    from raceway.core.jit import Kernel

PASSED, FAILED, EXPECTED, UNEXPECTED = "passed", "failed", "expected failure", "unexpectedly passed"

EXPECTED_FAILURES = "raceway_expected_failures.toml"


class ConformityError(AssertionError):
    """A duty of the contract that a plug-in does not fulfil."""


def require(condition: object, message: str) -> None:
    """Raise ``ConformityError`` with a message for the plug-in's author unless the condition holds."""
    if not condition:
        raise ConformityError(message)


@attrs.frozen
class Row:
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
    rows: tuple[Row, ...]

    @property
    def conforms(self) -> bool:
        return bool(self.rows) and all(row.good for row in self.rows)

    def to_dict(self) -> Tables:
        return {
            "kind": self.kind,
            "name": self.name,
            "conforms": self.conforms,
            "rows": [attrs.asdict(row) for row in self.rows],
        }


def duty(text: str) -> Callable[[Callable[..., str | None]], Callable[[Suite], None]]:
    """Make a check out of a method ``test_<name>(self, plugin)``."""

    def decorate(function: Callable[..., str | None]) -> Callable[[Suite], None]:
        name = function.__name__.removeprefix("test_")

        def method(self: Suite) -> None:
            row = self.row(name)
            if row.status == EXPECTED:
                import pytest

                pytest.xfail(row.message)
            require(row.good, f"{row.duty}: {row.message}")

        # Not functools.wraps: pytest would take the arguments of the wrapped function for fixtures.
        method.__name__, method.__qualname__, method.__doc__ = function.__name__, function.__qualname__, text
        method.__module__ = function.__module__
        method.check, method.duty = function, text  # type: ignore[attr-defined]
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
    def test_declaration(self, plugin: Any) -> None:
        check_class(self.kind, plugin)

    @classmethod
    def checks(cls) -> Tables:
        """Check name -> method, in the order of the source."""
        found: Tables = {}
        for base in reversed(cls.__mro__):
            for name, value in vars(base).items():
                if hasattr(value, "duty"):
                    found[name.removeprefix("test_")] = value
        return found

    @classmethod
    def conformity(cls, plugin: Any, kind: str = "", name: str = "") -> Conformity:
        """Run every check on a class or instance."""
        chosen = type(f"{cls.__name__}Run", (cls,), {"plugin": plugin})()
        rows = [chosen.row(check) for check in cls.checks()]
        word = "listed expected failures exist and have reasons"
        try:
            unknown = sorted(set(chosen.expected()) - set(cls.checks()))
            rows += [Row(u, word, FAILED, f"no check has that name; take it out of {EXPECTED_FAILURES}") for u in unknown]
        except ConformityError as why:
            rows.append(Row("expected_failures", word, FAILED, str(why)))
        return Conformity(kind or cls.kind, name or chosen.class_of_plugin.name, tuple(rows))

    @property
    def class_of_plugin(self) -> Any:
        if self.plugin is None:
            raise ConformityError(f"{type(self).__name__} needs a class attribute `plugin`")
        return self.plugin if isinstance(self.plugin, type) else type(self.plugin)

    def examples(self) -> Iterator[Any]:
        """Instances to check; suites for plug-ins whose options matter override it or give the class ``examples()``."""
        if not isinstance(self.plugin, type):
            yield self.plugin
            return
        if hasattr(self.plugin, "examples"):
            yield from self.plugin.examples()
            return
        required = [a.name for a in attrs.fields(self.plugin) if a.default is attrs.NOTHING and a.init]
        require(
            not required,
            f"`{self.plugin.__qualname__}` has options without a default ({', '.join(required)}): give the class a "
            "classmethod `examples()` that returns instances for the suite",
        )
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
        listed = tables.get(self.kind, {}).get(cls.name, {})
        bad = [name for name, reason in listed.items() if not isinstance(reason, str) or not reason.strip()]
        require(not bad, f"{EXPECTED_FAILURES}: {', '.join(bad)} need a reason in words")
        return dict(listed)

    def row(self, name: str) -> Row:
        """Run one check on every example."""
        method = self.checks()[name]
        status, message = PASSED, ""
        try:
            message = apart(lambda: self._notes(method.check)) if self.apart else self._notes(method.check)
        except (ConformityError, Died) as why:
            status, message = FAILED, str(why)
        try:
            reason = self.expected().get(name)
        except ConformityError as why:
            return Row(name, method.duty, FAILED, str(why))
        if reason is not None:
            if status == FAILED:
                return Row(name, method.duty, EXPECTED, f"{reason} ({message})")
            return Row(name, method.duty, UNEXPECTED, f"it passes: remove it from {EXPECTED_FAILURES}")
        return Row(name, method.duty, status, message)

    def _notes(self, check: Callable[..., str | None]) -> str:
        """What a check says of all examples."""
        notes = [self._run(check, plugin) for plugin in self._examples()]
        require(notes, "there is no example to check")
        return "; ".join(dict.fromkeys(n for n in notes if n))

    def _examples(self) -> list[Any]:
        try:
            return list(self.examples())
        except ConformityError:
            raise
        except Exception as why:  # the plug-in's own code
            raise ConformityError(f"no example can be made: {type(why).__name__}: {why}") from why

    def _run(self, check: Callable[..., str | None], plugin: object) -> str | None:
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
    require(_frozen(plugin), f"`{cls.__qualname__}` is not frozen: decorate it with @attrs.frozen")
    undeclared = [f.name for f in attrs.fields(cls) if f.init and "unit" not in f.metadata]
    require(
        not undeclared, f"options {', '.join(undeclared)} are not declared with raceway.option: no unit, no help, no rule"
    )


def _frozen(plugin: Any) -> bool:
    names = [f.name for f in attrs.fields(type(plugin))] or ["name"]
    try:
        setattr(attrs.evolve(plugin), names[0], getattr(plugin, names[0]))
    except attrs.exceptions.FrozenInstanceError:
        return True
    except AttributeError:  # a class without slots for it
        return False
    return False


def check_kernel(kernel: Kernel, signature: Signature, word: str) -> None:
    """A dispatcher compiled for exactly the contract's signature."""
    from raceway.core.jit import signature_words

    compiled = getattr(kernel, "nopython_signatures", None)  # compiles it
    if compiled is None:
        raise ConformityError(f"kernel() returns {kernel!r}, which is not compiled: decorate it with @jit({word})")
    require(
        [tuple(has.args) for has in compiled] == [tuple(signature.args)],
        f"kernel() is compiled for {[signature_words(has) for has in compiled] or 'nothing'}, not for {word} alone: "
        f"decorate it with @jit({word})",
    )
