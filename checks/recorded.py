"""Answers beside those in ``tests/recorded``: what a change does to numbers and words that no test of its own looks at.

A record holds what is alike to six digits on processors with and without AVX-512 and under a load that differs by 1e-9 of it and 1e-9 N; the rest, which
is rounding, and what depends on time and place is "~".  An answer that changes on purpose, which CHANGELOG tells: delete its record and let
the tests write it, then again as the other processor, as ``.ci/run`` sets it:

    RACEWAY_RECORD=0 .venv/bin/python -m pytest tests/test_recorded.py tests/test_commands.py -k "recorded or screen_fits" -m "not slow"
    NUMBA_CPU_NAME=x86-64-v3 ... RACEWAY_RECORD=1e-9 .venv/bin/python -m pytest ...
"""

import json
import os
import re
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parents[1] / "tests" / "recorded"
#: Relative difference of numbers that are alike, and that a later answer may have from the record: other processors and
#: versions of libraries stop iterations elsewhere, and a quantity that is a difference loses digits.
ALIKE, LIMIT = 1e-6, 1e-4
#: Of the largest number of a list, which may be a row of K.
_ROUNDING = 1e-9
UNSTABLE = "~"
#: Lines and other items of a list that are recorded; of a longer one every second, every third, ...
_LINES, _ITEMS = 60, 8
#: Parts of results that depend on the machine and its load.
_LEFT_OUT = {"cost", "environment", "predicted_wall_s", "predicted_at_least", "predicted_bytes", "iterations", "evaluations"}
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
_MEASURED = re.compile(rf"{_NUMBER.pattern}(?=\s*(?:[mµun]?s|min|h|CPU-s|[kMG]i?B)\b)")


def differences(name: str, answer: Any) -> list[str]:
    """Where an answer differs from its record; none where the record is written.

    answer : made of dicts, lists, numbers and text, lines of which are compared as printed
    """
    path = FOLDER / f"{re.sub(r'[^a-z0-9]+', '-', name.lower()).strip('-')}.json"
    new = _bare(json.loads(json.dumps(answer, default=str)))
    if not os.environ.get("RACEWAY_RECORD"):
        return list(_apart(json.loads(path.read_text(encoding="utf-8")), new, ""))
    if path.exists():
        new = _agreed(json.loads(path.read_text(encoding="utf-8")), new)
    path.parent.mkdir(exist_ok=True)
    rows = [f"{json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}" for key, value in new.items()]
    path.write_text("{\n" + ",\n".join(rows) + "\n}\n", encoding="utf-8")
    return []


def _bare(value: Any) -> Any:
    """Without run times, with eight digits."""
    if isinstance(value, dict):
        cases = {
            key for key, item in value.items() if key == "left_out" and isinstance(item, int)
        }  # of laws of other tests, too
        return {key: _bare(item) for key, item in value.items() if key not in _LEFT_OUT | cases}
    if isinstance(value, list):
        most = _LINES if value and isinstance(value[0], str) else _ITEMS
        return [_bare(item) for item in value[:: len(value) // most + 1]]
    if isinstance(value, str):
        words = " ".join(_MEASURED.sub(UNSTABLE, value).split())
        return UNSTABLE if words.startswith("wall time ") else words  # of which compiling is a part, the first time
    return float(f"{value:.8g}") if isinstance(value, float) else value


def _agreed(one: Any, other: Any) -> Any:
    if isinstance(one, dict) and isinstance(other, dict):
        return {key: _agreed(one.get(key, UNSTABLE), other.get(key, UNSTABLE)) for key in {**one, **other}}
    if isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        return [_agreed(*pair) for pair in zip(one, other, strict=True)]
    return one if not list(_apart(one, other, "", ALIKE)) else UNSTABLE


def _apart(record: Any, new: Any, place: str, limit: float = LIMIT, least: float = 0.0) -> Any:
    """Lines of what differs; ``least`` : difference of numbers that counts, where they stand beside larger ones."""
    if record == UNSTABLE:
        return
    if isinstance(record, dict) and isinstance(new, dict):
        for key in record.keys() | new.keys():
            yield from _apart(record.get(key, "nothing"), new.get(key, "nothing"), f"{place}.{key}", limit)
    elif isinstance(record, list) and isinstance(new, list) and len(record) == len(new):
        least = max(least, _ROUNDING * max((abs(one) for one in record if isinstance(one, float)), default=0.0))
        for k, pair in enumerate(zip(record, new, strict=True)):
            yield from _apart(*pair, f"{place}[{k}]", limit, least)
    elif isinstance(record, str) and isinstance(new, str):
        told = [_NUMBER.findall(text) for text in (record, new)]
        near = all(abs(float(a) - float(b)) < 1.5 * _last_digit(a) for a, b in zip(*told, strict=False))
        if _NUMBER.sub("0", record) != _NUMBER.sub("0", new) or len(told[0]) != len(told[1]) or not near:
            yield f"{place}: {record!r} -> {new!r}"
    elif isinstance(record, float | int) and isinstance(new, float | int) and not isinstance(record, bool):
        if not abs(record - new) <= max(least, limit * max(abs(record), abs(new))):
            yield f"{place}: {record} -> {new}"
    elif record != new:
        yield f"{place}: {record} -> {new}"


def _last_digit(number: str) -> float:
    """What the last printed digit stands for."""
    mantissa, _, power = number.partition("e")
    return float(f"1e{int(power or 0) - len(mantissa.partition('.')[2])}")
