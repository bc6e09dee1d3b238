"""Columns of a record by their heads: quantity, axis and unit, whatever program wrote them.

``time_s``, ``Time (s)``, ``"t [ms]"``, ``X [µm]``, ``Displacement Y / mm``, ``Keyphasor (V)``, ``Speed [r/min]`` and ``Force [N]`` say
what they are.  Sensors named X and Y stand across a shaft along z: they are y and z here, where x is the shaft.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence

import attrs

from raceway.framework.options import nearest

_LENGTH = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}
_FORCE = {"n": 1.0, "kn": 1e3}  # no "mn": mN and MN are the same in small letters
#: Factor to SI by quantity and unit.
UNITS: dict[str, dict[str, float]] = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6},
    "y": _LENGTH,
    "z": _LENGTH,
    "speed": {"rpm": math.pi / 30.0, "hz": 2.0 * math.pi, "rad_s": 1.0},
    "force": _FORCE,
    "force_y": _FORCE,
    "force_z": _FORCE,
}
#: Columns by name: quantity and factor to SI; the voltage of a once-per-turn probe may have any unit.
COLUMNS = {f"{name}_{unit}": (name, factor) for name, units in UNITS.items() for unit, factor in units.items()}
COLUMNS["key"] = ("key", 1.0)
#: What ``--map`` says of a column that is left out.
IGNORE = "ignore"
#: Unit in which a column is proposed whose head has none.
_USUAL = {"time": "s", "y": "um", "z": "um", "speed": "rpm", "force": "n", "force_y": "n", "force_z": "n"}
#: Other words for a quantity, without those that only fill.
_WORDS = {
    "t": "time", "keyphasor": "key", "trigger": "key", "mark": "key", "rpm": "speed", "spin speed": "speed", "rotor speed": "speed",
    "f": "force", "fx": "force x", "fy": "force y", "fz": "force z",
}  # fmt: skip
_FILLING = {"displacement", "gap", "sensor", "probe", "position", "signal", "shaft"}
#: Other ways to write a unit.
_SPELT = {
    "sec": "s",
    "second": "s",
    "seconds": "s",
    "r/min": "rpm",
    "1/min": "rpm",
    "min^-1": "rpm",
    "min-1": "rpm",
    "rad/s": "rad_s",
}
_VOLTS = {"v", "mv", "volt", "volts"}
_WITH_UNIT = re.compile(r"^(?P<name>.*?)\s*(?:\[(?P<a>[^\]]*)\]|\((?P<b>[^)]*)\)|/\s*(?P<c>\S+)|\s(?P<d>rpm))$")
_EXAMPLE = "for instance time_s,y_um,z_um,key"


@attrs.frozen
class Head:
    """One column: its head, the name in ``COLUMNS`` that it is taken for, and else why it is not; None and "" for one left out.

    ``guess``: the quantity that it seems to be.
    """

    text: str
    name: str | None
    why: str = ""
    guess: str = ""

    def told(self) -> str:
        return f"'{shortened(self.text)}' {f'as {self.name}' if self.name else self.why or 'left out'}"


def shortened(text: str) -> str:
    return text if len(text) <= 40 else f"{text[:37]}..."


def columns_of(
    heads: Sequence[str], mapping: Mapping[str, str] | None = None, where: str = "line 1: "
) -> dict[str, tuple[int, float]]:
    """Place and factor to SI of each quantity that is found.

    Parameters
    ----------
    mapping : head -> name in ``COLUMNS``, or "ignore";  where : what stands before the message

    Raises
    ------
    ValueError
        Heads that say too little, with what every column was taken for and the ``--map`` that mends it.
    """
    mapping = {plain(head): name.strip() for head, name in (mapping or {}).items()}
    if all(_is_number(head) for head in heads):
        raise ValueError(f"{where.rstrip(': ')} must name the columns, {_EXAMPLE}")
    _refuse_mapping(heads, mapping, where)
    found = _taken(heads, mapping)
    if any(head.why for head in found):
        raise ValueError(_message(found, where))
    names = [COLUMNS[head.name][0] for head in found if head.name]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        doubled = [head for head in found if head.name and COLUMNS[head.name][0] in twice]
        raise ValueError(
            f"{where}{', '.join(twice)} stands there twice. Found: {', '.join(head.told() for head in found)}. Leave one out: "
            f"{_options([(doubled[-1].text, IGNORE)], where)}"
        )
    return {COLUMNS[head.name][0]: (place, COLUMNS[head.name][1]) for place, head in enumerate(found) if head.name}


def plain(head: str) -> str:
    """A head in small letters, with u for micro and single blanks."""
    return " ".join(unicodedata.normalize("NFKC", head).replace("μ", "u").lower().split())


def quantity_of(head: str) -> str:
    """What a head seems to name: "time", "y", "force y", or a word that is none of them."""
    return _parts(plain(head))[0]


def _taken(heads: Sequence[str], mapping: Mapping[str, str]) -> list[Head]:
    """Each head for itself, then the axes together: X beside Y is another thing than X beside Z."""
    parts = [_parts(plain(head)) for head in heads]
    open_ = [k for k, head in enumerate(heads) if mapping.get(plain(head)) != IGNORE]
    axes = {kind: {parts[k][0][-1] for k in open_ if parts[k][0] in _axes(kind)} for kind in ("", "force ")}
    found = []
    for head, (quantity, unit) in zip(heads, parts, strict=True):
        name = mapping.get(plain(head))
        if name is not None:
            found.append(Head(head, None if name == IGNORE else name))
            continue
        kind = "force " if quantity.startswith("force ") else ""
        found.append(_named(head, quantity, unit, axes[kind] if quantity in _axes(kind) else set()))
    return found


def _axes(kind: str) -> tuple[str, ...]:
    return tuple(f"{kind}{axis}" for axis in "xyz")


def _parts(head: str) -> tuple[str, str | None]:
    """Quantity in ``_WORDS``' terms and unit of a plain head; "" and None where it does not say."""
    split = _WITH_UNIT.match(head)
    name, unit = (
        (split["name"], next(u for u in (split["a"], split["b"], split["c"], split["d"]) if u is not None))
        if split
        else (head, None)
    )
    words = re.split(r"[\s_.:-]+", name)
    if unit is None and len(words) > 1:
        for count in (2, 1):  # rad_s has two words
            if _unit("_".join(words[-count:])) in _KNOWN:
                words, unit = words[:-count], "_".join(words[-count:])
                break
    if unit is None and head == "rpm":
        unit = "rpm"
    if (
        unit is None
        and len(words) > 1
        and _WORDS.get(words[-2], words[-2]) in {*UNITS, "x"}
        and words[-1] not in {"x", "y", "z"}
    ):
        words, unit = words[:-1], words[-1]
    kept = " ".join(word for word in words if word and word not in _FILLING)
    if not kept and any(word in _FILLING - {"shaft"} for word in words):
        kept = "y"  # one displacement has no axis of its own
    return _WORDS.get(kept, kept), None if unit is None else _unit(unit)


