"""Types of what files hold before it is checked: a scene's TOML, a result's JSON, a study's rows."""

from collections.abc import Mapping
from typing import Any

#: Tables of a TOML or JSON file as it has them: numbers, words, lists and tables in them, which are checked where they are read.
Tables = dict[str, Any]
#: The same, only looked at.
ReadTables = Mapping[str, Any]
