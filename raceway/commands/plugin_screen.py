"""Tables of plug-ins: what is installed, whether it conforms, what was written.  Prints nothing by itself."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from raceway.commands.screen import Words, written
from raceway.framework.contracts import plural
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from raceway.framework.registry import Entry
    from raceway.testing.suite import Conformity


def plugin_rows(entries: Iterable[Entry]) -> list[Tables]:
    """``[{kind, name, distribution, version, options[{name, unit, default, help}]}]``."""
    from raceway.scene.schema import key_schema, keys

    rows = []
    for entry in entries:
        options = []
        for field in keys(entry.plugin):
            facts = key_schema(field)
            meta = field.metadata
            options.append(
                {
                    "name": field.name,
                    "unit": meta.get("unit", ""),
                    "default": facts.get("default"),
                    "rule": meta.get("rule", ""),
                    "help": meta.get("help", ""),
                }
            )
        head = {"kind": entry.kind, "name": entry.name, "distribution": entry.distribution, "version": entry.version}
        rows.append({**head, "options": options})
    return rows


def plugins_screen(rows: Sequence[ReadTables]) -> RenderableType:
    parts: list[RenderableType] = []
    for kind in dict.fromkeys(row["kind"] for row in rows):
        parts.append(Text(plural(kind), style="bold"))
        for row in (r for r in rows if r["kind"] == kind):
            table = Table.grid(padding=(0, 2))
            table.add_column(min_width=20, no_wrap=True)
            table.add_column(min_width=12)
            table.add_column()
            for option in row["options"]:
                default = "" if option["default"] is None else str(option["default"])
                unit = f" [{option['unit']}]" if option["unit"] else ""
                table.add_row(escape(option["name"]), Words(default), Words(option["help"] + unit, "dim"))
            parts.append(Text.assemble("  ", (row["name"], "cyan"), f"  {row['distribution']} {row['version']}"))
            if row["options"]:
                parts.append(Padding(table, (0, 0, 0, 6)))
    return Group(*parts)


def conformity_screen(found: Conformity) -> RenderableType:
    """One line a check, with the duty and what was found."""
    table = Table.grid(padding=(0, 2))
    table.add_column(no_wrap=True)
    table.add_column(no_wrap=True)
    table.add_column()
    for row in found.rows:
        status = Text(row.status, style="green" if row.good else "bold red")
        table.add_row(escape(row.name), status, Words(f"{row.duty}: {row.message}" if row.message else row.duty, "dim"))
    good = sum(row.good for row in found.rows)
    verdict = "conforms" if found.conforms else "does not conform"
    title = f"{found.kind.replace('_', ' ')} '{found.name}' {verdict}: {good} of {len(found.rows)} checks"
    return Group(Text(title, style="bold"), Padding(table, (0, 0, 0, 2)))


def new_plugin_screen(folder: Path, files: Sequence[str]) -> RenderableType:
    steps = f"pip install -e {folder} && python -m pytest {folder}"
    return Group(*written([str(folder), *files]), Text(f"next: {steps}", no_wrap=True, overflow="ignore"))
