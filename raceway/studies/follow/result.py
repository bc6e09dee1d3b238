"""A followed branch, as tables and files."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import attrs

from raceway.core.periodic.branch import Point
from raceway.framework.doors import door
from raceway.pipeline.result import write_json
from raceway.storage.files import write_whole
from raceway.storage.tables import Tables
from raceway.studies.follow.instead import Instead
from raceway.studies.follow.row import COLUMNS, Row

#: Kinds of labels beside the special points: a local maximum of the swing, a first contact that opens on the way.
PEAK, OPENS = "peak", "contact opens"


@attrs.frozen
class Label:
    """A special point or a peak: its kind and its orbit.

    Attributes
    ----------
    kind : "fold", "branch point", "period doubling", "Neimark-Sacker", PEAK or OPENS
    angle : of the critical pair over a span [rad];  point : of the branch, of special points
    """

    kind: str
    row: Row
    angle: float | None = None
    point: Point | None = attrs.field(default=None, eq=False, repr=False)

    def to_dict(self) -> Tables:
        return {"kind": self.kind, "angle_rad": self.angle, **self.row.to_dict()}


@attrs.define(eq=False)
class Followed:
    """The branch of steady orbits over a key of a scene.

    Attributes
    ----------
    key : of the scene, followed from ``first`` towards ``last``;  span_deg : that the orbits repeat themselves after
    rows : orbits in the order of the branch;  labels : special points and peaks
    end : why it ends before ``last``; "" where it reaches it
    notes : what a user should know;  worst : the most unstable orbit of each unstable stretch
    doubled : branches of twice the period;  instead : what happens beside the orbits ``worst``

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.follow("examples/folds.toml", "excitation.speed_rpm=19000:20000")
    >>> found.labels[0].kind, round(found.labels[0].row.parameter)
    ('fold', 19574)
    """

    key: str
    first: float
    last: float
    span_deg: float
    title: str
    rows: list[Row] = attrs.field(factory=list)
    labels: list[Label] = attrs.field(factory=list)
    end: str = ""
    notes: list[str] = attrs.field(factory=list)
    worst: list[Point] = attrs.field(factory=list, repr=False)
    doubled: list[Followed] = attrs.field(factory=list)
    instead: list[Instead] = attrs.field(factory=list)

    @property
    def unstable(self) -> list[tuple[Row, Row]]:
        """Ends of the stretches of unstable orbits in the order of the branch, at special points where such are known."""
        out: list[tuple[Row, Row]] = []
        marks = [label.row for label in self.labels if label.kind not in (PEAK, OPENS)]
        before: Row | None = None
        for row in self.rows:
            between = [mark for mark in marks if before is not None and before.arc < mark.arc < row.arc]
            was = before is not None and before.verdict == "unstable"
            if row.verdict == "unstable":
                first = out.pop()[0] if was else (between or [row])[0]
                out.append((first, row))
            elif was and between:
                out[-1] = (out[-1][0], between[-1])
            before = row
        return out

    def to_dict(self) -> Tables:
        """Everything, as plain tables for JSON."""
        return {
            "title": self.title,
            "key": self.key,
            "first": self.first,
            "last": self.last,
            "span_deg": self.span_deg,
            "columns": {name: {"unit": unit, "what": words} for name, (unit, words) in COLUMNS.items()},
            "rows": [row.to_dict() for row in self.rows],
            "labels": [label.to_dict() for label in self.labels],
            "unstable": [[one.parameter, two.parameter] for one, two in self.unstable],
            "end": self.end,
            "notes": self.notes,
            "instead": [one.to_dict() for one in self.instead],
            "doubled": [one.to_dict() for one in self.doubled],
        }

    @door
    def write(self, folder: str | Path, picture: bool = True) -> list[Path]:
        """Write follow.json, follow.csv and follow.png; the folder is made when it is missing.

        Raises
        ------
        RacewayError
            The folder cannot be written, or matplotlib is missing.
        """
        folder, content = Path(folder), self.to_dict()
        text = io.StringIO()
        rows = [{"branch": k, **row} for k, one in enumerate((content, *content["doubled"])) for row in one["rows"]]
        table = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
        files = [
            write_json(content, folder / "follow.json"),
            write_whole(text.getvalue().encode(), folder / "follow.csv"),
        ]
        if picture:
            from raceway.plugins.pictures import save_figure
            from raceway.studies.follow.picture import draw

            files.append(save_figure(draw(content), folder / "follow.png", 110))
        return files
