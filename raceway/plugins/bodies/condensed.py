"""The kind of bodies whose finite elements are reduced to what their contacts feel: resultants, or pressures at surface points."""

from __future__ import annotations

from math import ceil, log, pi
from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.errors import Mistake
from raceway.framework.contracts import Cost, Traits
from raceway.framework.duties import is_hertzian, is_swept
from raceway.framework.rules import Rule, mistakes
from raceway.planning.parts import BETWEEN_BALLS, START_S, Balls, Decisions, PlannedMotion, Times, compiled_motion, runs
from raceway.planning.resolve import Problem
from raceway.plugins.bodies.mesh import unrefined
from raceway.scene.tables import SceneTables
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.bodies.columns import ColumnBearing
    from raceway.bodies.model import BuiltBearing
    from raceway.planning.plan import ScenePlan

#: Bytes and seconds of processor time for both rings, by nodes of a section, measured on one core of a small server: the
#: factor of a harmonic, and some seventy of those; balls and a coarser mesh for the error included.
_BYTES_PER_NODE = 25_000
_BASE_S, _SECONDS, _NODES, _POWER = 0.4, 4.8, 4000.0, 1.3
_BYTES_LIMIT = 2 * 2**30
#: A seat that gives way by more than this part of a ball's diameter under the scene's loads holds no bearing.
_GIVES = 0.02


@attrs.frozen
class _SectionCost:
    """Predictions: ``nodes`` of the larger section, ``bytes`` at the peak, ``seconds`` of processor time, nothing kept."""

    nodes: int
    bytes: int
    seconds: float


def section_cost(problem: Problem) -> _SectionCost:
    """Predicted cost of the rings of a condensed scene."""
    b = problem.bearing
    length = 0.34 * b.ball_diameter
    size, along = 0.62 * length, 0.077 * length
    if problem.mesh is not None:
        size = min(float(getattr(problem.mesh, "element_size", size)), size)
        # A contact's semi-major axis is about a tenth of the ball; see raceway.plugins.bodies.condensed_bearing.
        along = min(0.09 * b.ball_diameter / float(getattr(problem.mesh, "nodes_per_semi_axis", 4)), size)
    width = b.width or b.ball_diameter
    wall = (
        0.5 * max(b.pitch_diameter - (b.bore or 0.0), (b.outer_diameter or 0.0) - b.pitch_diameter) - 0.25 * b.ball_diameter
    )
    columns = width / size + 0.7 * b.ball_diameter / along
    rows = wall / size + log(size / along) / log(1.25)
    nodes = ceil(columns * max(rows, 3.0))
    return _SectionCost(nodes, nodes * _BYTES_PER_NODE, _BASE_S + _SECONDS * (nodes / _NODES) ** _POWER)


#: Points along each semi-axis where the scene says nothing.
NODES = 4
#: Bytes that patches may take.
_LIMIT = 4 * 2**30
#: Seconds of processor time, measured on one core of a small server for 12 balls: compliances that are not kept from
#: before, an equilibrium and a step, each a constant and a part that grows with the square of the points per semi-axis.
_SETUP_S, _EQUILIBRIUM_S, _STEP_S = (1.0, 0.07), (0.020, 0.0068), (0.010, 0.0012)
#: The orbit of a first guess, over a step.
MOTION = 150.0
#: Evaluations of a step with friction over those without: 3 and 1 (B7206C, 1 kN, 200 N rotating, 48 steps per turn).
_RUBBING = 3.0


@attrs.frozen
class _PatchCost:
    """Predictions."""

    points: int  # surface points that carry, of a contact at the mean load
    bytes: int  # of compliances and factors
    #: setup_s, equilibrium_s, step_s : processor time [s]
    setup_s: float
    equilibrium_s: float
    step_s: float


def patch_cost(problem: Problem) -> _PatchCost:
    """Predicted cost of the contacts of a scene."""
    n = nodes_of(problem)
    balls = problem.bearing.balls_in_all
    points = int(3.2 * n * n)
    rows = 3.6 * n + 1.0
    # Factors of all contacts; the compliances of both rings in two directions with what is made of them on the way.
    size = 2 * balls * 1.3 * points**2 + 2 * 5.0 * rows * (2.0 * rows) ** 2
    share = balls / 12.0
    steps = _RUBBING if problem.contact.friction > 0.0 else 1.0
    setup, equilibrium, step = (once + more * n * n for once, more in (_SETUP_S, _EQUILIBRIUM_S, _STEP_S))
    return _PatchCost(points, int(8.0 * size), setup, share * equilibrium, steps * share * step)


def nodes_of(problem: Problem) -> int:
    """Points along each semi-axis."""
    return int(getattr(problem.mesh, "nodes_per_semi_axis", NODES))


