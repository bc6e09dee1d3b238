"""Doors: public functions and methods read their arguments here, each by the annotation that stands at it."""

from __future__ import annotations

import ast
import inspect
import math
import operator
import os
import sys
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, NamedTuple, TypeVar, get_origin

from raceway.errors import SceneError

F = TypeVar("F", bound=Callable[..., Any])


class Reader(NamedTuple):
    """What an argument must be, in words, and what converts it, with any exception where it cannot."""

    words: str
    read: Callable[[Any], object]


def door(function: F) -> F:
    """A function whose arguments are read by their annotations, defaults as they are; ``SceneError`` with name, value and rule.

    ``str``, ``bool``, ``int`` and ``float`` are read by these types; ``Annotated[float, positive()]`` adds a rule of options.
    Who asks for the signature gets the plain types.

    Examples
    --------
    >>> from typing import Annotated
    >>> from raceway import door, positive
    >>> @door
    ... def stiffness(force: float, travel: Annotated[float, positive()] = 1e-6) -> float:
    ...     return force / travel
    >>> stiffness(3, 0)
    Traceback (most recent call last):
        ...
    raceway.errors.SceneError: `travel` = 0: must be a finite number, greater than 0
    """
    signature, readers, plain = inspect.signature(function), [], []
    for parameter in signature.parameters.values():
        kind, markers = _parts(parameter.annotation, function.__globals__)
        plain.append(parameter.replace(annotation=kind))
        text = kind if isinstance(kind, str) else inspect.formatannotation(kind)
        steps = [each if isinstance(each, Reader) else _ruled(each) for each in markers if hasattr(each, "words")]
        if not any(each in steps for each in markers):  # whose reader takes the place of the type's
            steps = [*filter(None, [_TYPES.get(text.removesuffix(" | None"))]), *steps]
        if steps and parameter.kind not in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD):
            place = len(plain) - 1 if parameter.kind is not parameter.KEYWORD_ONLY else sys.maxsize
            readers.append((parameter.name, place, parameter.default, "None" in text, steps))

    @wraps(function)
    def opened(*args: object, **keywords: object) -> Any:
        read_args = list(args)
        for name, place, default, optional, steps in readers:
            given = value = args[place] if place < len(args) else keywords.get(name, default)
            if given is default or (given is None and optional):
                continue
            try:
                for _, read in steps:
                    value = read(value)
            except Exception:  # whatever a foreign object makes of being asked
                raise SceneError.at(name, given, f"must be {', '.join(words for words, _ in steps)}") from None
            if place < len(args):
                read_args[place] = value
            else:
                keywords[name] = value
        return function(*read_args, **keywords)

    opened.__signature__ = signature.replace(parameters=plain)  # type: ignore[attr-defined]
    return opened  # type: ignore[return-value]


def _parts(annotation: Any, names: dict[str, Any]) -> tuple[Any, tuple[Any, ...]]:
    """Type and markers of ``Annotated`` or of an alias for it; the type stays text: its names may be those of type checkers alone."""
    if isinstance(annotation, str) and annotation.startswith("Annotated["):
        kind, *markers = ast.parse(annotation, mode="eval").body.slice.elts  # type: ignore[attr-defined]
        return ast.unparse(kind), tuple(eval(ast.unparse(marker), names) for marker in markers)
    stands_for: Any = names.get(annotation) if isinstance(annotation, str) else annotation
    if get_origin(stands_for) is Annotated:
        return annotation if isinstance(annotation, str) else stands_for.__origin__, stands_for.__metadata__
    return annotation, ()


def _ruled(rule: Any) -> Reader:
    """Of a rule, which raises or gives None."""
    return reader(rule.words, lambda value: rule(None, None, value) is None)


def member(argument: str, value: object, choices: Collection[str]) -> Any:
    """One of the names that an object has; ``SceneError`` for another."""
    if not isinstance(value, str) or value not in choices:
        raise SceneError.at(argument, value, f"must be one of {', '.join(map(repr, choices))}")
    return value


def reader(words: str, test: type | Callable[[Any], object], convert: Callable[[Any], object] = lambda v: v) -> Reader:
    """Of what is of a type, or passes a test."""

    def read(value: object) -> object:
        if not (isinstance(value, test) if isinstance(test, type) else test(value)):
            raise ValueError(words)
        return convert(value)

    return Reader(words, read)


def _checked_number(words: str, test: Callable[[float], bool]) -> Reader:
    return reader(words, lambda v: not isinstance(v, bool | str | bytes) and not math.isnan(v) and test(v), float)


def _several(of: Reader) -> Reader:
    """Lists of values, or one value alone."""

    def read(value: Any) -> list[object]:
        alone = isinstance(value, str | bytes | os.PathLike) or not isinstance(value, Iterable)
        return [of.read(element) for element in ([value] if alone else value)]

    return Reader(f"{of.words}, or a list of these", read)


TEXT = reader("text", str)
TEXTS = _several(TEXT)
FINITE = _checked_number("a finite number", math.isfinite)
DURATION = _checked_number("a number from 0, or inf", lambda v: v >= 0.0)
PATH = reader("the path of a file or folder, text or pathlib.Path", lambda v: "\0" not in os.fspath(v), Path)
PATHS = _several(PATH)
KEY_VALUES = Reader(
    "a mapping of keys to values, or texts KEY=VALUE",
    lambda value: value if isinstance(value, Mapping) else TEXTS.read(value),
)
_TYPES = {
    "str": TEXT,
    "bool": reader("True or False", lambda v: type(v).__name__ in ("bool", "bool_"), bool),
    # With more digits a number stands where another was meant.
    "int": reader(
        "a whole number below 1e9", lambda v: not isinstance(v, bool) and abs(operator.index(v)) < 1e9, operator.index
    ),
    "float": FINITE,
}
