"""Column headers of a record: quantity, axis and unit, whatever program wrote them.

``time_s``, ``Time (s)``, ``"t [ms]"``, ``Zeit [s]``, ``in s``, ``X [µm]``, ``Displacement Y / mm``, ``Keyphasor (V)``, ``Speed [r/min]``,
``Force [N]`` and ``Acceleration [m/s^2]`` are understood.  Sensors named X and Y stand across a shaft along z: they are y and z here, where
x is the shaft.
"""

import math
import re
import unicodedata
from collections.abc import Mapping, Sequence

import attrs

from raceway.extend import is_numeral, nearest

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
    "velocity": {"m_s": 1.0, "mm_s": 1e-3},
    "acceleration": {"m_s2": 1.0, "mm_s2": 1e-3, "g": 9.80665},
}
#: Columns by name: quantity and factor to SI; the voltage of a once-per-turn probe may have any unit.
COLUMNS = {f"{name}_{unit}": (name, factor) for name, units in UNITS.items() for unit, factor in units.items()}
COLUMNS["key"] = ("key", 1.0)
#: Name of a column that is left out.
IGNORE = "ignore"
#: Unit in which a column is proposed whose header has none.
_USUAL = {"time": "s", "y": "um", "z": "um", "speed": "rpm"} | dict.fromkeys(("force", "force_y", "force_z"), "n")
#: Quantities that a record of force and displacement must have, and one of a rig: their words; others that stand for them.
FORCED: dict[str, str] = {"time": "time", "force": "force", "y": "displacement"}
ORBIT: dict[str, str] = {name: name for name in ("time", "y", "z", "key")}
_INSTEAD = {"force": {"force_y", "force_z"}, "displacement": {"z", "velocity", "acceleration"}, "key": {"speed"}}
#: Other words for a quantity, and words that name none.
_WORDS = {
    "t": "time", "keyphasor": "key", "trigger": "key", "mark": "key", "rpm": "speed", "spin speed": "speed", "rotor speed": "speed",
    "acc": "acceleration", "accel": "acceleration", "f": "force", "fx": "force x", "fy": "force y", "fz": "force z",
}  # fmt: skip
_SENSOR = {"displacement", "gap", "sensor", "probe", "position", "signal"}
_FILLING = {*_SENSOR, "shaft"}
#: Other spellings of a unit.
_SPELLINGS = {
    "sec": "s", "second": "s", "seconds": "s", "r/min": "rpm", "1/min": "rpm", "min^-1": "rpm", "min-1": "rpm", "rad/s": "rad_s",
    "newton": "n", "newtons": "n", "kilonewton": "kn", "micron": "um", "microns": "um", "m/s": "m_s", "mm/s": "mm_s", "m/s2": "m_s2", "m/s^2": "m_s2",
    "mm/s2": "mm_s2", "mm/s^2": "mm_s2",
}  # fmt: skip
_VOLTS = {"v", "mv", "uv", "kv", "volt", "volts"}
_ALL_UNITS = {unit for units in UNITS.values() for unit in units} | _VOLTS
_WITH_UNIT = re.compile(
    r"^(?P<name>.*?)\s*(?:\[(?P<a>[^\]]*)\]|\((?P<b>[^)]*)\)|/\s*(?P<c>\S+)|\s(?P<d>rpm)|(?:^|\s)in\s(?P<e>\S+))$"
)
_AXIS = re.compile(r"(?P<kind>force )?[xyz]")
#: A name with a factor: of a sensor's sensitivity per volt.
_SCALED = re.compile(r"(?P<name>.*?)\s*(?P<sign>[*/])\s*(?P<size>[-+]?[\d.]+(?:e[-+]?\d+)?)", re.IGNORECASE)
_TO_VOLTS = {"mv": 1e-3, "uv": 1e-6, "kv": 1e3}
_SENSITIVITY = 'as in --map "CH1=force_n*100" (100 N per V) or --map "CH2=x_um/8e-3" (8e-3 V per um)'
_EXAMPLE = "for instance time_s,y_um,z_um,key"


