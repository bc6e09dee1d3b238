"""Frequency response functions and time histories in universal files (UFF type 58), by pyuff.

Universal file datasets 58 (function at nodal degree of freedom) and 164 (units), SDRL, University of Cincinnati, as pyuff prints
them: specific data types, units labels, units factors.
"""

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeAlias

import attrs
import numpy as np

from raceway import SceneError
from raceway.extend import LARGEST, evened, memory_for, size_of, write_whole
from raceway_measure.fit.column_headers import FORCED, IGNORE, unscaled
from raceway_measure.fit.signals import Signals, signals_of

#: A dataset, as pyuff reads it.
_Set: TypeAlias = dict[str, Any]
#: Endings of universal files.
_ENDINGS = {".uff", ".unv", ".u58", ".bunv"}
#: Form -> specific data types of ordinate and denominator; sdypy's names (frf_form).
_FORMS = {"receptance": (8, 13), "mobility": (11, 13), "accelerance": (12, 13), "dynamic_stiffness": (13, 8)}
_FORCES, _FREQUENCY, _TIME, _LEAST = {9, 13}, 18, 17, 8
#: Function types, by number, and specific data types, in words.
_FUNCTIONS = (
    "general function", "time history", "auto spectrum", "cross spectrum", "frequency response", "transmissibility", "coherence",
    "auto correlation", "cross correlation", "power spectral density", "energy spectral density", "probability density", "spectrum",
)  # fmt: skip
_QUANTITIES = {
    2: "stress",
    3: "strain",
    5: "temperature",
    8: "displacement",
    9: "force",
    11: "velocity",
    12: "acceleration",
    13: "force",
}
#: Part of an interval by which times of two channels may differ, by rounding.
_SAME = 0.1
#: Names of a record's columns by the specific data types that it may have.
_COLUMNS = {8: "y_m", 11: "velocity_m_s", 12: "acceleration_m_s2", 13: "force_n"}
_LENGTHS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "in": 0.0254, "ft": 0.3048}
_NEWTONS = {"n": 1.0, "kn": 1e3, "lbf": 4.4482216152605}
_UNITS = {
    "8": _LENGTHS,
    "11": {f"{unit}/s": size for unit, size in _LENGTHS.items()},
    "12": {f"{unit}/s2": size for unit, size in _LENGTHS.items()} | {"g": 9.80665},
    "13": _NEWTONS,
}


@attrs.frozen(eq=False)
class FrequencyResponse:
    """Displacement over force at one point."""

    source: str  # its file
    hz: np.ndarray  # (n,) frequencies [Hz], greater than 0
    receptance: np.ndarray  # (n,) complex [m/N]
    notes: tuple[str, ...] = ()  # sentences on units and form that a reader needs

    def to_uff(self, path: str | Path) -> Path:
        """Write it as dataset 58, double precision and binary: the same bits are read again.

        RacewayError: pyuff is not installed, or a file that cannot be written.
        """
        path = Path(path)
        write_whole(b"", path)
        labels = {"abscissa": "Hz", "ordinate": "m", "orddenom": "N"}
        kinds = dict(zip(labels, (_FREQUENCY, *_FORMS["receptance"]), strict=True))
        import pyuff

        pyuff.UFF(str(path)).write_sets(
            {
                "type": 58, "func_type": 4, "binary": 1, "id1": "receptance, raceway", "abscissa_spacing": 0,
                "rsp_node": 1, "rsp_dir": 2, "ref_node": 1, "ref_dir": 2, "x": self.hz, "data": self.receptance,
                **{f"{axis}_spec_data_type": kind for axis, kind in kinds.items()},
                **{f"{axis}_axis_units_lab": label for axis, label in labels.items()},
            },
            mode="add",  # its "overwrite" loses the heading of binary sets
        )  # fmt: skip
        return path


def is_response(data: object) -> bool:
    """Whether data are a universal file, by its ending."""
    return isinstance(data, str | Path) and Path(data).suffix.lower() in _ENDINGS


