"""Tables for the screen, made from the same dictionaries that ``--json`` prints.  Prints nothing by itself.

text          sections, numbers with units
rows          a table of rows with the same keys
wrapping      lines that end between words
result        one run;  result_answer: what stands first;  result_parts, result_model: its sections below
plan          what a scene needs
kept          the caches
damping       what a rotor model should know of a dry bearing's damping
"""

from raceway.commands.screen.kept import cache_screen
from raceway.commands.screen.plan import plan_screen
from raceway.commands.screen.result import run_screen
from raceway.commands.screen.rows import rows_table
from raceway.commands.screen.text import Row, grouped, micro, number, sections, tilt_words, written
from raceway.commands.screen.wrapping import Words

__all__ = [
    "Row", "Words", "cache_screen", "grouped", "micro", "number", "plan_screen", "rows_table", "run_screen", "sections", "tilt_words", "written",
]  # fmt: skip
