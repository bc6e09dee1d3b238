"""Reports of plug-ins, written beside result.json."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from raceway.errors import PluginError, RacewayError
from raceway.framework.sources import blamed

if TYPE_CHECKING:
    from raceway.framework.contracts import Report
    from raceway.framework.registry import Entry, Registry
    from raceway.pipeline.result import Result

#: A report's entry in the registry, and the report with its options' defaults.
Chosen = tuple["Entry", "Report"]


def chosen_reports(names: Iterable[str], registry: Registry) -> list[Chosen]:
    """The reports of these names, each once, before anything is computed.

    Raises
    ------
    PluginError
        A name that no report has, or two; a report whose options have no defaults.
    """
    reports = []
    for name in dict.fromkeys(names):
        entry = registry.find("report", name)
        with blamed(str(entry), "making it without options"):
            reports.append((entry, entry.plugin()))
    return reports


def write_reports(reports: Sequence[Chosen], result: Result, folder: Path) -> list[Path]:
    """Write every report; one that fails stops no other.

    Raises
    ------
    PluginError
        In the end: which failed, and why.
    """
    failures, files = list[str](), list[Path]()
    for entry, report in reports:
        try:
            with blamed(str(entry), "write()"):
                files += report.write(result, folder)
        except PluginError as why:
            failures.append(str(why))
        except RacewayError as why:
            failures.append(f"{entry}: {why}")
    if not failures:
        return files
    raise PluginError(f"{'; '.join(failures)}. The result is saved: `{folder / 'result.json'}`")
