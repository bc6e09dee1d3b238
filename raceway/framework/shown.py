"""Objects that show themselves briefly: in at most 15 lines of text, and as one table in a notebook."""

from collections.abc import Iterable, Sequence
from html import escape
from math import floor, log10
from textwrap import shorten

from raceway.storage.tables import ReadTables

#: Name, value with its unit, and what is to be known of it.
Fact = tuple[str, str, str]
#: Lines of text, the title's and the line of what is left out included, and characters of a line, at most.
LINES, WIDTH = 15, 100
_TABLE = "border-collapse:collapse;max-width:46em;font-size:14px;line-height:1.35"
_CELL = "text-align:left;vertical-align:top;padding:2px 14px 2px 0;border:0"
#: Numbers are never broken; words of a remark are, rather than that the table is wider than the screen.
_WHOLE, _BROKEN = "white-space:nowrap;font-variant-numeric:tabular-nums", "overflow-wrap:anywhere;opacity:0.75"


class Shown:
    """What has a short text and a table of its own, from a title and facts."""

    __slots__ = ()

    def _facts(self) -> tuple[str, Sequence[Fact]]:
        """Title, whose first line is bold, and facts in the order of their weight: the one duty of who shows itself."""
        raise NotImplementedError

    def __repr__(self) -> str:
        title, facts = self._facts()
        return facts_text(title, facts)

    def _repr_html_(self) -> str:
        title, facts = self._facts()
        return facts_html(title, facts)


def facts_text(title: str, facts: Sequence[Fact]) -> str:
    """A title and facts in columns; what is more than fits is counted."""
    head = [shorten(line, WIDTH, placeholder=" ...") for line in title.splitlines()[:2]]
    room = LINES - len(head)
    shown = facts if len(facts) <= room else facts[: room - 1]
    names = max((len(name) for name, _, _ in shown), default=0)
    values = max((len(value) for _, value, remark in shown if remark), default=0)
    gap = "  " if values else ""
    lines = [f"  {name:{names}}  {value:{values}}{gap}{remark}".rstrip() for name, value, remark in shown]
    lines += [f"  and {len(facts) - len(shown)} more"] if len(shown) < len(facts) else []
    return "\n".join([*head, *(line if len(line) <= WIDTH else f"{line[: WIDTH - 4]} ..." for line in lines)])


def facts_html(title: str, facts: Sequence[Fact]) -> str:
    """A table that needs nothing else; on a narrow screen its cells become narrower, and none is cut off."""
    first, _, body = title.partition("\n")
    head = f"<strong>{escape(first)}</strong>{f'<br>{escape(body)}' if body else ''}"
    rows = "".join(f"<tr>{_cells(*fact)}</tr>" for fact in facts)
    return f'<table style="{_TABLE}"><caption style="text-align:left;padding:4px 0">{head}</caption><tbody>{rows}</tbody></table>'


def _cells(name: str, value: str, remark: str) -> str:
    cell = f'<td style="{_CELL};{_WHOLE}">{escape(value)}</td>' if value else ""
    wide = "" if value else ' colspan="2"'
    return f'<td style="{_CELL}">{escape(name)}</td>{cell}<td style="{_CELL};{_BROKEN}"{wide}>{escape(remark)}</td>'


def tilt_words(tilt: float | str) -> str:
    """The tilt boundary, which belongs to every stiffness."""
    return f"tilt {tilt}" if isinstance(tilt, str) else f"tilt against {tilt:g} N m/rad"


def in_micro(value: float) -> str:
    """Micro-units of metres or radians; rounding noise of a straight line, a circle or a symmetric state is 0."""
    return "0" if abs(value) < 1e-15 else f"{1e6 * value:.4g}"


def largest_facts(equilibrium: ReadTables, when: str) -> list[Fact]:
    """Largest ball load and pressure of a table that has them, each with its race."""
    load, pressure = (race_words(equilibrium[f"largest_{quantity}_race"]) for quantity in ("ball_load", "pressure"))
    return [
        ("largest ball load", number(equilibrium["largest_ball_load_n"], "N"), f"{load}, {when}"),
        ("largest pressure", number(1e-6 * equilibrium["largest_pressure_pa"], "MPa"), f"Hertz, {pressure}"),
    ]


def race_words(race: str) -> str:
    """A race by name; "both" of two with the same number."""
    return "both races" if race == "both" else f"{race} race"


def number(value: float | None, unit: str = "", digits: int = 5) -> str:
    """Significant digits and unit; a dash for what is not there."""
    if value is None:
        return "-"
    text = f"{value + 0.0:.{digits}g}"
    return f"{text} {unit}" if unit else text


def number_within(value: float, error: float, unit: str) -> str:
    """A number down to the first digit of its absolute error, and never more than five digits."""
    digits = 5
    if value != 0.0 and error > 0.0:
        digits = min(digits, max(1, floor(log10(abs(value))) - floor(log10(error)) + 1))
    places = digits - 1 - floor(log10(abs(value))) if value != 0.0 else 0
    return f"{round(value, places):.0f} {unit}" if places <= 0 and abs(value) < 1e5 else number(value, unit, digits)


def percents(*changes: float) -> str:
    """Both ends of relative changes in percent, or the one that there is."""
    ends = (f"{100.0 * change:+.{'2g' if abs(change) < 0.995 else '0f'}}" for change in (min(changes), max(changes)))
    return f"{' to '.join(dict.fromkeys(ends))} %"


#: Share of an interval below which a side counts as none, and two sides as alike.
_SIDE = 0.02


def interval_percents(change: Iterable[float], even: str = "+- ") -> str:
    """Both ends of relative changes round 0 in percent; one number with ``even`` of alike sides, with its sign of a single side."""
    ends = 0.0, *change
    low, high = min(ends), max(ends)
    if abs(low + high) <= _SIDE * (high - low):
        return f"{even}{percents(high)[1:]}"
    return percents(*(end for end in (low, high) if abs(end) > _SIDE * (high - low)))


def duration(seconds: float) -> str:
    """A time in the two largest units that a person reads: "5 h 50 min"."""
    if seconds < 99.5:
        return number(seconds, "s", 2)
    minutes = round(seconds / 60.0)
    hours, minutes = divmod(minutes, 60)
    days, hours = divmod(hours, 24)
    parts = [(days, "d"), (hours, "h"), (minutes, "min")]
    first = next(k for k, (count, _) in enumerate(parts) if count)
    return " ".join(f"{count} {unit}" for count, unit in parts[first : first + 2] if count)