def response_of(path: str | Path, columns: Mapping[str, str] | None = None) -> FrequencyResponse | Signals:
    """The drive-point frequency response function of a universal file, as receptance in SI; without one, its time histories.

    columns : number of a function, from 1, -> its form, with a factor to SI where the file states no unit or another one
        ("accelerance*9.80665"), that of a time history -> a column's name ("force_n*100"), or "ignore"

    SceneError: The function's fault, or what the file holds instead, and the remedy.
    """
    import pyuff

    path, columns_map = Path(path), {str(number): name for number, name in (columns or {}).items()}
    try:
        with memory_for(size_of(path, LARGEST)):
            file = pyuff.UFF(str(path))
            types = [int(kind) for kind in file.get_set_types()]
            sets = [file.read_sets(k) for k, kind in enumerate(types) if kind in (58, 164)]
    except OSError as why:
        raise SceneError.at(str(path), None, f"cannot be read: {why.strerror or why}") from None
    except Exception as why:  # pyuff raises nothing narrower
        raise SceneError.at(str(path), None, f"cannot be read as a universal file: {why}") from None
    every = [table for table in sets if table["type"] == 58]
    kind = 4 if any(table["func_type"] == 4 for table in every) else 1
    functions = [table for table in every if table["func_type"] == kind]
    words = {str(k + 1): _function_words(table) for k, table in enumerate(functions)}
    try:
        if not functions:
            kinds = Counter(map(_content_words, every)) or Counter(f"dataset {number}" for number in types) or {"dataset": 0}
            raise ValueError(
                f"holds {', '.join(f'{count} x {text}' for text, count in kinds.items())}: a frequency response (function type 4), or time "
                "histories (type 1) of force and response, are needed. Export one of them"
            )
        if unknown := next((k for k in columns_map if k not in words), None):
            reason = f"no function {unknown} for --map; there are {'; '.join(f'{k}: {text}' for k, text in words.items())}"
            raise ValueError(reason)
        tables = {k: table for k, table in zip(words, functions, strict=True) if columns_map.get(k) != IGNORE}
        factors = next((units for units in sets if units["type"] == 164), None)
        if kind == 1:
            return _histories(str(path), tables, factors, columns_map)
        points = {k: table for k, table in tables.items() if _at_one_point(table)} or tables
        if len(points) != 1:
            names = "; ".join(f"{k}: {words[k]}" for k in points)
            raise ValueError(
                f'one frequency response function is fitted, there are {names}: leave others out with --map "NUMBER={IGNORE}"'
            )
        ((number, table),) = points.items()
        return _read_function(str(path), table, factors, number, columns_map.get(number, ""))
    except SceneError as why:
        names = "; ".join(f"{k}: {_content_words(table)}, {words[k]}" for k, table in zip(words, functions, strict=True))
        raise SceneError.at(str(path), None, f"{why.mistakes[0].message}; functions: {names}") from None
    except ValueError as why:
        raise SceneError.at(str(path), None, str(why)) from None


def _content_words(table: _Set) -> str:
    """What a function is, in words."""
    quantity = _QUANTITIES.get(table["ordinate_spec_data_type"], "an unknown quantity")
    return f"{dict(enumerate(_FUNCTIONS)).get(table['func_type'], 'other function')} of {quantity}"


def _histories(source: str, tables: Mapping[str, _Set], factors: _Set | None, meanings: Mapping[str, str]) -> Signals:
    """Time histories as a record: responses at the point of the force where there are such."""
    kinds = {k: 13 if (kind := table["ordinate_spec_data_type"]) in _FORCES else kind for k, table in tables.items()}
    forces = [k for k in tables if kinds[k] == 13 or meanings.get(k, "").startswith("force")]
    points = {k: (table["rsp_node"], abs(table["rsp_dir"])) for k, table in tables.items()}
    near = {k for k in tables if points[k] in [points[force] for force in forces]}
    if near - {*forces}:
        tables = {k: tables[k] for k in tables if k in near}
    columns: dict[str, np.ndarray] = {}
    names, notes = {k: name for k, name in meanings.items() if k in tables}, []
    for k, table in tables.items():
        clock, values = evened(np.asarray(table["x"], float)), np.asarray(table["data"])
        over = table["abscissa_spec_data_type"], table["abscissa_axis_units_lab"].strip().lower()
        if over[0] not in (0, _TIME) or over[1] not in ("", "none", "s", "sec") or np.iscomplexobj(values):
            raise ValueError(f"function {k} is no real signal over time in s")
        first = columns.setdefault("time_s", clock)
        if len(first) != len(clock) or (np.abs(first - clock) > _SAME * np.ptp(clock) / len(clock)).any():
            raise ValueError(f"function {k} has other times than those before it: export the channels of one measurement")
        columns[k] = values
        if k in meanings or (name := _COLUMNS.get(kinds[k])) is None:
            continue
        size, unit = _data_unit(table, "ordinate", kinds[k], factors, k, name)
        if kinds[k] != 13 and forces and table["rsp_dir"] * tables[forces[0]]["rsp_dir"] < 0:
            size, unit = -size, f"{unit}, against the direction of the force"
        names[k] = f"{name}*{float(size)!r}"
        notes.append(f"function {k} is read as {_QUANTITIES[kinds[k]]} in {unit}")
    record = signals_of(columns, names, FORCED, "functions: ")
    return attrs.evolve(record, source=source, notes=(*record.notes, *notes))


