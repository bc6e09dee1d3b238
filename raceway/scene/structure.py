"""Turns the tables of a TOML file into attrs objects, strictly, and collects every mistake with its path.

cattrs does the walking; here are the strict types (12.7 is not an integer, true is not a number, no NaN), numbers that are text
with a unit, and the translation of what it raises into ``Mistake``.
"""

import math
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache, partial
from operator import eq
from typing import Any, TypeVar, get_args, get_origin

import attrs
import cattrs
from cattrs.gen import make_dict_structure_fn, override

from raceway.errors import Mistake
from raceway.framework.options import nearest
from raceway.storage.tables import Tables

T = TypeVar("T")
_MISSING = "is required"


def _number(value: object, _type: object = None) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"must be a number, not {_kind(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ValueError("must be a finite number")
    return number


def _integer(value: object, _type: object = None) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"must be a whole number, not {_kind(value)}")
    return value


def _word(value: object, _type: object = None) -> str:
    if not isinstance(value, str):
        raise ValueError(f"must be a string, not {_kind(value)}")
    return value


def _switch(value: object, _type: object = None) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"must be true or false, not {_kind(value)}")
    return value


def _kind(value: object) -> str:
    names = {bool: "true or false", int: "a whole number", float: "a number with a fraction"}
    names |= {str: "a string", list: "a list", dict: "a table"}
    return names.get(type(value), type(value).__name__)


def _number_list(value: object, _type: object = None) -> tuple[float, ...]:
    kinds = get_args(_type)
    if len(kinds) == 2 and kinds[1] is Ellipsis:
        if not isinstance(value, list | tuple):
            raise ValueError(f"must be a list of numbers, not {_kind(value)}")
        return tuple(_number(v) for v in value)
    length = len(kinds)
    if not isinstance(value, list | tuple) or len(value) != length:
        raise ValueError(f"must be a list of {length} numbers")
    return tuple(_number(v) for v in value)


def _points(value: object, _type: object = None) -> tuple[tuple[float, float], ...] | None:
    if value is None:
        return None
    if not isinstance(value, list | tuple) or not all(isinstance(p, list | tuple) and len(p) == 2 for p in value):
        raise ValueError("must be a list of points, each a list of two numbers: [[0.0, 0.015], [0.008, 0.015], ...]")
    return tuple((_number(p[0]), _number(p[1])) for p in value)


def _number_or_word(value: object, _type: object = None) -> float | str:
    return value if isinstance(value, str) else _number(value)


def _optional(inner: Any) -> Any:
    return lambda value, _type=None: None if value is None else inner(value, _type)


_HOOKS: dict[object, Any] = {
    float: _number,
    int: _integer,
    str: _word,
    bool: _switch,
    tuple[float, float]: _number_list,
    tuple[float, ...]: _number_list,
    tuple[tuple[float, float], ...] | None: _points,
    float | str: _number_or_word,
    str | float: _number_or_word,
    int | str: lambda value, _type=None: value if isinstance(value, str) else _integer(value),
    bool | str: lambda value, _type=None: value if isinstance(value, str) else _switch(value),
    float | None: _optional(_number),
    int | None: _optional(_integer),
    str | None: _optional(_word),
}

#: Types of keys whose numbers may be text with a unit; counts have none.
_WORDS = (float | str, str | float)
_LISTS = (tuple[float, float], tuple[float, ...], tuple[tuple[float, float], ...] | None)
_MEASURED = (float, float | None, *_LISTS, *_WORDS)


def _without_units(value: object, attribute: Any) -> Any:
    """A key's value with the numbers that are text in the key's own unit.

    ValueError: text that is no number of this unit, and no word either where the key takes words.
    """
    unit = attribute.metadata.get("unit", "")
    if not unit or attribute.type not in _MEASURED:
        return value
    if isinstance(value, list | tuple):
        return [_without(unit, inner) for inner in value]
    if attribute.type in _LISTS or not isinstance(value, str):
        return value
    from raceway.scene.units import is_quantity

    if attribute.type in _WORDS and not is_quantity(value):
        return value
    return _without(unit, value)


def _without(unit: str, value: object) -> object:
    if isinstance(value, list | tuple):
        return [_without(unit, inner) for inner in value]
    if not isinstance(value, str):
        return value
    from raceway.scene.units import number_in

    return number_in(unit, value)


#: Fields of a class by their names, with types for their words.
_resolved: Callable[[type], dict[str, Any]] = lru_cache(maxsize=256)(lambda cls: attrs.fields_dict(attrs.resolve_types(cls)))


def table_without_units(table: Tables, cls: type) -> Tables:
    """A copy of a table with all numbers in the keys' own units; what is wrong stays, to be reported where it is checked."""
    result = dict(table)
    for key, value in table.items():
        if not isinstance(value, str | dict | list | tuple) or (field := _resolved(cls).get(key)) is None:
            continue
        kinds = [kind for kind in (field.type, *get_args(field.type)) if isinstance(kind, type) and attrs.has(kind)]
        if isinstance(value, dict) and kinds:
            result[key] = table_without_units(value, kinds[0])
        elif isinstance(value, list | tuple) and (row_class := table_of_list(field.type)) is not None:
            result[key] = [table_without_units(each, row_class) if isinstance(each, dict) else each for each in value]
        elif not isinstance(value, dict):
            with suppress(ValueError):
                result[key] = _without_units(value, field)
    return result


