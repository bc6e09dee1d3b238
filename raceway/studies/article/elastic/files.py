"""The study on disk: page, pictures, JSON and a table of all runs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from raceway.pipeline.result import write_json
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.article.elastic.figures import pictures as all_pictures
from raceway.studies.article.elastic.report import page
from raceway.studies.article.files import save_pictures, write_csv

if TYPE_CHECKING:
    from raceway.studies.article.elastic.study import ElasticArticle


def write(study: ElasticArticle, folder: Path, pictures: bool, command: str) -> list[Path]:
    """Write everything; the files, the page first.

    Raises
    ------
    RacewayError
        matplotlib is missing, or a folder or disk that cannot be written.
    """
    content = study.to_dict()
    files = [write_json(content, folder / "article-elastic.json")]
    files.append(write_csv(_columns(content["rows"]), folder / "article-elastic.csv"))
    if pictures:
        drawn = all_pictures(content)
        files += save_pictures(drawn, folder)
        stress = [
            folder / name for row in content["rows"] for name in row.get("pictures") or [] if (folder / name).is_file()
        ]
        files += stress
        section = next((file.read_bytes() for file in stress if file.suffix == ".png"), None)
        files.insert(0, page(content, drawn, section, command).write(folder / "article-elastic.html"))
    return files


def _columns(rows: Sequence[ReadTables]) -> list[Tables]:
    """Flat rows without what is a table in other rows: its own columns stay empty where there is none."""
    found = [flat(row) for row in rows]
    inner = {name.rpartition(".")[0] for row in found for name in row}
    return [{name: value for name, value in row.items() if name not in inner} for row in found]


def flat(table: ReadTables, before: str = "") -> Tables:
    """Numbers and words of nested tables, with their names joined by dots; lists are left to the JSON file."""
    out: Tables = {}
    for name, value in table.items():
        if isinstance(value, dict):
            out |= flat(value, f"{before}{name}.")
        elif not isinstance(value, list):
            out[f"{before}{name}"] = value
    return out