_INSTEAD = "use discretisation = 'resultant'"
#: Limits of contacts at surface points, each with the way out.
_PATCHES: tuple[Rule[Problem], ...] = (
    Rule(
        "contact.kind", lambda s: s.contact.law.state_size > 0,
        f"has a memory, but surface points of condensed bodies move with the contact: {_INSTEAD}",
    ),
    Rule(
        "integrator.kind",
        lambda s: s.excitation is not None and "record" in s.identifier.method.needs and not s.integrator.method.implicit,
        f"is explicit and needs too many steps for contacts at surface points: use 'newmark' or 'quasi_static', or {_INSTEAD}",
    ),
    Rule(
        "mesh.nodes_per_semi_axis", lambda s: patch_cost(s).bytes > _LIMIT,
        lambda s: f"would take {patch_cost(s).bytes / 2**30:.1f} GiB, above {_LIMIT / 2**30:.0f} GiB: use fewer points",
    ),
)  # fmt: skip

_TIMES = Times({"weightless": 10.0e-6, "inertial": 11.0e-6, "tangential": 22.0e-6}, sample=14.0e-6, search=2.5)
#: What the matrices between balls add to a step [s].
_BETWEEN_S = 40.0e-6
#: Steps of a run and its second one with half as many.
_WITH_HALF = 1.5


