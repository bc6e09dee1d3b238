"""Rules as data: keys of a scene, when their values cannot stand, or do nothing, and why."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any, Generic, TypeVar

import attrs

from raceway.errors import Mistake

#: What has the tables of a scene.
S = TypeVar("S")


@attrs.frozen
class Rule(Generic[S]):
    """One rule.

    keys : one or several, such as "contact.kind", or what finds the one at fault;  when : whether the rule speaks
    words : the reason, and the remedy where there is one; or what makes them of the tables
    """

    keys: str | tuple[str, ...] | Callable[[S], str]
    when: Callable[[S], Any]
    words: str | Callable[[S], str]


def speaking(rules: Iterable[Rule[S]], tables: S) -> Iterator[tuple[str, str]]:
    """(key, words) of the rules that speak, in their order."""
    for rule in rules:
        if rule.when(tables):
            words = rule.words if isinstance(rule.words, str) else rule.words(tables)
            keys = rule.keys(tables) if callable(rule.keys) else rule.keys
            yield from ((key, words) for key in ([keys] if isinstance(keys, str) else keys))


def mistakes(rules: Iterable[Rule[S]], tables: S) -> list[Mistake]:
    """The same, with the values of the keys."""
    return [Mistake(key, _value(tables, key), words) for key, words in speaking(rules, tables)]


def _value(tables: object, key: str) -> object:
    """What stands at a key; None at a table, and of what is not there."""
    table, _, name = key.partition(".")
    part = getattr(tables, table)
    holders = (part, getattr(part, "method", None))  # an option of a plug-in stands beside the core's keys
    if name == "kind":
        return getattr(part, "kind", None) or getattr(part, "name", None)
    value = next((getattr(holder, name) for holder in holders if hasattr(holder, name)), None)
    return None if attrs.has(type(value)) else value
