"""What a person sees: tables made from the same dictionaries that ``--json`` prints.  Prints nothing by itself.

text          sections, tables, numbers with units
result        one run
plan          what a scene needs
studies       comparisons, sweeps, studies of precision and of stability
verification  reference cases
kept          the caches
"""

from raceway.commands.screen.kept import cache_screen
from raceway.commands.screen.plan import plan_screen
from raceway.commands.screen.result import run_screen
from raceway.commands.screen.studies import compare_screen, precision_screen, stability_screen, sweep_screen
from raceway.commands.screen.text import Row, grouped, number, rows_table, sections, tilt_words, written
from raceway.commands.screen.verification import verify_screen

__all__ = [
    "Row", "cache_screen", "compare_screen", "grouped", "number", "plan_screen", "precision_screen", "rows_table", "run_screen",
    "sections", "stability_screen", "sweep_screen", "tilt_words", "verify_screen", "written",
]  # fmt: skip