@attrs.frozen
class Condensed:
    """Elastic rings and balls, reduced to compliances at the contacts."""

    name: ClassVar[str] = "condensed"

    @classmethod
    def example_scene(cls) -> Tables:
        """A B7206C on sections so coarse that they take a moment."""
        return {
            "bearing": {"preset": "B7206C"},
            "mesh": {"kind": "structured", "element_size": 2.5e-3, "nodes_per_semi_axis": 1},
            "load": {"axial": 1000.0, "radial": [200.0, 0.0]},
            "kinematics": {"ball_inertia": False},
            "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 1e-4},
            "integrator": {"kind": "newmark", "turns": 2, "steps_per_turn": 90},
        }

    def faults(self, problem: Problem) -> list[Mistake]:
        """What condensed rings need: dimensions of bodies of revolution, the elements of the structured mesher, seats that hold."""
        faults = []
        if problem.mesh is not None and not is_swept(problem.mesh):
            why = "condensed bodies are bodies of revolution, swept from their sections: use mesh.kind = 'structured'"
            faults.append(Mistake("mesh.kind", problem.mesh.name, why))
        for key in ("bore", "outer_diameter", "width"):
            if attrs.asdict(problem.bearing, recurse=False)[key] is None:
                why = "is needed by elastic rings: give it, or use bodies.kind = 'rigid'"
                faults.append(Mistake(f"bearing.{key}", None, why))
        if not problem.bearing.equal_rows:
            why = "condensed bodies have one ring section for all rows: delete differing keys, or use bodies.kind = 'rigid'"
            faults.append(Mistake("bearing.row", None, why))
        grown = {f"mounting.{key}": value for key, value in problem.mounting.changes.items()}
        if problem.kinematics.ball_growth:
            grown["kinematics.ball_growth"] = 1.0
        for key, value in grown.items() if _nodal(problem) else ():
            why = "changes the surfaces of the points: use contact.discretisation = 'resultant', or kinematics.radial_expansion"
            faults.append(Mistake(key, value, why))
        unmeshed = unrefined(problem, "sections of condensed bodies")
        faults += unmeshed
        # Seats so soft that they hold nothing.
        b, load = problem.bearing, abs(problem.load.axial) + sum(abs(force) for force in problem.load.radial)
        load += 0.0 if problem.excitation is None else problem.excitation.amplitude_n
        for key, diameter in (("inner_seat", b.bore), ("outer_seat", b.outer_diameter)):
            seat = getattr(problem.supports, key)
            if isinstance(seat, str) or diameter is None or b.width is None:
                continue
            gives = load / (seat * pi * diameter * b.width)
            if gives > _GIVES * b.ball_diameter:
                why = f"deflects by {1e3 * gives:.3g} mm under {load:.4g} N, too much for balls in grooves: check its unit, N/m3 "
                faults.append(Mistake(f"supports.{key}", seat, f"{why}(500 N/mm3 is 5e11)"))
        if unmeshed or problem.contact.discretisation not in problem.contact.law.discretisations:
            return faults
        if _nodal(problem) and (patches := mistakes(_PATCHES, problem)):
            return faults + patches
        cost = section_cost(problem)
        if cost.bytes > _BYTES_LIMIT:
            why = (
                f"would take {cost.bytes / 2**30:.1f} GiB for some {cost.nodes} nodes of a ring's section, above "
                f"{_BYTES_LIMIT / 2**30:.0f} GiB: use larger elements, or fewer nodes_per_semi_axis"
            )
            faults.append(Mistake("mesh.element_size", getattr(problem.mesh, "element_size", None), why))
        return faults

    def traits(self, problem: Problem) -> Traits:
        """Compiled, but for surface points; Hertz's law is calibrated on those."""
        if _nodal(problem):
            return Traits(compiled=False, resultants=False)
        return Traits(calibrated=is_hertzian(problem.contact.law), renews=True, damps=True)

    def stable_step(self, problem: Problem) -> float:
        """Of the ring on its contacts [s]."""
        return 2.0 / problem.highest_frequency

    def decide(self, problem: Problem, parts: Decisions) -> None:
        """What of the bodies' compliance is needed."""
        why = "bodies.kind is condensed: finite elements of rings and balls, reduced to structural compliances"
        parts.keep("elastic rings and balls", why)
        if _nodal(problem):
            cost = patch_cost(problem)
            why = f"contact.discretisation is nodal: some {cost.points} points carry a contact, {cost.bytes / 2**20:.0f} MiB"
            parts.keep("pressures at surface points", why)
            moves = problem.recorded and problem.integrator.method.inertial and problem.kinematics.ball_inertia
            part, why = "inertia of the balls in their meridian planes", "two coordinates a ball, in steps of time"
            parts.decide(part, why, (not moves, "their slowest mode lies at some kHz: they are quasi-static"))
        else:
            why_not = (
                "rings on rigid seats, thin against the distance of the balls: less than 1e-3 of a contact's compliance"
            )
            parts.decide(BETWEEN_BALLS, "soft seats or thick rings", (not self.balls_meet(problem), why_not))
            if problem.excitation is not None:
                why = "rings and balls are quasi-static; `model.inertia` of the result states the error"
                parts.leave_out("inertia of the bodies' deformation", why)
        parts.leave_out("a compliance per ball and contact", "balls are equal and rings are bodies of revolution")
        why = "rings and balls are symmetric about each plane through their axis: a harmonic is one real system"
        parts.leave_out("other mirror half", why)
        parts.leave_out("stress recovery", "no stress inside the bodies is requested")

    def unused(self, tables: SceneTables) -> list[tuple[str, str]]:
        """Points stick by themselves."""
        why = "points stick by the compliance of rings and balls themselves"
        return [("contact.stick_stiffness", why)] if tables.contact.discretisation == "nodal" else []

    def cost(self, problem: Problem, balls: Balls, motion: PlannedMotion, parts: Decisions) -> Cost:
        """Sections or patches first, then the motion."""
        if not _nodal(problem):
            more = _BETWEEN_S * (problem.bearing.ball_count / 12.0) ** 2 if parts.keeps(BETWEEN_BALLS) else 0.0
            once = section_cost(problem).seconds
            return Cost(START_S + once + compiled_motion(problem, balls, motion, _TIMES, more), once)
        patches = patch_cost(problem)
        guess = MOTION if problem.excitation is not None and problem.integrator.method.inertial else 0.0
        seconds = patches.setup_s + 3.0 * patches.equilibrium_s + guess * patches.step_s
        steps = motion.turns * motion.steps_per_turn if motion.recorded else 0
        return Cost(START_S + seconds + _WITH_HALF * runs(problem, motion) * steps * patches.step_s)

    def same_bodies(self, problem: Problem, changed: Problem) -> bool:
        """Whether sections, contacts and materials, which compliances are computed from, are the same."""
        from raceway.bodies.basis import make_basis
        from raceway.plugins.bodies.condensed_bearing import sections

        if (problem.bearing, problem.supports, problem.mesh) == (changed.bearing, changed.supports, changed.mesh):
            return True  # all that sections are made of
        first, second = (sections(each, make_basis(each)) for each in (problem, changed))
        return first == second

    def balls_meet(self, problem: Problem) -> bool:
        """Whether one ball's load reaches the next one through a ring.

        On a rigid seat at depth t below the groove the field of a load falls off within t: 2e-4 of a contact's compliance is left
        at 3.7 t (B7206C).
        """
        b = problem.bearing
        if problem.supports.inner_seat != "rigid" or problem.supports.outer_seat != "rigid":
            return True
        walls = [0.5 * (b.pitch_diameter - b.ball_diameter - (b.bore or 0.0))]
        walls.append(0.5 * ((b.outer_diameter or 0.0) - b.pitch_diameter - b.ball_diameter))
        return bool(pi * (b.pitch_diameter - b.ball_diameter) / b.ball_count < 2.5 * max(walls))

    def build(self, problem: Problem, plan: ScenePlan) -> BuiltBearing:
        """See ``raceway.plugins.bodies.condensed_bearing`` and ``raceway.plugins.bodies.patch_bearing``."""
        if _nodal(problem):
            from raceway.plugins.bodies.patch_bearing import build as nodal

            return nodal(problem, plan, nodes_of(problem))
        from raceway.plugins.bodies.condensed_bearing import build

        return build(problem, plan)

    def columns(self, problem: Problem, plan: ScenePlan) -> ColumnBearing:
        """See ``raceway.bodies.columns``."""
        from raceway.bodies.columns import ball_columns
        from raceway.plugins.bodies.condensed_bearing import elastic_parts

        return ball_columns(problem, plan, elastic_parts)

    def why_no_columns(self, problem: Problem, key: str | None) -> str:
        """Surface points, compliances between balls; keys of shape and elasticity, which the finite elements are made of."""
        if key is not None:
            mere = key.endswith(("preload", "density", "expansion", "azimuth_deg"))
            return f"{key} changes the finite elements" if key.startswith("bearing.") and not mere else ""
        if _nodal(problem):
            return "contacts have surface points"
        return "balls interact through elastic rings" if self.balls_meet(problem) else ""


def _nodal(problem: Problem) -> bool:
    return problem.contact.discretisation == "nodal"
