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
from raceway.framework.doors import door
from raceway.storage.tables import ReadTables

Rule = Callable[[Any, Any, Any], None]


def option(
    default: object = attrs.NOTHING,
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
    rule : validator, called as ``rule(None, attribute, value)``, but for None where that is the default
    path : the value names a file, relative to the folder of the scene file
    no_list : message for a list or a table where one value is wanted

    Examples
    --------
    >>> import attrs
    >>> from raceway import option, positive
    >>> @attrs.frozen
    ... class Law:
    ...     stiffness: float = option(1e9, unit="N/m", help="of the spring", rule=positive())
    >>> Law().stiffness
    1000000000.0
    """
    rule = optional(rule) if rule is not None and default is None else rule
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
    """A rule of one's own with what ``--help``, the documents and the JSON schema say of it.

    Parameters
    ----------
    check : called as ``check(None, attribute, value)``, value in the unit of the option; raises ValueError with the full sentence
    words : what follows "must be"
    facts : keywords of the JSON schema, such as ``{"minimum": 0}``

    Examples
    --------
    >>> from raceway import worded
    >>> def even(_instance, _attribute, value):
    ...     if value % 2:
    ...         raise ValueError("must be even")
    >>> worded(even, "even").words
    'even'
    """
    # Functions take attributes, but their type has none.
    check.words = words  # type: ignore[attr-defined]
    check.facts = dict(facts or {})  # type: ignore[attr-defined]
    return check


def positive() -> Rule:
    """Rule: greater than 0, in the unit of the option.

    Examples
    --------
    >>> from raceway import positive
    >>> positive()(None, None, -1.0)
    Traceback (most recent call last):
        ...
    ValueError: must be greater than 0
    """
    return _rule("greater than 0", lambda v: v > 0, exclusiveMinimum=0)


@door
def at_least(low: float) -> Rule:
    """Rule: ``low`` or more, in the unit of the option.

    Examples
    --------
    >>> from raceway import at_least
    >>> at_least(0.0)(None, None, -1.0)
    Traceback (most recent call last):
        ...
    ValueError: must be at least 0
    """
    return _rule(f"at least {low:g}", lambda v: v >= low, minimum=low)


@door
def above(low: float) -> Rule:
    """Rule: more than ``low``, in the unit of the option.

    Examples
    --------
    >>> from raceway import above
    >>> above(1.0)(None, None, 1.0)
    Traceback (most recent call last):
        ...
    ValueError: must be greater than 1
    """
    return _rule(f"greater than {low:g}", lambda v: v > low, exclusiveMinimum=low)


@door
def between(low: float, high: float) -> Rule:
    """Rule: from ``low`` to ``high``, both included, in the unit of the option.

    Examples
    --------
    >>> from raceway import between
    >>> between(0.0, 1.0)(None, None, 1.5)
    Traceback (most recent call last):
        ...
    ValueError: must be from 0 to 1
    """
    return _rule(f"from {low:g} to {high:g}", lambda v: low <= v <= high, minimum=low, maximum=high)


@door
def inside(low: float, high: float) -> Rule:
    """Rule: between ``low`` and ``high``, none of them included, in the unit of the option.

    Examples
    --------
    >>> from raceway import inside
    >>> inside(0.5, 1.0)(None, None, 0.5)
    Traceback (most recent call last):
        ...
    ValueError: must be greater than 0.5 and less than 1
    """
    words = f"greater than {low:g} and less than {high:g}"
    return _rule(words, lambda v: low < v < high, exclusiveMinimum=low, exclusiveMaximum=high)


def length() -> Rule:
    """Rule: a length of a bearing [m]; squares and cubes of such numbers are numbers, too.

    Examples
    --------
    >>> from raceway import length
    >>> length()(None, None, 0.0)
    Traceback (most recent call last):
        ...
    ValueError: must be greater than 0 and less than 1000
    """
    return inside(0.0, 1e3)


def finite() -> Rule:
    """Rule: any number that is finite, in the unit of the option.

    Examples
    --------
    >>> from raceway import finite
    >>> finite()(None, None, float("inf"))
    Traceback (most recent call last):
        ...
    ValueError: must be a finite number: a finite number
    """
    return _rule("a finite number", lambda v: True)


def one_of(*choices: str | bool) -> Rule:
    """Rule: one of a few words, or true or false where they are among them.

    Examples
    --------
    >>> from raceway import one_of
    >>> one_of("locked", "free")(None, None, "fre")
    Traceback (most recent call last):
        ...
    ValueError: must be one of 'locked', 'free' (did you mean 'free'?)
    """
    listed = ", ".join(repr(c) if isinstance(c, str) else str(c).lower() for c in choices)

    def check(_instance: object, _attribute: object, value: str) -> None:
        if value not in choices:
            raise ValueError(f"must be one of {listed}{nearest(value, [c for c in choices if isinstance(c, str)])}")

    return worded(check, f"one of {listed}", {"enum": list(choices)})


def word_or(rule: Rule, *choices: str) -> Rule:
    """Rule: a number that obeys ``rule``, in the unit of the option, or one of a few words.

    Examples
    --------
    >>> from raceway import positive, word_or
    >>> word_or(positive(), "auto")(None, None, "auto")
    """
    listed = ", ".join(repr(c) for c in choices)
    number = getattr(rule, "words", "a number")

    def check(instance: object, attribute: object, value: object) -> None:
        if isinstance(value, str):
            if value not in choices:
                raise ValueError(f"must be {listed} or a number {number}{nearest(value, choices)}")
            return
        try:
            rule(instance, attribute, value)
        except ValueError as fault:
            raise ValueError(f"{fault}, or {listed}") from None

    return worded(check, f"{listed} or a number {number}", {"words": list(choices), **getattr(rule, "facts", {})})


def optional(rule: Rule) -> Rule:
    """Rule: None, or what obeys ``rule``, in the unit of the option.

    Examples
    --------
    >>> from raceway import optional, positive
    >>> optional(positive())(None, None, None)
    """

    def check(instance: object, attribute: object, value: object) -> None:
        if value is not None:
            rule(instance, attribute, value)

    return worded(check, getattr(rule, "words", ""), getattr(rule, "facts", {}))


def unused_options(plugin: Any) -> dict[str, str]:
    """Options of a plug-in that are given and change nothing, each with the reason.

    A class whose options can contradict or override each other defines ``unused_options(self) -> dict[str, str]``; callers
    warn with "`table.option` has no effect: reason".

    PluginError: A plug-in whose own answer is not option -> reason.
    """
    method = getattr(plugin, "unused_options", None)
    if method is None:
        return {}
    reasons = method()
    names = {f.name for f in attrs.fields(type(plugin))}
    if not isinstance(reasons, dict) or not all(k in names and isinstance(v, str) for k, v in reasons.items()):
        raise PluginError(f"plug-in '{plugin.name}': unused_options() returned {reasons!r}; it must be option -> reason")
    return reasons