def table_of_list(kind: object) -> type | None:
    """The class of the tables that a key is a list of; None for other keys."""
    kinds = get_args(kind) if get_origin(kind) is tuple else ()
    return kinds[0] if len(kinds) == 2 and kinds[1] is Ellipsis and attrs.has(kinds[0]) else None


def _converter() -> cattrs.Converter:
    converter = cattrs.Converter(detailed_validation=True, forbid_extra_keys=True)
    for kind, hook in _HOOKS.items():
        if isinstance(kind, type):  # plain types: cattrs looks at its own hooks before any predicate
            converter.register_structure_hook(kind, hook)
        else:
            converter.register_structure_hook_func(partial(eq, kind), hook)

    def factory(cls: type) -> Callable[[object, object], object]:
        attrs.resolve_types(cls)
        overrides: Tables = {a.name: override(struct_hook=_with_rule(converter, a)) for a in attrs.fields(cls) if a.init}
        inner: Any = make_dict_structure_fn(
            cls, converter, _cattrs_forbid_extra_keys=True, _cattrs_detailed_validation=True, **overrides
        )

        def structure(value: object, target: object) -> object:
            if not isinstance(value, dict):
                raise ValueError(f"must be a table, not {_kind(value)}")
            return inner(value, target)

        return structure

    converter.register_structure_hook_factory(attrs.has, factory)
    return converter


def _with_rule(converter: cattrs.Converter, attribute: Any) -> Any:
    """Type first, then the field's own rule, so that every field of a table is looked at."""

    def hook(value: object, _type: object) -> object:
        if isinstance(value, list | dict) and attribute.metadata.get("no_list"):
            raise ValueError(attribute.metadata["no_list"])
        if table_of_list(attribute.type) is not None and not isinstance(value, list | tuple):
            raise ValueError(f"must be a list of tables, not {_kind(value)}")
        result = converter.structure(_without_units(value, attribute), attribute.type)
        if attribute.validator is not None:
            attribute.validator(None, attribute, result)
        return result

    return hook


_CONVERTER = _converter()


def structure(table: object, cls: type[T], path: str, mistakes: list[Mistake]) -> T | None:
    """An object of an attrs class from a table; None when it has mistakes, which are appended.

    path : where the table stands, for messages: "bearing"
    """
    try:
        return _CONVERTER.structure(table, cls)
    except Exception as error:  # cattrs groups whatever the hooks and classes raise
        mistakes.extend(_mistakes(error, table, cls, path))
        return None


def _mistakes(error: BaseException, value: object, cls: object, path: str) -> list[Mistake]:
    if isinstance(error, cattrs.errors.ClassValidationError):
        mistakes: list[Mistake] = []
        notes, plain = error.group_exceptions()
        strange = [key for e in plain if isinstance(e, cattrs.errors.ForbiddenExtraKeysError) for key in e.extra_fields]
        for inner, note in notes:
            here = value.get(note.name) if isinstance(value, dict) else None
            where = f"{path}.{note.name}" if path else note.name
            if isinstance(inner, KeyError) and any(nearest(key, [note.name]) for key in strange):
                continue  # misspelt, which is said below
            if isinstance(inner, KeyError):
                mistakes.append(Mistake(where, None, f"{_MISSING}{_describe(cls, note.name)}"))
            else:
                mistakes += _mistakes(inner, here, note.type, where)
        for other in plain:
            mistakes += _mistakes(other, value, cls, path)
        return mistakes
    if isinstance(error, cattrs.errors.ForbiddenExtraKeysError):
        names = [a.name for a in attrs.fields(error.cl)]
        given: Tables = value if isinstance(value, dict) else {}
        rules = {k: f"unknown key{nearest(k, names)}; known here: {', '.join(names)}" for k in sorted(error.extra_fields)}
        return [Mistake(f"{path}.{key}" if path else key, given.get(key), rule) for key, rule in rules.items()]
    if isinstance(error, cattrs.errors.IterableValidationError) and isinstance(value, list | tuple):
        places, _ = error.group_exceptions()
        return [m for inner, at in places for m in _mistakes(inner, value[int(at.index)], at.type, f"{path}[{at.index}]")]
    if isinstance(error, cattrs.errors.BaseValidationError):
        return [m for inner in error.exceptions for m in _mistakes(inner, value, cls, path)]
    plain_value = None if isinstance(value, dict) else value
    return [Mistake(path, plain_value, str(error))]


def _describe(cls: Any, name: str) -> str:
    field = attrs.fields_dict(cls).get(name) if attrs.has(cls) else None
    if field is None:
        return ""
    unit = field.metadata.get("unit", "")
    return f": {field.metadata.get('help', '')}{f' [{unit}]' if unit else ''}"
