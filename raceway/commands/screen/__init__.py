"""Tables for the screen, made from the same dictionaries that ``--json`` prints.  Prints nothing by itself.

text          sections, tables, numbers with units
result        one run
plan          what a scene needs
kept          the caches
damping       what a rotor model should know of a dry bearing's damping
"""

from raceway.commands.screen.kept import cache_screen
from raceway.commands.screen.plan import plan_screen
from raceway.commands.screen.result import run_screen
from raceway.commands.screen.text import Row, grouped, number, rows_table, sections, tilt_words, written

__all__ = [
    "Row", "cache_screen", "grouped", "number", "plan_screen", "rows_table", "run_screen", "sections", "tilt_words", "written",
]  # fmt: skip