@attrs.frozen
class _Header:
    """One column's header; ``name``: what it is read as, in ``COLUMNS``; ``fault``: why it is not; neither for a column left out.

    ``guess``: the quantity that it seems to be;  ``scale``: of its numbers, before the unit's.
    """

    text: str
    name: str = ""
    fault: str = ""
    guess: str = ""
    scale: float = 1.0

    def __str__(self) -> str:
        return f"'{_short_text(self.text)}' {f'as {self.name}' if self.name else self.fault or 'left out'}"


def columns_of(
    headers: Sequence[str],
    mapping: Mapping[str, str] | None = None,
    where: str = "line 1: ",
    needed: Mapping[str, str] = ORBIT,
) -> dict[str, tuple[int, float]]:
    """Index and factor to SI of each quantity among the columns.

    mapping : header, with its unit or without, -> a header that is understood, perhaps with a factor ("x_um/8e-3": 8e-3 V per um),
        or "ignore";  where : prefix of messages;  needed : quantities that columns which are not understood may be, and their words

    ValueError: Headers that are not understood, with the meaning of every column and the ``--map`` that mends it.
    """
    mapping = _mapping(headers, mapping or {})
    # A map of a column that does not exist, to an unknown name, or to another unit than the header's.
    texts = {_clean(text): text for text in headers}
    for header, meaning in mapping.items():
        name, scale = unscaled(meaning)
        if header not in texts:
            words = f"{where}no column '{_short_text(header)}' for --map; there are {', '.join(map(repr, texts.values()))}"
            raise ValueError(words)
        if name != IGNORE and _with_y(name) not in COLUMNS:
            rule = f"unknown name{nearest(name, COLUMNS)}; known: {_names()}"
            raise ValueError(f'{where}--map "{texts[header]}={name}": {rule}')
        unit, quantity = _header_parts(header)[1], COLUMNS.get(_with_y(name), ("key", 0.0))[0]
        if unit in _VOLTS and quantity != "key":
            if scale is None:
                words = f"{where}'{texts[header]}' is a voltage: {name} needs the sensor's sensitivity, {_SENSITIVITY}"
                raise ValueError(words)
            continue
        if quantity != "key" and unit in _ALL_UNITS and f"{quantity}_{unit}" != _with_y(name):
            remedy = f"{quantity}_{unit} is" if unit in UNITS[quantity] else "values in that unit are"
            raise ValueError(f"{where}'{texts[header]}' cannot be {name}: its header has another unit, and {remedy} meant")
    columns = _meanings_of(headers, mapping)
    if any(header.fault for header in columns):
        raise ValueError(_message(columns, where, needed))
    by_quantity = [(COLUMNS[header.name][0], header) for header in columns if header.name]
    quantities = [quantity for quantity, _ in by_quantity]
    duplicates = [(quantity, header) for quantity, header in by_quantity if quantities.count(quantity) > 1]
    if duplicates:
        advice = f"Found: {', '.join(map(str, columns))}. Ignore one: {_options([(duplicates[-1][1].text, IGNORE)], where)}"
        raise ValueError(f"{where}{', '.join(sorted({quantity for quantity, _ in duplicates}))} is duplicated. {advice}")
    if "time" not in quantities or len(quantities) < 2:
        missing = "no column for time" if "time" not in quantities else "time alone is no record"
        words = f"found: {', '.join(map(str, columns))}; needed: {', '.join(needed.values())}"
        raise ValueError(f'{where}{missing}; {words}: save it, too, or name its column, for instance --map "HEADER=time_s"')
    factors = {k: (*COLUMNS[header.name], header.scale) for k, header in enumerate(columns) if header.name}
    return {quantity: (k, factor * scale) for k, (quantity, factor, scale) in factors.items()}


def _clean(text: str) -> str:
    """A header in small letters, with u for micro and single blanks."""
    return " ".join(unicodedata.normalize("NFKC", text).replace("μ", "u").lower().split())


