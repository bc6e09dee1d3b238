"""Reports on disk: JSON, the Markdown made of it, and the blocks of the documents."""

from __future__ import annotations

import datetime
import json
import os
import platform
import re
import subprocess
from collections.abc import Container
from contextlib import suppress
from pathlib import Path
from typing import Any

import attrs

from benchmarks.evidence import Row
from benchmarks.evidence._age import ROOT, listed
from benchmarks.evidence._chosen import CHOSEN, chosen

FOLDER = ROOT / "docs" / "reports"
#: What stands for the limit of a row that nothing is asked of.
_NO_LIMIT = ("reported", "told", "for information")
_BLOCK = re.compile(r"(<!-- evidence:([a-z0-9_]+) -->\n)(.*?)(<!-- /evidence -->)", re.DOTALL)


def machine() -> dict[str, Any]:
    """What the numbers were measured on; nothing that names the machine."""
    import numba

    flags = ""
    with suppress(OSError):  # not Linux: the architecture says enough
        flags = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    vector = next((name for flag, name in (("avx512f", "AVX-512"), ("avx2", "AVX2")) if flag in flags), "")
    return {
        "cores": os.cpu_count(),
        "processor": " ".join(part for part in (platform.machine(), vector) if part),
        "system": platform.system(),
        "python": platform.python_version(),
        "numba": numba.__version__,
    }


def commit() -> str:
    """Short name of the commit, with "+ changes" where tracked sources differ from it."""
    try:
        name = _git("rev-parse", "--short", "HEAD")
        changed = _git("status", "--porcelain", "--untracked-files=no", "--", "raceway", "tests", "benchmarks", "validation")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return f"{name} + changes" if changed else name


def _git(*words: str) -> str:
    return subprocess.run(["git", *words], cwd=ROOT, check=True, capture_output=True, text=True).stdout.strip()


def write(name: str, title: str, rows: list[Row], seconds: float, digest: str, folder: Path = FOLDER) -> dict[str, Any]:
    """Write the JSON and the Markdown file of a report; returns the JSON's content.

    ``digest`` is that of the code that the report measures, taken before it was computed.
    """
    data = {
        "title": title,
        "rows": [attrs.asdict(row) for row in rows],
        "command": f"python -m benchmarks.evidence {name}",
        "commit": commit(),
        "machine": machine(),
        "date": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d"),
        "seconds": round(seconds, 1),
        "digest": digest,
    }
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.json").write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    (folder / f"{name}.md").write_text(page(data), encoding="utf-8")
    return data


def read(folder: Path = FOLDER) -> dict[str, dict[str, Any]]:
    """All reports on disk by name."""
    return {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in sorted(folder.glob("*.json"))}


def page(data: dict[str, Any]) -> str:
    """The Markdown file of a report."""
    commands = sorted({row["command"] for row in data["rows"]})
    lines = [f"# {data['title']}", "", table(data), "", _origin(data), ""]
    if commands and commands != [data["command"]]:
        lines += ["To see single rows:", "", *(f"    {command}" for command in commands), ""]
    return "\n".join(lines)


def _origin(data: dict[str, Any]) -> str:
    m = data["machine"]
    return (
        f"Made by `{data['command']}` in {data['seconds']} s, commit {data['commit']}, {data['date']}; "
        f"{m['cores']} cores {m['processor']}, {m['system']}, Python {m['python']}, numba {m['numba']}; "
        f"digest of the code measured: {data['digest'] or 'none'}."
    )


def table(data: dict[str, Any]) -> str:
    """Rows as a Markdown table."""
    lines = ["| quantity | value | limit | holds | note |", "|---|---|---|---|---|"]
    for row in data["rows"]:
        cells = row["quantity"], shown(row["value"]), row["limit"], "yes" if row["ok"] else "**no**", row["note"]
        lines.append("| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines)


def shown(value: float | str) -> str:
    """A value with four significant digits; whole numbers and text as they are."""
    if isinstance(value, float):
        return f"{value:.4g}"
    return str(value)


def summary(reports: dict[str, dict[str, Any]], older: Container[str], links: str = "") -> str:
    """Every report with its counts as a Markdown table; ``links`` is the folder as seen from the document."""
    lines = ["| report | rows that hold | date | commit |", "|---|---|---|---|"]
    for name, data in reports.items():
        commit = f"{data['commit']}, older than the code" if name in older else data["commit"]
        lines.append(f"| [{data['title']}]({links}{name}.md) | {holding(data)} | {data['date']} | {commit} |")
    return "\n".join(lines)


def holding(data: dict[str, Any]) -> str:
    """How many rows with a limit hold, and how many are reported without one that could be missed."""
    judged = [row for row in data["rows"] if row["limit"] not in _NO_LIMIT]
    reported = len(data["rows"]) - len(judged)
    good = f"{sum(row['ok'] for row in judged)} of {len(judged)}" if judged else ""
    return ", ".join(filter(None, [good, f"{reported} reported" if reported else ""]))


def documents() -> list[Path]:
    """Documents that may hold blocks: README.md and everything under docs but the reports themselves."""
    pages = [
        path for path in sorted((ROOT / "docs").rglob("*.md")) if not {FOLDER, ROOT / "docs" / "_build"} & {*path.parents}
    ]
    return [path for path in [ROOT / "README.md", *pages] if path.is_file()]


def render(text: str, reports: dict[str, dict[str, Any]], older: Container[str] = (), links: str = "docs/reports/") -> str:
    """A document's text with every block made anew; ``evidence:summary`` is the table of reports, with a mark at the older ones,
    and the blocks of ``_chosen`` show rows of several.

    Raises
    ------
    KeyError
        A block that names a report which is not on disk.
    """

    def block(match: re.Match[str]) -> str:
        name = match[2]
        if name == "summary":
            body = summary(reports, older, links)
        elif name in CHOSEN:
            body = chosen(name, reports, links)
        elif name in reports:
            body = table(reports[name])
        else:
            raise KeyError(f"a block asks for the report '{name}'; there are {', '.join(reports)}")
        return f"{match[1]}{body}\n{match[4]}"

    return _BLOCK.sub(block, text)


def links_from(document: Path) -> str:
    """The reports' folder as seen from a document."""
    return os.path.relpath(FOLDER, document.parent).replace(os.sep, "/") + "/"


def refresh() -> list[Path]:
    """Rewrite the index of reports and every block; returns the documents that changed."""
    reports, older = read(), listed()
    index = "# Reports\n\nMade by `make evidence`; see `benchmarks/evidence`.\n\n" + summary(reports, older) + "\n"
    (FOLDER / "README.md").write_text(index, encoding="utf-8")
    changed = []
    for path in documents():
        old = path.read_text(encoding="utf-8")
        new = render(old, reports, older, links_from(path))
        if new != old:
            path.write_text(new, encoding="utf-8")
            changed.append(path)
    return changed
