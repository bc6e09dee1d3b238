"""The reports that ``raceway run`` writes beside result.json.  Part of ``raceway.cli.main``."""

from __future__ import annotations

import io
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from raceway.errors import PluginError, RacewayError
from raceway.framework.sources import blamed
from raceway.out.progress import ProgressBar
from raceway.pipeline.result import without_nan, write_json
from raceway.scene.scene import Scene
from raceway.storage.files import write_whole

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


def save_failure(error: RacewayError, scene: Scene, folder: Path) -> list[Path]:
    """Write ``failure.json`` and, where there are arrays, ``last-good-state.npz``; an older ``result.json`` is renamed.

    Parameters
    ----------
    error : with ``state``, arrays by name: t [s]; q, v, a (5,) displacement [m, rad] and its rates; ball (Z, 2) [m]

    Raises
    ------
    RacewayError
        A folder or disk that cannot be written.
    """
    _set_aside(folder / "result.json")
    arrays = {name: np.asarray(value) for name, value in error.state.items()}
    content = {
        "title": scene.title,
        "error": {"kind": type(error).__name__, "message": str(error)},
        "state": {name: array.tolist() for name, array in arrays.items()},
        "scene": scene.to_dict(),
    }
    paths = [write_json(without_nan(content), folder / "failure.json")]
    if arrays:
        memory = io.BytesIO()
        np.savez(memory, **arrays)  # type: ignore[arg-type]
        paths.append(write_whole(memory.getvalue(), folder / "last-good-state.npz"))
    return paths


def forget_failure(folder: Path) -> None:
    """Remove what an earlier run that failed left beside a new result."""
    for name in ("failure.json", "last-good-state.npz"):
        with suppress(OSError):
            (folder / name).unlink(missing_ok=True)


def _set_aside(result: Path) -> None:
    """The result of another run is not the answer of this one: it stays, under the name ``result-older.json``."""
    with suppress(OSError):
        if result.is_file():
            result.replace(result.with_name("result-older.json"))