def _unit(text: str) -> str:
    text = text.strip().replace(" ", "")
    return _SPELT.get(text, text)


_KNOWN = {unit for units in UNITS.values() for unit in units} | _VOLTS


def _named(head: str, quantity: str, unit: str | None, axes: set[str]) -> Head:
    """One head, with the axes of all heads of its kind."""
    if quantity == "key":
        return Head(head, "key")
    if "x" in axes and "z" in axes:
        if quantity.endswith("x"):
            return Head(head, None, "may be along the shaft or across it")
    elif "x" in axes:
        quantity = quantity[:-1] + {"x": "y", "y": "z"}[quantity[-1]]
    name = quantity.replace(" ", "_")
    if name not in UNITS:
        return Head(head, None, "names no known quantity")
    if unit is None:
        return Head(head, None, "has no unit", name)
    if unit in _VOLTS:
        return Head(head, None, "is a voltage: multiply it by the sensor's sensitivity first", name)
    if unit not in UNITS[name]:
        return Head(head, None, f"has the unit '{unit}', known are {', '.join(UNITS[name])}", name)
    return Head(head, f"{name}_{unit}")


def _refuse_mapping(heads: Iterable[str], mapping: Mapping[str, str], where: str) -> None:
    """A map of a column that is not there, to a name that does not exist, or to another unit than the head's own."""
    there = {plain(head): head for head in heads}
    for head, name in mapping.items():
        if head not in there:
            raise ValueError(
                f"{where}no column '{shortened(head)}' for --map; there are {', '.join(map(repr, there.values()))}"
            )
        if name != IGNORE and name not in COLUMNS:
            raise ValueError(f'{where}--map "{there[head]}={name}": unknown name{nearest(name, COLUMNS)}; known: {_names()}')
        unit, (quantity, _) = _parts(head)[1], COLUMNS.get(name, ("key", 0.0))
        if quantity != "key" and unit in _KNOWN and f"{quantity}_{unit}" != name:
            remedy = f"{quantity}_{unit} is" if unit in UNITS[quantity] else "values in that unit are"
            raise ValueError(f"{where}'{there[head]}' cannot be {name}: its head has another unit, and {remedy} meant")


def _message(found: Sequence[Head], where: str) -> str:
    """One message: the columns, what each was taken for, the map that mends it."""
    bad = [head for head in found if head.why]
    there = {COLUMNS[head.name][0] for head in found if head.name} | {head.guess for head in bad}
    missing = [name for name in ("time", "y", "z", "key") if name not in there]
    pairs = []
    for head in bad:
        unit = _parts(plain(head.text))[1]
        if head.guess and unit is not None:
            continue  # its unit is the fault, which no name mends
        name = head.guess or next((name for name in missing if _fits(name, unit)), IGNORE)
        if name in missing:
            missing.remove(name)
        units = UNITS.get(name, {})
        pairs.append((head.text, f"{name}_{unit if unit in units else _USUAL[name]}" if units else name))
    close = nearest(plain(bad[0].text), COLUMNS) if len(bad[0].text) < 30 else ""
    first = f"unknown column '{shortened(bad[0].text)}'{close}" if len(bad) == 1 else f"{len(bad)} columns are not known"
    mend = f"Say what is meant, for instance {_options(pairs, where)}; " if pairs else ""
    return f"{where}{first}. Found: {', '.join(head.told() for head in found)}. {mend}names: {_names()} ({_EXAMPLE})"


def _fits(name: str, unit: str | None) -> bool:
    """Whether an unknown column may be a quantity, by its unit."""
    return name == "key" if unit in _VOLTS else unit is None or unit in UNITS.get(name, {})


def _names() -> str:
    """``COLUMNS``, the units of one quantity together."""
    return ", ".join([*(f"{name}_{'|'.join(units)}" for name, units in UNITS.items()), "key", IGNORE])


def _options(pairs: Iterable[tuple[str, str]], where: str) -> str:
    """What to type; a record in memory has no command line."""
    pairs = list(pairs)
    inside = ", ".join(f'"{head}": "{name}"' for head, name in pairs)
    if not where:
        return f"columns={{{inside}}}"
    words = " ".join(f'--map "{head}={name}"' for head, name in pairs)
    return f"{words} (in Python columns={{{inside}}})"


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
