"""Size and cost of many points, before any of them is computed."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import closing
from pathlib import Path
from typing import ClassVar

import attrs
import numpy as np

from raceway.answers.answer import Answer, Part
from raceway.answers.table import Row, Words, sections
from raceway.errors import RacewayError
from raceway.framework.registry import Registry
from raceway.framework.shown import duration
from raceway.planning.cost import START_S, slowness
from raceway.planning.plan import column_time, make_plan
from raceway.points.function import BLOCK, Function
from raceway.points.store import Store, connected, exists
from raceway.scene.scene import scene_from_dict
from raceway.storage.files import size_words
from raceway.storage.tables import ReadTables, Tables

#: Least time of a run, an equilibrium with what is stated beside it, and time to store a number [s].
_RUN_S, _STORED_S = 2e-3, 0.5e-6
#: Memory of a process with its kernels; of a number while files are written, and on the disk, in both files [bytes].
_STARTED_BYTES, _HELD, _ON_DISK = 280 * 2**20, 23.0, 16.5


@attrs.frozen(eq=False, repr=False, slots=False)
class Workload(Answer):
    """What a command with many points would compute.

    Attributes
    ----------
    points : in all, of which ``stored`` are finished and ``refused`` by rules;  ``looped`` : in compiled loops;  runs : one by one
    seconds : wall time, with compiled kernels in the cache;  at_most : whether it is an upper limit
    bytes : resident memory of a process at the peak;  disk_bytes : of what is written, without pictures
    noun : of a point;  why_runs : why no compiled loop computes them;  remarks : sentences below
    """

    stem: ClassVar[str] = "plan"
    title: str
    points: int
    seconds: float
    looped: int = 0
    runs: int = 0
    refused: int = 0
    stored: int = 0
    at_most: bool = False
    bytes: float = 0.0
    disk_bytes: float = 0.0
    noun: str = "points"
    why_runs: str = ""
    remarks: tuple[str, ...] = ()

    def to_dict(self) -> Tables:
        """All numbers; times in seconds, sizes in bytes."""
        return {
            "title": self.title,
            **{name: getattr(self, name) for name in ("points", "looped", "runs", "refused", "stored")},
            "predicted_wall_s": self.seconds,
            "predicted_at_most": self.at_most,
            "predicted_bytes": self.bytes or None,
            "predicted_disk_bytes": self.disk_bytes or None,
            "remarks": [*([f"runs: {self.why_runs}"] if self.runs and self.why_runs else []), *self.remarks],
        }

    def report(self) -> Iterator[Part]:
        """Size, memory and time, then how the points are computed."""
        most = "at most " if self.at_most else ""
        rows: list[Row] = [
            ("Size and cost, predicted", "", ""),
            (self.noun, f"{most}{self.points}", ""),
            ("wall time", f"{most}{duration(self.seconds)}", "with compiled kernels in the cache"),
            *([("memory", size_words(self.bytes), "at the peak")] if self.bytes else []),
            *([("on the disk", size_words(self.disk_bytes), "without pictures")] if self.disk_bytes else []),
            ("How they are computed", "", ""),
        ]
        ways = {"compiled loop": self.looped, "runs": self.runs, "refused": self.refused, "stored": self.stored}
        reasons = {"runs": self.why_runs, "refused": "by rules of the scene", "stored": "finished before"}
        taken = {name: count for name, count in ways.items() if count or name != "stored"}
        rows += [(name, f"{most if count else ''}{count}", reasons.get(name, "")) for name, count in taken.items()]
        yield Words(self.title, "bold")
        yield sections(rows)
        yield from self.remarks


def run_times(
    count: int, tables_at: Callable[[int], ReadTables], registry: Registry, planned: int = 100
) -> tuple[float, int]:
    """Predicted time of runs, one after another in a process [s], and how many of them rules refuse: of so many ``planned`` ones."""
    seconds, refusals, bodies = 0.0, 0, dict[str, float]()
    looked_at = np.unique(np.linspace(0, count - 1, min(count, planned)).astype(int)).tolist()
    for number in looked_at:
        try:
            scene = scene_from_dict(tables_at(number), registry)
            plan = make_plan(scene)
        except RacewayError:
            refusals += 1
            continue
        bodies[scene.bodies.name] = max(plan.predicted_once_s, bodies.get(scene.bodies.name, 0.0))
        seconds += max(plan.predicted_wall_s - plan.predicted_once_s, _RUN_S)
    share = count / max(len(looked_at), 1)
    return seconds * share + sum(bodies.values()), round(refusals * share)


def of_columns(
    title: str, function: Function, points: int, stored: int = 0, numbers: int = 0, noun: str = "points"
) -> Workload:
    """Points of a compiled loop, of each of which so many ``numbers`` are stored."""
    left = points - stored
    threads = max(min(function.threads, -(-left // BLOCK[function.moving])), 1)
    each = column_time(make_plan(function.scene), function.moving) / threads + slowness() * _STORED_S * numbers
    remarks = "Points without a regular solution in the loop are run in addition, as raceway plan SCENE predicts each."
    return Workload(
        title, points, slowness() * START_S + left * each, looped=left, stored=stored, noun=noun, remarks=(remarks,),
        bytes=(_STARTED_BYTES + _HELD * numbers * points) * bool(numbers), disk_bytes=_ON_DISK * numbers * points,
    )  # fmt: skip


def stored_rows(folder: Path | None, keys: Iterable[str]) -> int:
    """How many of a study's rows its folder holds."""
    if folder is None or not exists(folder):
        return 0
    with closing(connected(folder)) as connection:
        return len(Store(folder, connection).keys("done") & set(keys))
