"""The reports that ``raceway run`` writes beside result.json.  Part of ``raceway.cli``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from raceway.commands.progress import ProgressBar
from raceway.errors import PluginError, RacewayError
from raceway.framework.sources import blamed

if TYPE_CHECKING:
    from raceway.framework.contracts import Report
    from raceway.framework.registry import Entry, Registry
    from raceway.pipeline.result import Result

#: A report's entry in the registry, and the report with its options' defaults.
Chosen = tuple["Entry", "Report"]


def chosen_reports(names: Sequence[str], registry: Registry) -> list[Chosen]:
    """The reports of these names, each once, before anything is computed.

    Raises
    ------
    PluginError
        A name that no report has, or two; a report whose options have no defaults.
    """
    found = []
    for name in dict.fromkeys(names):
        entry = registry.find("report", name)
        with blamed(str(entry), "making it without options"):
            found.append((entry, entry.plugin()))
    return found


def write_reports(reports: Sequence[Chosen], result: Result, folder: Path, files: list[str]) -> RacewayError | None:
    """Write every report; one that fails stops no other and is told at the end, by name."""
    failures = []
    for entry, report in reports:
        try:
            with ProgressBar(f"report {entry.name}"), blamed(str(entry), "write()"):
                files += [str(path) for path in report.write(result, folder)]
        except PluginError as why:
            failures.append(str(why))
        except RacewayError as why:
            failures.append(f"{entry}: {why}")
    if not failures:
        return None
    return PluginError(f"{'; '.join(failures)}. The result is saved: `{folder / 'result.json'}`")
