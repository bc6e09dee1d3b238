"""Doors: public functions and methods read their arguments here; one name means one thing at all of them."""

from __future__ import annotations

import inspect
import math
import operator
import os
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import wraps
from pathlib import Path
from typing import Any, TypeVar

from raceway.errors import SceneError

F = TypeVar("F", bound=Callable[..., Any])
#: What an argument must be, and what converts it: TypeError or ValueError where it cannot.
Reader = tuple[str, Callable[[Any], object]]
#: No argument counts more: beyond, a number stands where another was meant.
_MOST = 10**9


def door(function: F) -> F:
    """A function whose arguments are read by their names, defaults as they are; ``SceneError`` with name, value and rule."""
    signature = inspect.signature(function)
    if hasattr(function, "__wrapped__") or not signature.parameters.keys() - {"self"}:
        return function
    readers = [(p.name, p.default, read) for p in signature.parameters.values() if (read := _reader_of(p)) is not None]

    @wraps(function)
    def opened(*args: object, **keywords: object) -> Any:
        try:
            bound = signature.bind(*args, **keywords)
        except TypeError:
            return function(*args, **keywords)  # Python's own words, which name the function
        for name, default, (words, read) in readers:
            if (value := bound.arguments.get(name, default)) is not default:
                try:
                    bound.arguments[name] = read(value)
                except Exception:  # whatever a foreign object makes of being asked
                    raise SceneError.at(name, value, f"must be {words}") from None
        return function(*bound.args, **bound.kwargs)

    return opened  # type: ignore[return-value]


def _reader_of(parameter: inspect.Parameter) -> Reader | None:
    """By the name; of text and of true or false by the type, as of numbers whose name says no more."""
    kind = str(parameter.annotation).removesuffix(" | None")
    if parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD):
        return None
    return _READERS.get(kind if kind in ("str", "bool") else parameter.name) or _READERS.get(kind)


def member(argument: str, value: object, choices: Collection[str]) -> Any:
    """One of the names that an object has; ``SceneError`` for another."""
    if not isinstance(value, str) or value not in choices:
        raise SceneError.at(argument, value, f"must be one of {', '.join(map(repr, choices))}")
    return value


def _reader(words: str, test: Callable[[Any], object], convert: Callable[[Any], object] = lambda value: value) -> Reader:
    def read(value: object) -> object:
        if not test(value):
            raise ValueError(words)
        return convert(value)

    return words, read


def _count(low: int) -> Reader:
    words = f"a whole number from {low} to {_MOST:.0e}"
    return _reader(words, lambda v: not isinstance(v, bool) and low <= operator.index(v) <= _MOST, operator.index)


def _number(words: str, test: Callable[[float], bool]) -> Reader:
    return _reader(words, lambda v: not isinstance(v, bool | str | bytes) and not math.isnan(v) and test(v), float)


def _several(of: Reader) -> Reader:
    """Lists of values, or one value alone."""

    def read(value: Any) -> list[object]:
        alone = isinstance(value, str | bytes | Mapping | os.PathLike) or not isinstance(value, Iterable)
        return [of[1](element) for element in ([value] if alone else value)]

    return f"{of[0]}, or a list of these", read


def _is(*kinds: type) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, kinds)


def _tells(value: Any) -> bool:
    return isinstance(value, bool) or bool(inspect.signature(value).bind("what", 0, 1))


def _table(value: object) -> object:
    texts = _TEXTS[1](list(value) if isinstance(value, Mapping) else value)
    return value if isinstance(value, Mapping) else texts


_PATH = _reader("the path of a file or folder, text or pathlib.Path", lambda v: "\0" not in os.fspath(v), Path)
_TEXT = _reader("text", _is(str))
_TEXTS = _several(_TEXT)
_FINITE = _number("a finite number", math.isfinite)


_READERS: dict[str, Reader] = {
    name: reader
    for names, reader in {
        "out store folder path": _PATH,
        "kept": _PATH,
        "plugins": _several(_PATH),
        "str": _TEXT,
        "bool": _reader("True or False", lambda v: type(v).__name__ in ("bool", "bool_"), bool),
        "int": _count(0),
        "float": _FINITE,
        "keys free force changes names": _TEXTS,
        "points repeats frames workers number": _count(1),
        "aim amplitude frequency conformity": _number("a finite number above 0", lambda v: 0.0 < v < math.inf),
        "patience limit_s": _number("a number from 0, or inf", lambda v: v >= 0.0),
        "vary at reference tolerances": ("a mapping of keys to values, or texts KEY=VALUE", _table),
        "axes": ("a mapping of keys to values, or a list of points", lambda v: dict(v) if hasattr(v, "keys") else list(v)),
        "columns": (
            "a mapping of column headers to names, text both",
            lambda v: {_TEXT[1](one): _TEXT[1](name) for one, name in v.items()},
        ),
        "tables": _reader("a mapping, such as a dict", _is(Mapping)),
        "ratings": (
            "a mapping of angles to (C, C0)",
            lambda v: {float(angle): (c, c0, *f) for angle, (c, c0, *f) in v.items()},
        ),
        "pairs": (
            "(angle, preload, axial stiffness) each, with or without the radial stiffness behind",
            lambda v: [(float(angle), *{2: k, 3: k}[len(k)]) for angle, *k in v],
        ),
        "Scene": _reader("a Scene, as raceway.load_scene reads it", lambda v: type(v).__name__ == "Scene"),
        "row": _reader("a finished row of `judged`", lambda v: v["physics"] and float(v["error"]) >= 0.0),
        "progress": _reader("True, or a function of (what, done, total)", _tells),
        "run_out": ("two finite numbers", lambda v: (lambda a, b: (_FINITE[1](a), _FINITE[1](b)))(*v)),
        "ax": _reader("axes of matplotlib", lambda v: hasattr(v, "plot") and hasattr(v, "figure")),
        "executor": _reader("text or an executor", lambda v: isinstance(v, str) or hasattr(v, "compute")),
        "plan": _reader("a plan, as raceway.make_plan makes it", lambda v: hasattr(v, "keeps")),
        "registry": _reader("a registry of plug-ins", lambda v: hasattr(v, "find") and hasattr(v, "all")),
    }.items()
    for name in names.split()
}
