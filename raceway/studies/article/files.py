"""The study on disk: page, pictures, JSON and CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import attrs

from raceway.pipeline.result import without_nan, write_json
from raceway.plugins.pictures import save_figure
from raceway.storage.files import write_whole
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.article import causes
from raceway.studies.article.figures import pictures as all_pictures
from raceway.studies.article.report import page, verdict_rows

if TYPE_CHECKING:
    from raceway.studies.article.panel import Picture
    from raceway.studies.article.study import Article

_DOTS_PER_INCH = 110


def write(study: Article, folder: Path, pictures: bool = True, command: str = "raceway study article") -> list[Path]:
    """Write everything; the files, the page first.

    Raises
    ------
    RacewayError
        matplotlib is missing, or a folder or disk that cannot be written.
    """
    content = study.to_dict()
    files = [write_json(content, folder / "article.json")]
    files += [write_csv(rows, folder / f"{name}.csv") for name, rows in _tables(study, content).items()]
    if pictures:
        drawn = all_pictures(study)
        files += save_pictures(drawn, folder)
        files.insert(0, page(study, drawn, command).write(folder / "article.html"))
    return files


def save_pictures(drawn: Iterable[Picture], folder: Path) -> list[Path]:
    """Each as a PNG of its name."""
    return [save_figure(one.figure(), folder / f"{one.name}.png", _DOTS_PER_INCH) for one in drawn]


def _tables(study: Article, content: ReadTables) -> dict[str, list[Tables]]:
    scan = [
        {"axial_n": load, "tilt_stiffness": stiffness, "k_ratio": ratio}
        for load, rows in study.scan.items()
        for stiffness, ratio in zip(causes.STIFFNESSES, without_nan(causes.hardening(rows).tolist()), strict=True)
    ]
    trends = []
    for one in study.trends:
        flat = attrs.asdict(one, filter=lambda field, _: field.name not in ("expected", "computed"))
        for name in ("expected", "computed"):
            values: Sequence[object] = getattr(one, name) or ()
            flat |= {f"{name}_{place}": value for place, value in enumerate(values)}
        trends.append({**flat, "off_in_last_digits": one.off, "holds": one.holds})
    return {
        "curves": content["rows"],
        "verdicts": verdict_rows(study),
        "quasi-static": trends,
        "static": list(study.static),
        "rig": list(study.rig),
        "friction": content["friction_trends"],
        "tilt-stiffness": scan,
    }


def write_csv(rows: Iterable[ReadTables], path: Path) -> Path:
    """A table with every key of any row as a column."""
    found = list(rows)
    text = io.StringIO()
    writer = csv.DictWriter(text, list(dict.fromkeys(key for row in found for key in row)), lineterminator="\n")
    writer.writeheader()
    writer.writerows(found)
    return write_whole(text.getvalue().encode(), path)
