"""The article's own model: elastic rings and balls at one operating point and in four load cases, beside condensed and rigid bodies.

Runs go one at a time in this process: elastic bodies take gigabytes; each row is stored as soon as its run ends.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import attrs

from raceway import Answer, ConvergenceError, RacewayError, Scene, make_plan
from raceway.extend import (
    Fact, Item, OnProgress, Part, Registry, Tables, Words, Workload, local, row_key, rows_table, stored_rows, without_nan,
    work_through, written,
)  # fmt: skip
from raceway_article.design import RACES
from raceway_article.elastic_design import BODIES, STEPS, ElasticDesign, ElasticRun
from raceway_article.elastic_rows import (
    difference_at_rest, difference_in_motion, over, pressures_of, row_of, stiffness_numbers,
)  # fmt: skip
from raceway_article.remaining_time import RemainingTime

_REFERENCE = BODIES[0]

#: What is not the same with the three kinds of bodies, whatever the scene.
_DIFFERENCES = (
    "Elastic bodies: every node of rings and balls moves, with its own inertia; hexahedra by `bodies.formulation`. Each ball is held "
    "at its azimuth by an ideal cage.",
    "Condensed bodies: full integration of the hexahedra, whatever `bodies.formulation` says, on meshes of their own with the same "
    "number of points along a semi-axis; rings are rigid in inertia, balls have their mass in their meridian planes. The static kyy is "
    "a mean over the places of the points, that of elastic bodies belongs to the one place that they have.",
    "Rigid bodies: one force a contact by Hertz's law, no mesh and no points; friction sticks with Mindlin's first stiffness.",
    "Friction: in the motions only. At rest no point carries traction, so that loads, displacements and pressures are the same with it; "
    "but kyy of condensed and rigid bodies would be that of contacts which stick, of elastic ones not. Elastic bodies have "
    "friction in all directions of the contact's plane, condensed and rigid ones along the groove, in which balls do not roll. No "
    "ball rolls or orbits in any of them: what sticks stays for as long as the motion repeats itself. C is what sliding takes: contacts of "
    "elastic and rigid bodies stick with a stiffness of 1e7 N/m here, a tenth of Mindlin's, so that they hardly slide; those of condensed "
    "bodies, with the compliance of rings and balls, slide in every turn, as rigid ones do without `contact.stick_stiffness`: ten times the C.",
    "The balance of energy is summed over all steps for elastic bodies; for rigid ones it is integrated from the samples, whose "
    "distance it then shows as well; for condensed bodies with contacts at surface points there is none.",
    "Explicit steps, of elastic bodies where the scene has `integrator.kind = 'central_difference'`: without iterations, below the "
    "stable step of elements and contacts, as many a turn as that needs; `integrator.least_step` adds mass, whose share of Z is stated.",
)


@attrs.frozen(eq=False, repr=False, slots=False)
class ElasticArticle(Answer):
    """The study's rows, with their differences from Hertz and from condensed bodies.

    rows : of ``design.runs()``, in their order;  seconds, cpu_s : wall and processor time of this command
    reused : rows that were stored before;  fault : why rows could not be stored; None where they were
    command : what makes the page again
    """

    stem: ClassVar[str] = "article-elastic"

    title: str
    design: ElasticDesign
    rows: list[Tables]
    seconds: float
    cpu_s: float
    reused: int
    fault: RacewayError | None = None
    command: str = "raceway study article --bodies elastic"

    @cached_property
    def of_run(self) -> dict[ElasticRun, Tables]:
        """Completed rows by run."""
        pairs = zip(self.design.runs(), self.rows, strict=True)
        return {run: row for run, row in pairs if row["status"] == "completed"}

    def row(self, phase: str, case: str, bodies: str) -> Tables | None:
        """A completed row; None of a run that failed."""
        runs = (run for run in self.of_run if (run.phase, run.case, run.bodies) == (phase, case, bodies))
        return next((self.of_run[run] for run in runs), None)

    @property
    def failed(self) -> int:
        return len(self.rows) - len(self.of_run)

    def to_dict(self) -> Tables:
        """Everything, as plain tables for JSON; None where a number does not exist."""
        design = self.design
        rows = [self._compared(run, row) for run, row in zip(design.runs(), self.rows, strict=True)]
        content: Tables = without_nan({
            "title": self.title,
            "scene": design.tables,
            "friction": design.friction,
            "speed_rpm": design.speed_rpm,
            "turns": design.turns,
            "steps_per_turn": STEPS,
            "reference": _REFERENCE,
            "what_differs": list(_DIFFERENCES),
            "rows": rows,
            "elements": max((row["cost"]["elements"] or 0 for row in rows), default=0) or None,
            "runs": len(rows),
            "failed": self.failed,
            "cost": {
                "wall_s": self.seconds,
                "cpu_s": self.cpu_s,
                "rows_cpu_s": sum(row["cost"]["cpu_s"] for row in self.rows),
                "reused": self.reused,
            },
        })  # fmt: skip
        return content

    def save(self, folder: str | Path, pictures: bool | str = False) -> list[Path]:
        """Write JSON and CSV, and where ``pictures`` asks for them the figures and the page, which comes first.

        RacewayError: matplotlib is missing, or a folder or disk that cannot be written.
        """
        from raceway_article.elastic_page import columns, drawings, page
        from raceway_article.page import write_tables

        folder, content = Path(folder), self.to_dict()
        pictured = drawings(content) if pictures else []
        files = write_tables(self.stem, content, {self.stem: columns(content["rows"])}, pictured, folder, pictures)
        if not pictures:
            return files
        stresses = [file for row in self.rows for name in row.get("pictures") or [] if (file := folder / name).is_file()]
        section = next((file.read_bytes() for file in stresses if file.suffix == ".png"), None)
        return [page(content, pictured, section, self.command).write(folder / "article-elastic.html"), *files, *stresses]

    def failure(self) -> RacewayError | None:
        if self.fault is None and not self.of_run and all(row["status"] in ("failed", "refused") for row in self.rows):
            return ConvergenceError(f"every run failed; the first reason: {self.rows[0]['reason']}")
        return self.fault

    def _facts(self) -> tuple[str, list[Fact]]:
        from raceway_article.elastic_page import in_short

        return self.title, [("", "", words) for words in in_short(self.to_dict())]

    def report(self) -> Iterator[Part]:
        """What the numbers say, both tables of differences from condensed bodies, failures and cost."""
        from raceway_article.elastic_page import in_short, tables

        content, runs = self.to_dict(), self.design.runs()
        yield Words(self.title, "bold")
        yield from in_short(content)
        for caption, rows in tables(content).items():
            yield rows_table(rows, caption)
        for each, row in zip(runs, self.rows, strict=True):
            if row["reason"]:
                yield Words(f"{each.name}: {row['status']}: {row['reason']}", "magenta")
        if content["elements"]:
            yield Words(f"elements of elastic bodies: {content['elements']}", "magenta")
        cost = f"{len(runs)} runs, {self.failed} failed; {self.seconds:.0f} s, {self.cpu_s:.0f} s of processor time"
        yield Words(cost + (f"; {self.reused} rows taken from earlier" if self.reused else ""), "dim")

    def _compared(self, run: ElasticRun, row: Tables) -> Tables:
        """A row with its run and its differences."""
        table: Tables = {"phase": run.phase, "case": run.case, "bodies": run.bodies, "integrator": run.integrator, "axial_n": run.axial, "radial_n": run.radial, **row}  # fmt: skip
        if row["status"] != "completed":
            return table
        reference = None if run.bodies == _REFERENCE else self.row(run.phase, run.case, _REFERENCE)
        if run.excitation is None:
            # Below the most loaded contacts: over Hertz's, less 1.
            table |= {
                "from_hertz": {race: pressures_of(row["balls"], race) for race in RACES},
                "below_contact": [
                    {
                        **side,
                        "shear_deviation": over(side["largest_shear_pa"], side["hertz_largest_shear_pa"]),
                        "depth_deviation": over(side["depth_m"], side["hertz_depth_m"]),
                    }
                    for side in row["subsurface"]
                ],
            }
            differences = difference_at_rest
        else:
            table |= {"identified": stiffness_numbers(row), "energy_balance": row["stability"]["energy_drift"]}
            differences = difference_in_motion
        return table | {f"from_{_REFERENCE}": None if reference is None else differences(row, reference)}


def elastic_article(
    design: ElasticDesign,
    folder: Path | None,
    kept: Path | None,
    registry: Registry,
    plugins: Sequence[Path],
    on_progress: OnProgress,
    command: str,
) -> ElasticArticle:
    """Compute every run but those in the folder ``kept``, one after the other; what this machine refused is tried again.

    folder : where the section through the most loaded contact is drawn; None: it is not
    command : what makes the page again
    """
    start, cpu = time.monotonic(), time.process_time()
    runs = design.runs()
    scenes, items = _scenes_and_items(design, registry)
    # The run at rest with elastic bodies under the heaviest load: its most loaded contact is drawn.
    pictured = max(
        (k for k, run in enumerate(runs) if run.excitation is None and run.bodies == "elastic"), key=lambda k: runs[k].axial
    )
    with written(kept) as store:
        store.wait([item.key for item in items if store.get(item.key).content.get("status") == "refused"])
        waiting = [k for k, item in enumerate(items) if store.get(item.key).state == "waiting"]
        seconds = _predictions([scenes[k] for k in waiting])
        kinds = {k: (runs[k].bodies, runs[k].phase) for k in waiting}
        progress = RemainingTime(dict(zip(waiting, seconds, strict=True)), kinds, on_progress)

        def compute(k: int, registry: Registry) -> Tables:
            progress.begin(k, f"{runs[k].bodies} {'at rest' if runs[k].excitation is None else 'in motion'}", runs[k].case)
            return row_of(scenes[k], registry, progress, folder if k == pictured else None)

        rows, reused = work_through(compute, items, store, local(registry, 0), registry, plugins)
    costs = time.monotonic() - start, time.process_time() - cpu
    return ElasticArticle(scenes[0].title, design, rows, *costs, reused, store.fault, command)


def _scenes_and_items(design: ElasticDesign, registry: Registry) -> tuple[list[Scene], list[Item]]:
    runs = design.runs()
    scenes = [design.scene(run, registry) for run in runs]
    keys = [row_key(scene, registry, "article elastic") for scene in scenes]
    return scenes, [Item(key, run.name, k) for k, (key, run) in enumerate(zip(keys, runs, strict=True))]


def elastic_workload(design: ElasticDesign, store: Path | None, registry: Registry) -> Workload:
    """The runs that are not stored, one after another."""
    scenes, items = _scenes_and_items(design, registry)
    left = [scene for scene, item in zip(scenes, items, strict=True) if not stored_rows(store, [item.key])]
    memory = max((make_plan(scene).predicted_bytes for scene in left), default=0)
    return Workload(
        scenes[0].title, len(items), sum(_predictions(left)), runs=len(left), stored=len(items) - len(left),
        bytes=memory, why_runs="bodies of finite elements, one run at a time",
    )  # fmt: skip


def _predictions(scenes: Sequence[Scene]) -> list[float]:
    """Planned time of runs one after the other [s]: what is made once for bodies at rest, or in motion, counts in the first alone."""
    seconds, models = [], set[tuple[str, bool]]()
    for scene in scenes:
        try:
            plan = make_plan(scene)
        except RacewayError:  # its row says why
            seconds.append(0.0)
            continue
        bodies = scene.bodies.name, scene.excitation is not None
        seconds.append(max(plan.predicted_wall_s - (plan.predicted_once_s if bodies in models else 0.0), 0.0))
        models.add(bodies)
    return seconds
