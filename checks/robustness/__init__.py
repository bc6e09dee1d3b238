"""Checks of robustness that take minutes: ``python -m checks [NAME...]`` prints their rows; CONTRIBUTING keeps a number of each.

fuzz                  scenes that nobody would write, made from the schema, and calls with wrong arguments
damage                stores that were damaged
signals               commands that are asked to end
words                 length of the documents, terms that the field does not know
unchanged             numbers of results, compared with another commit: --base COMMIT
fmu                   map of an exported FMU against runs, time of a step
points                time of a point of ``raceway.function`` and of a run, and equality of both
app                   time from a change to its picture in the application, memory, numbers beside those of runs
uncertainty           elastic bodies without a mesh against condensed ones; default hypotheses inside the range of the others
"""

import sys
from collections.abc import Callable
from pkgutil import iter_modules

import attrs


@attrs.frozen
class Row:
    """One line of a report.

    quantity : what was measured, with its unit
    value : the number, or a few numbers as text
    limit : what it is held against: an expected value with its tolerance, or a bound
    ok : whether it holds
    note : why it does not hold, or what one should know
    """

    quantity: str
    value: float | str
    limit: str
    ok: bool = attrs.field(converter=bool)
    note: str = ""


def above(quantity: str, value: float, least: float, note: str = "") -> Row:
    """A row for a value that must reach ``least``."""
    return Row(quantity, value, f"at least {least:g}", value >= least, note)


def below(quantity: str, value: float, bound: float, note: str = "") -> Row:
    """A row for a value that must not exceed ``bound``."""
    return Row(quantity, value, f"at most {bound:g}", value <= bound, note)


def show(asked: list[str], there: list[str], rows_of: Callable[[str], list[Row]]) -> int:
    """Print the rows of what is asked for, or of all that is there, a line each; 1 where one does not hold, 2 for another name."""
    if unknown := set(asked) - set(there):
        print(f"nothing is called {', '.join(sorted(unknown))}; there are {', '.join(there)}", file=sys.stderr)
        return 2
    good = True
    for name in asked or there:
        for row in rows_of(name):
            good &= row.ok
            print(f"{'yes' if row.ok else 'NO':4}{name}: {row.quantity}: {row.value} ({row.limit}) {row.note}", flush=True)
    return 0 if good else 1


def names() -> list[str]:
    """Names of all checks."""
    return sorted(module.name for module in iter_modules(__path__) if not module.name.startswith("_"))
