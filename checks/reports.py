"""Reports on disk as JSON, their pages on the site, and the blocks of the documents; ``python -m checks.reports`` writes both.

``pytest --evidence`` writes the JSON (``checks.claims``).  A block between ``<!-- evidence:NAME -->`` and ``<!-- /evidence -->`` in
README.md and docs is a report's table; nothing in a table is typed by hand.  As an extension of Sphinx (docs/conf.py) the module writes
the pages before they are read, and a link to a report's JSON leads to its page.
"""

import datetime
import itertools
import json
import os
import platform
import re
import subprocess
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "docs" / "reports"
#: What rests on others than ourselves: README shows only these.
OUTSIDE = ("closed form", "published", "other program")
#: Block -> (report, the row's quantity, what it says).
CHOSEN = {
    "readme": (
        ("published", "NSK 7206C, axial stiffness of a pair at 4 preloads: largest relative error",
         "axial stiffness of 7206C pairs against the maker's table, relative"),
        ("rigid", "B7206C, 400, 1200, 2000 N axial: radial stiffness, tilt free: largest relative error",
         "radial stiffness of a B7206C, tilt free, against another solver of rigid rings, relative"),
        ("published", "7-ball deep-groove bearing, three load cases: displacements and tilt: largest relative error",
         "displacements and tilt of a deep-groove bearing against MASTA, relative"),
        ("rigid", "ball-pass frequency, 4, 7 and 12 balls, 300 N axial, 600 N radial, tilt locked and free: largest relative error",
         "ball-pass frequency of a simulated motion, relative"),
        ("rigid", "2900 of 29 160 extreme scenes (1 mN to 1 MN, conformity 0.501 to 0.9, 1 kN m): neither solved nor a motion left free",
         "extreme scenes without an answer, of 2900"),
    )
}  # fmt: skip


def machine() -> dict[str, Any]:
    """What the numbers were measured on; nothing that names the machine."""
    import numba

    flags = ""
    with suppress(OSError):  # not Linux: the architecture says enough
        flags = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    vector = next((name for flag, name in (("avx512f", "AVX-512"), ("avx2", "AVX2")) if flag in flags), "")
    return {
        "cores": os.cpu_count(),
        "processor": " ".join(part for part in (platform.machine(), vector) if part), "system": platform.system(),
        "python": platform.python_version(), "numba": numba.__version__,
    }  # fmt: skip


def commit() -> str | None:
    """Short name of the commit; None where tracked files differ from it, or there is none."""
    try:
        name = _git("rev-parse", "--short", "HEAD")
        changed = _git(
            "status", "--porcelain", "--untracked-files=no", "--", ".", ":!docs/reports", ":!docs/pictures", ":!*.md"
        )
    except (OSError, subprocess.CalledProcessError):
        return None
    return None if changed else name


def _git(*words: str) -> str:
    return subprocess.run(["git", *words], cwd=ROOT, check=True, capture_output=True, text=True).stdout.strip()