def _mapping(headers: Sequence[str], mapping: Mapping[str, str]) -> dict[str, str]:
    """Plain headers -> names; a header may be named without its unit in brackets, where one header has that name."""
    names = [re.sub(r"\s*[\[(][^\])]*[\])]$", "", text) for text in map(_clean, headers)]
    full = {name: _clean(text) for name, text in zip(names, headers, strict=True) if names.count(name) == 1}
    plain = {_clean(text): name.strip() for text, name in mapping.items()}
    return {text if text in map(_clean, headers) else full.get(text, text): name for text, name in plain.items()}


def over_time(headers: Sequence[str], mapping: Mapping[str, str] | None = None) -> bool:
    """Whether a column is time."""
    meanings = _mapping(headers, mapping or {})
    return any(_header_parts(unscaled(meanings.get(_clean(text), _clean(text)))[0])[0] == "time" for text in headers)


def unscaled(name: str) -> tuple[str, float | None]:
    """Name and factor of ``NAME*FACTOR`` or ``NAME/FACTOR``; None without one."""
    if not (match := _SCALED.fullmatch(name)) or not is_numeral(match["size"]) or not float(match["size"]):
        return name, None
    size = float(match["size"])
    return match["name"], size if match["sign"] == "*" else 1.0 / size


def _meanings_of(headers: Sequence[str], mapping: Mapping[str, str]) -> list[_Header]:
    """Each header by itself, then the axes together: X beside Y is another axis than X beside Z."""
    meanings = {text: unscaled(name) for text, name in mapping.items()}
    # Names that say x are read as headers that say x: beside Y it stands across the shaft.
    stand_ins = {
        text: name
        for text, (name, _) in meanings.items()
        if any(name not in COLUMNS and _with_y(name) in COLUMNS for name, _ in meanings.values()) and name != IGNORE
    }
    parts = [_header_parts(stand_ins.get(_clean(text), _clean(text))) for text in headers]
    axes: dict[str | None, set[str]] = {"force ": set(), None: set()}
    for text, (quantity, _) in zip(headers, parts, strict=True):
        if mapping.get(_clean(text)) != IGNORE and (match := _AXIS.fullmatch(quantity)):
            axes[match["kind"]].add(quantity[-1])
    columns = []
    for text, (quantity, unit) in zip(headers, parts, strict=True):
        plain = _clean(text)
        name, scale = meanings.get(plain, ("", None))
        if plain in meanings and plain not in stand_ins:
            header = _Header(text, "" if name == IGNORE else name)
        else:
            match = _AXIS.fullmatch(quantity)
            header = _header(text, quantity, unit, axes[match["kind"]] if match else set())
        volts = _TO_VOLTS.get(_header_parts(plain)[1] or "", 1.0)
        columns.append(header if scale is None else attrs.evolve(header, scale=scale * volts))
    return columns


def _with_y(name: str) -> str:
    return re.sub(r"^(force_)?x_", r"\1y_", name)


def _header_parts(text: str) -> tuple[str, str | None]:
    """Quantity in the terms of ``_WORDS`` and unit of a plain header; "" and None where it has none."""
    match = _WITH_UNIT.match(text)
    name = match["name"] if match else text
    unit = next((match[group] for group in "abcde" if match[group] is not None), None) if match else None
    words = re.split(r"[\s_.:-]+", name)
    if unit is None and len(words) > 1:
        for count in (2, 1):  # rad_s has two words
            if _spelt("_".join(words[-count:])) in _ALL_UNITS:
                words, unit = words[:-count], "_".join(words[-count:])
                break
    if unit is None and text == "rpm":
        unit = "rpm"
    if unit is None and len(words) > 1 and words[-1] not in set("xyz") and _WORDS.get(words[-2], words[-2]) in {*UNITS, "x"}:
        words, unit = words[:-1], words[-1]
    if unit is not None and _spelt(unit) in UNITS["time"]:  # in any language
        return "time", _spelt(unit)
    quantity = " ".join(word for word in words if word and word not in _FILLING)
    if not quantity and _SENSOR.intersection(words):
        quantity = "y"  # one displacement has no axis of its own
    return _WORDS.get(quantity, quantity), None if unit is None else _spelt(unit)


