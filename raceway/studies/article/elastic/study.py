"""All runs, one at a time in this process: elastic ones take gigabytes; each row is kept as soon as its run ends."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path

import attrs

from raceway.errors import RacewayError
from raceway.framework.registry import Registry, default_registry
from raceway.pipeline.result import without_nan
from raceway.planning.plan import make_plan
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables
from raceway.studies.article.elastic import deviations
from raceway.studies.article.elastic.design import STEPS, Design, Run
from raceway.studies.article.elastic.run_one import row_of
from raceway.studies.article.elastic.told import OnProgress, Told
from raceway.studies.many.engine import Item, local, work_through
from raceway.studies.many.row_store import RowStore, row_key

#: What is not the same with the three kinds of bodies, whatever the scene.
DIFFERENCES = (
    "Elastic bodies: every node of rings and balls moves, with its own inertia; hexahedra by `bodies.formulation`. Each ball is held "
    "at its azimuth by an ideal cage.",
    "Condensed bodies: full integration of the hexahedra, whatever `bodies.formulation` says, on meshes of their own with the same "
    "number of points along a semi-axis; rings are rigid in inertia, balls have their mass in their meridian planes. The static kyy is "
    "a mean over the places of the points, that of elastic bodies belongs to the one place that they have.",
    "Rigid bodies: one force a contact by Hertz's law, no mesh and no points; friction sticks with Mindlin's first stiffness.",
    "Friction: in the motions only. At rest no point carries traction, so that loads, displacements and pressures are the same with it; "
    "but kyy of condensed and rigid bodies would be that of contacts which stick, of elastic ones not. Elastic bodies have "
    "friction in all directions of the contact's plane, condensed and rigid ones along the groove, in which balls do not roll. No "
    "ball rolls or orbits in any of them: what sticks stays for as long as the motion repeats itself.",
    "The balance of energy is summed over all steps for elastic bodies; for rigid ones it is integrated from the samples, whose "
    "distance it then shows as well; for condensed bodies with contacts at surface points there is none.",
)


@attrs.frozen(eq=False, slots=False)
class ElasticArticle:
    """The study's rows, with what they are held against.

    Attributes
    ----------
    rows : of ``design.runs()``, in their order;  seconds, cpu_s : wall and processor time of this command
    reused : rows that were kept from before;  fault : why rows could not be kept; None where they were
    """

    title: str
    design: Design
    rows: list[Tables]
    seconds: float
    cpu_s: float
    reused: int
    fault: RacewayError | None = None

    @cached_property
    def of_run(self) -> dict[Run, Tables]:
        """Completed rows by run."""
        pairs = zip(self.design.runs(), self.rows, strict=True)
        return {run: row for run, row in pairs if row["status"] == "completed"}

    def cases(self, phase: str) -> list[str]:
        """Load cases at rest, or excitations in motion, in their order."""
        return list(dict.fromkeys(run.case for run in self.design.runs() if run.phase == phase))

    def row(self, phase: str, case: str, bodies: str) -> Tables | None:
        """A completed row; None of a run that failed."""
        runs = (run for run in self.of_run if (run.phase, run.case, run.bodies) == (phase, case, bodies))
        return next((self.of_run[run] for run in runs), None)

    @property
    def failed(self) -> int:
        return len(self.rows) - len(self.of_run)

    def to_dict(self) -> Tables:
        """Everything, as plain tables for JSON; None where a number does not exist."""
        made = self.design
        rows = [self._told(run, row) for run, row in zip(made.runs(), self.rows, strict=True)]
        content: Tables = without_nan(
            {
                "title": self.title,
                "scene": made.tables,
                "friction": made.friction,
                "speed_rpm": made.speed_rpm,
                "turns": made.turns,
                "steps_per_turn": STEPS,
                "reference": deviations.REFERENCE,
                "what_differs": list(DIFFERENCES),
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
            }
        )
        return content

    def _told(self, run: Run, row: Tables) -> Tables:
        """A row with its run, and with what it is held against."""
        told: Tables = {
            "phase": run.phase,
            "case": run.case,
            "bodies": run.bodies,
            "axial_n": run.axial,
            "radial_n": run.radial,
            **row,
        }
        if row["status"] != "completed":
            return told
        reference = None if run.bodies == deviations.REFERENCE else self.row(run.phase, run.case, deviations.REFERENCE)
        if run.excitation is None:
            told |= {"from_hertz": deviations.from_hertz(row), "below_contact": deviations.below_contact(row)}
            held = deviations.at_rest
        else:
            told |= {"identified": deviations.identified(row), "energy_balance": row["stability"]["energy_drift"]}
            held = deviations.in_motion
        return told | {f"from_{deviations.REFERENCE}": None if reference is None else held(row, reference)}


def elastic_article(
    made: Design,
    folder: Path | None = None,
    store: Path | None = None,
    registry: Registry | None = None,
    plugins: Sequence[Path] = (),
    on_progress: OnProgress | None = None,
) -> ElasticArticle:
    """Run the study.

    Parameters
    ----------
    made : by ``raceway.studies.article.elastic.design.design``
    folder : where the section through the most loaded contact is drawn; None: it is not
    store : file that finished rows are kept in and taken from; what this machine refused is tried again

    Raises
    ------
    SceneError
        A mistake in the scene; nothing has been run.
    KeyboardInterrupt
        Finished rows are in ``store``.
    """
    begun, cpu = time.monotonic(), time.process_time()
    registry = registry or default_registry()
    runs = made.runs()
    scenes = [made.scene(run, registry) for run in runs]
    kept = RowStore(store)
    kept.rows = {key: row for key, row in kept.rows.items() if row["status"] != "refused"}
    keys = [row_key(scene, registry, "article elastic") for scene in scenes]
    waiting = [place for place, key in enumerate(keys) if kept.get(key) is None]
    seconds = predicted([scenes[place] for place in waiting], registry)
    kinds = {place: (runs[place].bodies, runs[place].phase) for place in waiting}
    told = Told(dict(zip(waiting, seconds, strict=True)), kinds, on_progress)
    drawn = _drawn(runs)

    def compute(place: int, registry: Registry) -> Tables:
        run = runs[place]
        told.begin(place, f"{run.bodies} {'at rest' if run.excitation is None else 'in motion'}", run.case)
        return row_of(scenes[place], registry, told, folder if place == drawn else None)

    items = [Item(key, run.name, place) for place, (key, run) in enumerate(zip(keys, runs, strict=True))]
    rows, reused = work_through(compute, items, kept, local(registry, 0), registry, plugins)
    taken = time.monotonic() - begun, time.process_time() - cpu
    return ElasticArticle(scenes[0].title, made, rows, *taken, reused, kept.fault)


def predicted(scenes: Sequence[Scene], registry: Registry) -> list[float]:
    """Planned time of runs one after the other [s]: what is made once for bodies at rest, or in motion, counts in the first alone."""
    seconds, made = [], set[tuple[str, bool]]()
    for scene in scenes:
        try:
            plan = make_plan(scene)
        except RacewayError:  # its row says why
            seconds.append(0.0)
            continue
        bodies = scene.bodies.name, scene.excitation is not None
        seconds.append(max(plan.predicted_wall_s - (plan.predicted_once_s if bodies in made else 0.0), 0.0))
        made.add(bodies)
    return seconds


def _drawn(runs: Sequence[Run]) -> int:
    """The run at rest with elastic bodies under the heaviest load: its most loaded contact is drawn."""
    at_rest = [place for place, run in enumerate(runs) if run.phase == "static" and run.bodies == "elastic"]
    return max(at_rest, key=lambda place: runs[place].axial)