def _function_words(table: _Set) -> str:
    return f"{table['id1'].strip()}, response {table['rsp_node']}:{table['rsp_dir']}, force {table['ref_node']}:{table['ref_dir']}"


def _at_one_point(table: _Set) -> bool:
    return bool(table["rsp_node"] == table["ref_node"] and abs(table["rsp_dir"]) == abs(table["ref_dir"]))


def _read_function(source: str, table: _Set, factors: _Set | None, number: str, meaning: str) -> FrequencyResponse:
    """One function as receptance; ``ValueError`` with the remedy."""
    notes = []
    kinds = tuple(13 if (kind := table[f"{axis}_spec_data_type"]) in _FORCES else kind for axis in ("ordinate", "orddenom"))
    form, scale = unscaled(meaning)
    form = form or next((name for name, pair in _FORMS.items() if pair == kinds), "")
    if form not in _FORMS:
        raise ValueError(
            f"function {number} states no known form ({meaning or f'data types {kinds[0]} over {kinds[1]}'}): "
            f'--map "{number}=FORM", one of {", ".join(_FORMS)}'
        )
    if scale is None:
        parts = zip(("ordinate", "orddenom"), _FORMS[form], strict=True)
        upper, lower = (_data_unit(table, axis, kind, factors, number, form) for axis, kind in parts)
        scale = upper[0] / lower[0]
        notes.append(f"{form.replace('_', ' ')} in {upper[1]} over {lower[1]}")
    hz, values = np.asarray(table["x"], float), scale * np.asarray(table["data"])
    if table["abscissa_spec_data_type"] not in (0, _FREQUENCY) or table["abscissa_axis_units_lab"].strip().lower() not in (
        "",
        "none",
        "hz",
    ):
        raise ValueError(f"function {number} is not over frequency in Hz")
    if len(hz) != len(values) or not (np.isfinite(hz).all() and np.isfinite(values).all()) or (np.diff(hz) <= 0.0).any():
        raise ValueError(f"function {number}: frequencies must grow, and each needs one finite number")
    above = (hz > 0.0) & (values != 0.0)
    hz, values = hz[above], values[above]
    if len(hz) < _LEAST or not np.iscomplexobj(values):
        raise ValueError(f"function {number} has {len(hz)} complex numbers above 0 Hz: at least {_LEAST} are needed")
    omega = 2.0 * np.pi * hz
    if form != "receptance":
        values = {"mobility": values / (1j * omega), "accelerance": -values / omega**2}.get(form, 1.0 / values)
    if table["rsp_dir"] * table["ref_dir"] < 0:
        values = -values
        notes.append("force and response are counted in opposite directions: the sign is reversed")
    if not _at_one_point(table):
        notes.append(
            f"force and response are of two points ({_function_words(table)}): K is a transfer stiffness, not that of the drive point"
        )
    return FrequencyResponse(source, hz, values, tuple(notes))


def _data_unit(table: _Set, axis: str, kind: int, factors: _Set | None, number: str, form: str) -> tuple[float, str]:
    """Factor to SI and words of a unit: by its label, else by the file's dataset 164, else SI."""
    label = table[f"{axis}_axis_units_lab"].strip()
    plain = label.lower().replace("µ", "u").replace("²", "2").replace("^", "").replace("**", "").replace(" ", "")
    by_file = None if factors is None else 1.0 / factors["force" if kind == 13 else "length"]
    remedy = f'--map "{number}={form}*FACTOR" with the factor to SI'
    if plain in ("", "none"):
        si = {8: "m", 11: "m/s", 12: "m/s2", 13: "N"}[kind]
        return (1.0, f"{si} (no unit is stated)") if by_file is None else (by_file, f"{by_file:.6g} {si} (dataset 164)")
    size = _UNITS[str(kind)].get(plain)
    if size is None:
        raise ValueError(f"function {number} has the unit '{label}', known are {', '.join(_UNITS[str(kind)])}: {remedy}")
    if by_file is not None and abs(size / by_file - 1.0) > 1e-4:
        raise ValueError(
            f"function {number} has the unit '{label}', the file's dataset 164 one of {by_file:.6g} in SI: say which by {remedy}"
        )
    return size, label
