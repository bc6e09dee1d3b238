"""Declaration of options: attrs fields that carry a unit, a help text and a rule with a remedy.

Scene tables and plug-ins' classes use the same few functions, so that checking, the JSON schema and ``--help`` all read
one declaration.  A rule raises ``ValueError`` with the whole sentence that the user will see.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Iterable
from typing import Any

import attrs

from raceway.errors import PluginError
from raceway.storage.tables import ReadTables

Rule = Callable[[Any, Any, Any], None]


def option(
    default: Any = attrs.NOTHING,
    *,
    unit: str = "",
    help: str = "",
    rule: Rule | None = None,
    path: bool = False,
    no_list: str = "",
) -> Any:
    """An attrs field for one key of a scene.

    Parameters
    ----------
    default : value when the key is absent; without it the key is required
    unit : for people and for the schema, "" for a pure number
    help : one sentence
    rule : validator, called as ``rule(None, attribute, value)``
    path : the value names a file, relative to the folder of the scene file
    no_list : what to tell who gives a list or a table where one value is wanted
    """
    metadata = {"unit": unit, "help": help, "rule": getattr(rule, "words", ""), "path": path, "no_list": no_list}
    return attrs.field(default=default, validator=rule or (lambda *_: None), metadata=metadata)


def nearest(word: str, choices: Iterable[str]) -> str:
    """`` (did you mean 'x'?)`` or nothing."""
    by_lower = {choice.lower(): choice for choice in choices}
    close = difflib.get_close_matches(str(word).lower(), list(by_lower), n=1, cutoff=0.55)
    return f" (did you mean '{by_lower[close[0]]}'?)" if close else ""


def _rule(words: str, test: Callable[[Any], bool], **facts: object) -> Rule:
    def check(_instance: object, _attribute: object, value: object) -> None:
        if isinstance(value, float) and not math.isfinite(value):
            raise ValueError(f"must be a finite number: {words}")
        if not test(value):
            raise ValueError(f"must be {words}")

    return worded(check, words, facts)


def worded(check: Rule, words: str, facts: ReadTables | None = None) -> Rule:
    """A rule of one's own with what ``--help``, the documents and the JSON schema say of it."""
    # Functions take attributes, but their type has none.
    check.words = words  # type: ignore[attr-defined]
    check.facts = dict(facts or {})  # type: ignore[attr-defined]
    return check


def positive() -> Rule:
    return _rule("greater than 0", lambda v: v > 0, exclusiveMinimum=0)


def at_least(low: float) -> Rule:
    return _rule(f"at least {low:g}", lambda v: v >= low, minimum=low)


def above(low: float) -> Rule:
    return _rule(f"greater than {low:g}", lambda v: v > low, exclusiveMinimum=low)


def between(low: float, high: float) -> Rule:
    return _rule(f"from {low:g} to {high:g}", lambda v: low <= v <= high, minimum=low, maximum=high)


def inside(low: float, high: float) -> Rule:
    return _rule(
        f"greater than {low:g} and less than {high:g}", lambda v: low < v < high, exclusiveMinimum=low, exclusiveMaximum=high
    )


def length() -> Rule:
    """Of a bearing [m]; squares and cubes of such numbers are numbers, too."""
    return inside(0.0, 1e3)


def finite() -> Rule:
    return _rule("a finite number", lambda v: True)


def one_of(*choices: str) -> Rule:
    listed = ", ".join(repr(c) for c in choices)

    def check(_instance: object, _attribute: object, value: str) -> None:
        if value not in choices:
            raise ValueError(f"must be one of {listed}{nearest(value, choices)}")

    return worded(check, f"one of {listed}", {"enum": list(choices)})


def word_or(rule: Rule, *choices: str) -> Rule:
    """A number that obeys ``rule``, or one of a few words."""
    listed = ", ".join(repr(c) for c in choices)
    number = getattr(rule, "words", "a number")

    def check(instance: object, attribute: object, value: object) -> None:
        if isinstance(value, str):
            if value not in choices:
                raise ValueError(f"must be {listed} or a number {number}{nearest(value, choices)}")
        else:
            rule(instance, attribute, value)

    return worded(check, f"{listed} or a number {number}", {"words": list(choices), **getattr(rule, "facts", {})})


def optional(rule: Rule) -> Rule:
    def check(instance: object, attribute: object, value: object) -> None:
        if value is not None:
            rule(instance, attribute, value)

    return worded(check, getattr(rule, "words", ""), getattr(rule, "facts", {}))


def unused_options(plugin: Any) -> dict[str, str]:
    """Options of a plug-in that are given and change nothing, each with the reason.

    A class whose options can contradict or override each other defines ``unused_options(self) -> dict[str, str]``; callers
    warn with "`table.option` has no effect: reason".

    Raises
    ------
    PluginError
        A plug-in whose own answer is not option -> reason.
    """
    own = getattr(plugin, "unused_options", None)
    if own is None:
        return {}
    found = own()
    known = {f.name for f in attrs.fields(type(plugin))}
    if not isinstance(found, dict) or not all(k in known and isinstance(v, str) for k, v in found.items()):
        raise PluginError(f"plug-in '{plugin.name}': unused_options() returned {found!r}; it must be option -> reason")
    return found