def _spelt(unit: str) -> str:
    unit = unit.strip().replace(" ", "")
    return _SPELLINGS.get(unit, unit)


def _header(text: str, quantity: str, unit: str | None, axes: set[str]) -> _Header:
    """One header, with the axes of all headers of its kind."""
    if quantity == "key":
        return _Header(text, "key")
    if axes >= {"x", "z"}:
        if quantity.endswith("x"):
            return _Header(text, fault="may be along the shaft or across it")
    elif "x" in axes:
        quantity = quantity[:-1] + {"x": "y", "y": "z"}[quantity[-1]]
    name = quantity.replace(" ", "_")
    if name not in UNITS:
        return _Header(text, fault="names no known quantity")
    if unit is None:
        return _Header(text, fault="has no unit", guess=name)
    if unit in _VOLTS:
        return _Header(
            text, fault=f"is a voltage: multiply it by the sensor's sensitivity first, {_SENSITIVITY}", guess=name
        )
    if unit not in UNITS[name]:
        return _Header(text, fault=f"has the unit '{unit}', known are {', '.join(UNITS[name])}", guess=name)
    return _Header(text, f"{name}_{unit}")


def _message(columns: Sequence[_Header], where: str, required: Mapping[str, str]) -> str:
    """One message: the columns, the meaning of each, which of the needed ones is missing, the map that mends it."""
    faulty = [header for header in columns if header.fault]
    present = {COLUMNS[header.name][0] for header in columns if header.name} | {header.guess for header in faulty}
    absent = [word for name, word in required.items() if not present & {name, *_INSTEAD.get(word, ())}]
    missing = [name for name, word in required.items() if word in absent]
    pairs = []
    for header in faulty:
        unit = _header_parts(_clean(header.text))[1]
        if header.guess and unit is not None:
            continue  # its unit is the fault, which no name mends
        likely = [name for name in missing if unit is None or unit in UNITS.get(name, _VOLTS)]
        likely += [name for name in missing if unit in _VOLTS and required is FORCED and name != "time"]
        name = next(iter([header.guess] * bool(header.guess) + likely), IGNORE)
        if name in missing:
            missing.remove(name)
        units = UNITS.get(name, {})
        meaning = f"{name}_{unit if unit in units else _USUAL[name]}" if units else name
        pairs.append((header.text, f"{meaning}*FACTOR" if units and unit in _VOLTS else meaning))
    first = f"{len(faulty)} columns are not known"
    if len(faulty) == 1:
        (text,) = (header.text for header in faulty)
        first = f"unknown column '{_short_text(text)}'{nearest(_clean(text), COLUMNS) if len(text) < 30 else ''}"
    first += f"; missing: {', '.join(absent)}" * bool(absent)
    if required is FORCED and len(columns) < len(required):
        first += f"; {len(columns)} columns cannot be all of them: save all channels in one file"
    mend = f"State the quantity, for instance {_options(pairs, where)}; " if pairs else ""
    mend += f"FACTOR is the sensor's per V, {_SENSITIVITY}; " if "*FACTOR" in mend else ""
    return f"{where}{first}. Found: {', '.join(map(str, columns))}. {mend}names: {_names()} ({_EXAMPLE})"


def _names() -> str:
    """``COLUMNS``, the units of one quantity together."""
    return ", ".join([*(f"{name}_{'|'.join(units)}" for name, units in UNITS.items()), "key", IGNORE])


def _options(pairs: Sequence[tuple[str, str]], where: str) -> str:
    """The option or argument to write; a record in memory has no command line."""
    argument = "columns={" + ", ".join(f'"{header}": "{name}"' for header, name in pairs) + "}"
    options = " ".join(f'--map "{header}={name}"' for header, name in pairs)
    return f"{options} (in Python {argument})" if where else argument


def _short_text(text: str) -> str:
    return text if len(text) <= 40 else f"{text[:37]}..."