def write(
    name: str, title: str, rows: list[dict[str, Any]], seconds: float, command: str, folder: Path = FOLDER
) -> dict[str, Any]:
    """Write the JSON of a report; returns its content."""
    data = {"title": title, "rows": rows, "command": command, "commit": commit(), "machine": machine()}
    data |= {"date": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d"), "seconds": round(seconds, 1)}
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.json").write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return data


def read(folder: Path = FOLDER) -> dict[str, dict[str, Any]]:
    """All reports on disk by name."""
    return {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in sorted(folder.glob("*.json"))}


def setup(app: Any) -> dict[str, bool]:
    """Entry point of Sphinx: pages of the reports, and the links to them."""

    def linked(_: Any, __: str, source: list[str]) -> None:
        source[0] = re.sub(r"(\(reports/\w+)\.json\)", r"\1.md)", source[0])

    app.connect("builder-inited", lambda _: write_pages())
    app.connect("source-read", linked)
    return {"parallel_read_safe": True}


def write_pages(folder: Path = FOLDER) -> None:
    """Write the Markdown page of every report beside its JSON; git ignores them."""
    for name, data in read(folder).items():
        (folder / f"{name}.md").write_text(page(data), encoding="utf-8")


def page(data: dict[str, Any]) -> str:
    """The page of a report."""
    origin = f"`{data['command']}`, {data['seconds']} s, commit {data['commit']}, {data['date']}; machine: JSON file."
    return "\n".join([f"# {data['title']}", "", table(data), "", origin, ""])


def table(data: dict[str, Any]) -> str:
    """Rows of claims as a Markdown table: consecutive rows of one subject under it, sources by number, with their list below."""
    rows = data["rows"]
    sources = sorted({(row["basis"], row["source"]): None for row in rows}, key=lambda source: source[0])
    numbers = {source: k for k, source in enumerate(sources, 1)}
    cells: list[tuple[str, ...]] = []
    for subject, group in itertools.groupby(rows, lambda row: row["quantity"].partition(": ")[0]):
        claims = list(group)
        shared = len(claims) > 1
        if shared:
            cells.append((f"**{subject}**",))
        cells += [_cells(row, f"{subject}: " if shared else "", numbers) for row in claims]
    text = _markdown(("quantity", "value, limit", "basis"), cells)
    for basis, group in itertools.groupby(sources, lambda source: source[0]):
        lines = [f"{numbers[basis, source]}. {source}" for _, source in group]
        text += "\n\n" + "\n".join([f"Basis {basis}:", "", *lines])
    return text


def _markdown(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def _cells(row: dict[str, Any], subject: str, numbers: dict[tuple[str, str], int]) -> tuple[str, ...]:
    unit = f" [{row['unit']}]" if row["unit"] else ""
    value = shown(row["value"])
    return (
        row["quantity"].removeprefix(subject) + unit,
        f"{value if holds(row) else f'**{value}**'}, {limits(row['low'], row['high'])}",
        f"{numbers[row['basis'], row['source']]}" + (f"; misses: {row['misses']}" if row["misses"] else ""),
    )


def limits(low: float | None, high: float | None) -> str:
    """Both ends of a claim."""
    if low is None or high is None:
        return f"≤ {shown(high)}" if low is None else f"≥ {shown(low)}"
    return f"{low:.6g}…{high:.6g}"


def holds(row: dict[str, Any]) -> bool:
    """Verdict of a claim."""
    return not row["misses"]


def shown(value: float | str | None) -> str:
    """A value with four significant digits; whole numbers and text as they are."""
    if isinstance(value, float):
        return f"{value:.4g}"
    return str(value)


def summary(reports: dict[str, dict[str, Any]], links: str = "") -> str:
    """Every report with its counts as a Markdown table; ``links`` is the folder as seen from the document."""
    cells = []
    for name, data in reports.items():
        rows = f"{sum(map(holds, data['rows']))} of {len(data['rows'])}"
        cells.append((f"[{data['title']}]({links}{name}.json)", rows, data["commit"]))
    return _markdown(("report", "rows that hold", "made at"), cells)


def documents() -> list[Path]:
    """Documents that may hold blocks: README.md and everything under docs but the reports themselves."""
    pages = [p for p in sorted((ROOT / "docs").rglob("*.md")) if not {FOLDER, ROOT / "docs" / "_build"} & {*p.parents}]
    return [path for path in [ROOT / "README.md", *pages] if path.is_file()]


def misses(reports: dict[str, dict[str, Any]], links: str = "") -> str:
    """Every row outside its limits under its report as a Markdown table; the reason is in the report."""
    cells: list[tuple[str, ...]] = []
    for name, data in reports.items():
        rows = [row for row in data["rows"] if not holds(row)]
        cells += [(f"**[{name}]({links}{name}.json)**",)] if rows else []
        cells += [(row["quantity"], f"{shown(row['value'])}, {limits(row['low'], row['high'])}") for row in rows]
    return _markdown(("quantity", "value, limit"), cells)


def chosen(block: str, reports: dict[str, dict[str, Any]], links: str) -> str:
    """The rows of a block as a Markdown table; ``links`` is the folder of the reports as seen from the document.  KeyError:
    a report or a row that is not there, or, for README, one that rests on ourselves."""
    cells = []
    for name, quantity, words in CHOSEN[block]:
        rows = [row for row in reports[name]["rows"] if row["quantity"] == quantity]
        if len(rows) != 1:
            raise KeyError(f"the report '{name}' has {len(rows)} rows of {quantity!r}")
        (row,) = rows
        if block == "readme" and row["basis"] not in OUTSIDE:
            raise KeyError(f"README shows {', '.join(OUTSIDE)}, and {quantity!r} is {row['basis']}")
        value = f"{row['value']:.6g}" if isinstance(row["value"], float) and row["value"] > 100 else shown(row["value"])
        link = f"[{name}]({links}{name}.json)"
        cells.append((words, value, limits(row["low"], row["high"]), "yes" if holds(row) else "**no**", link))
    return _markdown(("what", "number", "limit", "holds", "report"), cells)


def render(text: str, reports: dict[str, dict[str, Any]], links: str = "docs/reports/") -> str:
    """A document's text with every block made anew: ``evidence:summary`` is the table of reports, ``evidence:misses`` that of rows
    outside their limits, the blocks of ``CHOSEN`` show rows of several reports, all others a report.

    KeyError: a block that names a report which is not on disk.
    """

    def block(match: re.Match[str]) -> str:
        name = match[2]
        if name == "summary":
            body = summary(reports, links)
        elif name == "misses":
            body = misses(reports, links)
        elif name in CHOSEN:
            body = chosen(name, reports, links)
        elif name in reports:
            body = table(reports[name])
        else:
            raise KeyError(f"a block asks for the report '{name}'; there are {', '.join(reports)}")
        return f"{match[1]}{body}\n{match[4]}"

    return re.compile(r"(<!-- evidence:([a-z0-9_]+) -->\n)(.*?)(<!-- /evidence -->)", re.DOTALL).sub(block, text)


def links_from(document: Path) -> str:
    """The reports' folder as seen from a document."""
    return os.path.relpath(FOLDER, document.parent).replace(os.sep, "/") + "/"


def refresh() -> list[Path]:
    """Write the pages of reports and every block; returns the documents that changed."""
    write_pages()
    reports = read()
    changed = []
    for path in documents():
        old = path.read_text(encoding="utf-8")
        new = render(old, reports, links_from(path))
        if new != old:
            path.write_text(new, encoding="utf-8")
            changed.append(path)
    return changed


if __name__ == "__main__":
    for path in refresh():
        print(f"refreshed {path.relative_to(ROOT)}")
