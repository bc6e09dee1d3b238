"""The kind of bodies of which every node moves."""

from math import ceil, inf, pi
from typing import ClassVar

import attrs

from raceway.bodies.model import BuiltBearing
from raceway.core.contact.geometry import BallBearing
from raceway.core.contact.hertz import contact_modulus
from raceway.errors import Mistake
from raceway.framework.contracts import Cost, Traits, said
from raceway.framework.duties import is_constraint, is_hertzian, is_swept
from raceway.framework.options import one_of, option, positive
from raceway.framework.rules import Rule, mistakes
from raceway.planning.parts import START_S, Balls, Decisions, PlannedMotion
from raceway.planning.plan import ScenePlan
from raceway.planning.resolve import Problem
from raceway.plugins.bodies.condensed import section_cost
from raceway.plugins.bodies.mesh import least_step, mesh_faults, predicted_mesh, refined, unrefined
from raceway.storage.files import allowed_bytes
from raceway.storage.tables import Tables

#: Contact resultants: bytes of a program without bodies, and of a cell while factors or multigrid are kept (resident memory
#: measured at 4500 and 17 000 cells with factors, at 60 000 with multigrid).
_BYTES, _BYTES_A_CELL = 2.0e8, (7.5e4, 4.0e4)
#: Pressures at points, by superelements: bytes of a cell; cells of the largest part that is factored (a ball of the article's
#: coarser mesh), bytes at the peak while it is, bytes of a second set for time steps, processor time of its factors.  Measured with element
#: sizes of 1.6 mm and 2 nodes to the semi-axis, of 1.0 mm, and on the article's mesh: 1.1, 3.5 and 6.6 GB, 9, 50 and 124 s; 16 GB in motion.
_POINT_BYTES, _PART_CELLS, _PEAK_BYTES, _FACTOR_BYTES, _FACTOR_S = 3.0e3, 60_288, 5.3e9, 8.0e9, 85.0
#: Processor seconds a cell: all that is not factored, up to the equilibrium; a solution of all bodies with its contacts; a time step
#: from the parabola through the ones before, with friction (measured on the article's mesh: 3 and 5 s under either excitation).
_POINT_S, _ALL_S, _STEP_S = 7.0e-5, 1.2e-5, 4.5e-6
#: Share of the machine's memory that a run may take.
_SHARE = 0.8
#: Unknowns up to which the solver takes factors instead of multigrid (``raceway.core.fem.elastic.iterative_solver``).
_FACTORS = 60_000
#: Processor seconds a cell on one core of a small server: meshing and first forces; factors or multigrid; a linear solve with
#: the forces that follow it.  Measured with factors at 1900 and 12 000 cells (settling and stiffness: 4.7e-4 and 5.0e-4 s a cell),
#: with multigrid at 63 000.
_BUILD_S, _SETUP_S, _SOLVE_S = 2.0e-5, (2.0e-4, 1.5e-4), (4.0e-5, 2.2e-4)
#: Processor seconds a cell of an explicit step: in compiled loops, of hexahedra of one point and others stepped from Python, and of
#: the Python beside (``python -m checks.explicit_step`` has the first).
_LOOP_S, _FORCE_S, _PYTHON_S = 8.5e-8, (1.5e-7, 4.9e-6), 1.0e-3
#: Bytes that a device reads and writes in a step for an element with its node, twenty-four forces to and fro and eighteen vectors, gathered
#: reads counted half more; least seconds of a step, whose threads wait for each other six times.  Estimates: no device is measured yet.
_DEVICE_BYTES, _DEVICE_S = 1.0e3, 1.0e-4
#: Thinnest element of a ball over the width of its cells under the patch; first layer of its cells over the finest length
#: that is asked for.  Both from meshes of 1 cell to the semi-axis, whose steps are 8.5e-9 and 2.1e-8 s by elements.
_THINNEST, _DEPTH = 0.43, 0.6
#: The same of balls without refinement, over the cells of their surface: their layers are thinner.
_LAYER = 0.87
#: Linear solves of an equilibrium from rigid bodies with its stiffness; of one from its neighbour and of a time step, with
#: pressures at points and with whole contacts.
_EQUILIBRIUM, _NEIGHBOUR, _STEP = 10, (5, 2), (5, 1)
#: Imports of what solves [s].
_IMPORTS_S = 1.5


@attrs.frozen
class _ElasticCost:
    """Predictions."""

    cells: int  # hexahedra
    unknowns: int  # of all nodes
    bytes: int  # at the peak
    stable_step_s: float  # of explicit steps, by elements and contacts [s]
    equilibrium_s: float  # processor time to the equilibrium and its stiffness, meshing included [s]
    start_s: float  # of the equilibria that a motion starts with [s]
    step_s: float  # of a step [s]


def elastic_cost(problem: Problem) -> _ElasticCost | None:
    """Predicted cost of the bodies of a scene; None where the mesher does not know it before it meshes."""
    mesh = predicted_mesh(problem)
    if mesh is None:
        return None
    cells, method = int(mesh["cells"]), problem.integrator.method
    unknowns = int(3.4 * cells)  # nodes of coarse bodies are more than their cells
    if problem.contact.discretisation == "nodal":
        return _by_superelements(problem, mesh, cells, unknowns)
    large = int(unknowns > _FACTORS)
    setup, solve = cells * _SETUP_S[large], cells * _SOLVE_S[large]
    memory = int(_BYTES + _BYTES_A_CELL[large] * cells)
    first = _IMPORTS_S + cells * _BUILD_S + setup + _EQUILIBRIUM * solve
    resultants = int(problem.contact.discretisation == "resultant")
    neighbour = _NEIGHBOUR[resultants] * solve
    if not method.inertial:
        return _ElasticCost(cells, unknowns, memory, 0.0, first, neighbour, neighbour)
    step = (
        _STEP[resultants] * solve + 0.2 * (1 - resultants) * setup if method.implicit else _step_s(problem, cells, unknowns)
    )
    start = 4.0 * neighbour + setup if problem.integrator.start == "orbit" else 0.0
    return _ElasticCost(cells, unknowns, memory, _stable_step(problem), first, start, step)


def _not_compiled(problem: Problem) -> str:
    """What keeps explicit steps out of compiled loops, the only ones that a device has; empty where nothing does."""
    if problem.bodies.formulation != "one_point":
        dearer = f"whose eight points take the processor {_FORCE_S[1] / _FORCE_S[0]:.0f} times as long"
        return f"steps hexahedra of bodies.formulation = 'one_point', not '{problem.bodies.formulation}', {dearer}"
    if problem.contact.discretisation != "nodal":
        return "steps contacts of contact.discretisation = 'nodal': resultants are found by iterations"
    if not problem.supports.inner_seat == problem.supports.outer_seat == "rigid":
        return "steps bodies on rigid seats: set supports.inner_seat and supports.outer_seat 'rigid'"
    return ""


def device_of(problem: Problem, cells: int, unknowns: int) -> tuple[str, str]:
    """CUDA device that takes the steps of a motion, empty where the processor does, and why."""
    asked = said(problem.integrator.method, "device")
    if asked == "cpu" or not problem.recorded:
        return "", "integrator.device is 'cpu'"
    from raceway.core.fem.elastic.device import need_bytes, refusal, title
    from raceway.core.signatures import LAW
    from raceway.framework.loading.probe import plugin_kernel

    if reason := _not_compiled(problem):
        return "", reason
    law = plugin_kernel(problem.contact.law, "contact law", LAW, "LAW")
    if reason := refusal(cells, unknowns // 3, law):
        return "", reason
    return title(), f"integrator.device is '{asked}', {need_bytes(cells, unknowns // 3) / 2**30:.2g} GiB of its memory"


def _step_s(problem: Problem, cells: int, unknowns: int) -> float:
    """Time of an explicit step [s]: of the processor, or of a device by how fast its memory is."""
    if device_of(problem, cells, unknowns)[0]:
        from raceway.core.fem.elastic.device import bandwidth

        return max(cells * _DEVICE_BYTES / bandwidth(), _DEVICE_S)
    if _not_compiled(problem):
        return cells * _FORCE_S[problem.bodies.formulation != "one_point"] + _PYTHON_S
    return cells * _LOOP_S


def _by_superelements(problem: Problem, mesh: Tables, cells: int, unknowns: int) -> _ElasticCost:
    """With pressures at points: equal balls and sectors are factored once, for statics and for the steps of a motion."""
    method, count = problem.integrator.method, problem.bearing.ball_count
    parts = {str(body["name"]): int(body["cells"]) for body in mesh["bodies"]}
    if _equal_sectors(problem):
        parts |= {name: parts[name] // count for name in ("inner_ring", "outer_ring") if name in parts}
    sizes = {k: n / _PART_CELLS for k, n in parts.items() if not k.startswith("ball") or k.endswith(("_00", "_0"))}
    largest = max(sizes.values(), default=0.0)
    factor = _FACTOR_S * sum(n**2 for n in sizes.values())
    memory = _BYTES + _POINT_BYTES * cells + _PEAK_BYTES * largest ** (4.0 / 3.0)
    first, solve = _IMPORTS_S + factor + _POINT_S * cells, _ALL_S * cells
    if not method.inertial or problem.excitation is None:
        return _ElasticCost(cells, unknowns, int(memory), 0.0, first, solve, solve)
    start = 4.0 * solve if problem.integrator.start == "orbit" else 0.0
    step = 0.0 if method.implicit else _step_s(problem, cells, unknowns)
    if method.implicit:
        memory += _FACTOR_BYTES * sum(n ** (4.0 / 3.0) for n in sizes.values())
        start, step = start + factor, _STEP_S * cells
    return _ElasticCost(cells, unknowns, int(memory), _stable_step(problem), first, start, step)


def _equal_sectors(problem: Problem) -> bool:
    """Whether the mesh of a ring is known to be as many equal sectors as there are balls, before it is made."""
    return is_swept(problem.mesh) and problem.bearing.ball_count >= 3


def _stable_step(problem: Problem) -> float:
    """Of elements, with the mass that is added to them, and contacts, whose 1/dt^2 add up [s]."""
    elements, contacts = _single_steps(problem)
    return float((max(elements, least_step(problem)) ** -2 + contacts**-2) ** -0.5)


def _single_steps(problem: Problem) -> tuple[float, float]:
    """Stable steps of the ball's thinnest element and of the contacts [s].

    Elements: h sqrt(rho / M), M = E (1 - nu) / ((1 + nu) (1 - 2 nu)), at h = 0.43 of the width of the cells under the
    patch, for the ball's core, half as wide, is thinner than its surface.  Contacts: a surface point of stiffness k_n A on
    nodes of mass rho A h / 2, both sides, by Gershgorin's theorem: 4 / dt^2 = 4.8 k_n / (rho h).
    """
    b, mesh, law = problem.bearing, problem.mesh, problem.contact.law
    modulus = contact_modulus(b.rings.young, b.rings.poisson, b.balls.young, b.balls.poisson)
    carried = problem.axial_approach[1] or 300.0
    load = getattr(mesh, "ball_load", None) or carried
    ellipses = BallBearing.of(b).ellipses(modulus)
    minors = [float(e.semi_axes(load)[1]) for e in ellipses]
    size = float(getattr(mesh, "element_size", inf))
    fine = min(minors) / float(getattr(mesh, "nodes_per_semi_axis", 4)) if refined(problem) else size
    zone = float(getattr(mesh, "patch", 1.25)) * max(minors)
    arc = 0.125 * pi * b.ball_diameter  # from a ball's pole to the edge of its cube
    width = min(zone / ceil(zone / fine), size) if refined(problem) else _LAYER * arc / ceil(arc / size)
    steel, nu = b.balls, b.balls.poisson
    wave = (steel.young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)) / steel.density) ** 0.5
    penalty = getattr(law, "stiffness", None)
    if penalty is None:
        at = getattr(law, "calibrate_at", None) or carried
        # As raceway.contact_laws.penalty.point_stiffness: the penetration is 1 % of Hertz's approach.
        penalty = max(
            300.0 * float(e.curvatures[0] * e.curvatures[1]) ** 0.5 * at / (pi * float(e.approach(at)) ** 2)
            for e in ellipses
        )
    if problem.contact.discretisation == "resultant":  # on discs of many cells: far softer than elements
        return _THINNEST * width / wave, inf
    return _THINNEST * width / wave, 2.0 * (steel.density * _DEPTH * fine / (4.8 * penalty)) ** 0.5


_OTHER = "or use bodies.kind = 'condensed'"
_ONE_ROW = f"elastic bodies are one row of balls: use 'single', {_OTHER}"
_SHAPES = f"fits and temperatures change the shape of elastic bodies: give kinematics.radial_expansion instead, {_OTHER}"
#: What elastic bodies cannot do, each with the way out.
_RULES: tuple[Rule[Problem], ...] = (
    Rule(
        "mesh", lambda s: s.mesh is None,
        f"is required by elastic bodies: for instance [mesh] with kind = 'structured', {_OTHER}",
    ),
    Rule(
        "contact.friction", lambda s: s.contact.discretisation == "resultant" and s.contact.friction > 0.0,
        f"the tangential compliance of a coarse mesh is too uncertain: set it 0, use 'nodal', {_OTHER}",
    ),
    Rule(
        "contact.kind", lambda s: is_constraint(s.contact.law),
        f"is a constraint, not a pressure over penetration: use 'hertz' or 'penalty', {_OTHER}",
    ),
    Rule(
        "kinematics.orbiting", lambda s: s.kinematics.orbiting,
        f"balls of elastic bodies stay at their azimuth: set it false, {_OTHER}",
    ),
    Rule(
        "kinematics.gyroscopic", lambda s: s.kinematics.gyroscopic != "none",
        f"balls of elastic bodies do not rotate: set it 'none', {_OTHER}",
    ),
    Rule("bearing.arrangement", lambda s: len(s.bearing.rows) > 1 and not s.bearing.row, _ONE_ROW),
    Rule(
        "kinematics.ball_growth", lambda s: s.kinematics.ball_growth,
        f"balls of elastic bodies do not rotate: set it false, {_OTHER}",
    ),
    Rule(
        "bearing.tilt_arm", lambda s: s.bearing.tilt_arm != "groove",
        f"the arm follows from the shape of elastic rings, which is that of 'groove': use it, {_OTHER}",
    ),
)  # fmt: skip


def words(cost: _ElasticCost) -> str:
    """Size of the bodies in a sentence."""
    return f"{cost.cells} hexahedra, {cost.unknowns / 1e3:.0f} thousand unknowns, about {cost.bytes / 2**30:.2g} GiB"


@attrs.frozen
class Elastic:
    """Finite elements of rings and balls with inertia on any mesh."""

    name: ClassVar[str] = "elastic"

    formulation: str = option(
        "incompatible",
        help="hexahedra: 'one_point' with hourglass control, 'full' (2 x 2 x 2), with 'incompatible' modes",
        rule=one_of("one_point", "full", "incompatible"),
    )
    hourglass: float = option(
        0.05,
        help="stiffness of the hourglass modes of 'one_point', over lambda + 2 mu; impacts: 0.005 and elements of at most 0.6 of the contact's radius",
        rule=positive(),
    )

    @classmethod
    def example_scene(cls) -> Tables:
        """Three balls on some hundred elements each, with a force that is small against the loads: seconds."""
        return {
            "bearing": {"preset": "B7206C", "ball_count": 3},
            "mesh": {"kind": "structured", "element_size": 3.2e-3, "azimuth_cells": 12, "nodes_per_semi_axis": 0},
            "load": {"axial": 240.0, "radial": [20.0, 0.0]},
            "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3e-5},
            "integrator": {"kind": "newmark", "turns": 1, "steps_per_turn": 32, "tolerance": 1e-5},
        }

    def unused_options(self) -> dict[str, str]:
        """Options that change nothing, with the reason."""
        why = f"bodies.formulation is '{self.formulation}': only 'one_point' has hourglass modes"
        return {"hourglass": why} if self.formulation != "one_point" and self.hourglass != 0.05 else {}

    def faults(self, problem: Problem) -> list[Mistake]:
        """What bodies with every node cannot do; meshes without cells, or too large."""
        faults = mistakes(_RULES, problem)
        if problem.bearing.row and len(problem.bearing.rows) > 1:
            faults.append(Mistake("bearing.row", problem.bearing.signs, _ONE_ROW))
        faults += [Mistake(f"mounting.{key}", value, _SHAPES) for key, value in problem.mounting.changes.items()]
        points = [] if problem.contact.discretisation == "resultant" else unrefined(problem, "pressures at surface points")
        unmeshed = points or mesh_faults(problem)
        if faults or unmeshed:
            return faults + unmeshed
        wanted, contacts = least_step(problem), _single_steps(problem)[1] if least_step(problem) else inf
        if wanted >= contacts:
            why = (
                f"is above the stable step of the contacts, about {contacts:.2g} s, which limit the step whatever mass elements have: use "
                "less, or a softer contact.stiffness"
            )
            return [Mistake("integrator.least_step", wanted, why)]
        cost, most = elastic_cost(problem), _SHARE * allowed_bytes()
        if cost is not None and problem.recorded and said(problem.integrator.method, "device") == "gpu":
            device, why = device_of(problem, cost.cells, cost.unknowns)
            if not device:
                return [Mistake("integrator.device", "gpu", f"{why}, or use 'cpu' or 'auto'")]
        if cost is None or cost.bytes <= most:
            return []
        why = (
            f"gives {cost.cells} elements, whose matrices would take about {cost.bytes / 2**30:.1f} GiB, above "
            f"{most / 2**30:.1f} GiB ({100 * _SHARE:.0f} % of the memory that this process may take): use larger elements or "
            "fewer nodes_per_semi_axis, or bodies.kind = 'condensed'"
        )
        return [Mistake("mesh.kind", problem.mesh.name, why)]

    def traits(self, problem: Problem) -> Traits:
        """Stepped from Python; a run is too dear to be made twice."""
        resultants = problem.contact.discretisation == "resultant"
        calibrated = resultants and is_hertzian(problem.contact.law)
        return Traits(compiled=False, resultants=resultants, calibrated=calibrated, every_node=True)

    def stable_step(self, problem: Problem) -> float | None:
        """Of elements and contacts [s]; None where the mesher cannot predict it."""
        cost = elastic_cost(problem)
        return None if cost is None or cost.stable_step_s == 0.0 else cost.stable_step_s

    def decide(self, problem: Problem, parts: Decisions) -> None:
        """What of the bodies is not left out: all of them."""
        cost = elastic_cost(problem)
        size = "" if cost is None else f": {words(cost)}"
        parts.keep(
            "elastic rings and balls", f"bodies.kind is elastic: finite elements of rings and balls, every node{size}"
        )
        nodal = problem.contact.discretisation == "nodal"
        why = "elastic bodies touch at points of the ball surfaces"
        why_not = (
            "contact.discretisation is resultant: one force per contact, whose law replaces the compliance of the mesh below"
        )
        parts.decide("pressures at surface points", why, (not nodal, why_not))
        parts.keep("ideal cage", "holds each ball at its azimuth without rotation")
        why_not = "balls do not orbit: the cage holds them; their centrifugal force is a separate part"
        parts.leave_out("travel of the balls", why_not)
        parts.keep("a compliance per ball and contact", "every node of every ball and ring is an unknown")
        why = "both halves are meshed: the forces may have any direction, and half models are not supported"
        parts.keep("other mirror half", why)
        count = problem.bearing.ball_count
        why = f"the {count} balls are equal, each ring has {count} equal sectors: one of each is factored"
        if nodal and _equal_sectors(problem):
            parts.leave_out("factors of equal balls and sectors", why)
        elif nodal:
            why = f"mesh.kind is {problem.mesh.name}: " if problem.mesh is not None else ""
            why += "each ring is factored completely unless its sectors are equal, and each ball that differs"
            parts.keep("factors of equal balls and sectors", why)
        if cost is not None and said(problem.integrator.method, "device") != "cpu" and problem.recorded:
            device, why = device_of(problem, cost.cells, cost.unknowns)
            parts.decide("steps on a CUDA device", f"{why}: {device}", (not device, f"a device {why}"))
        why = "along the normals of the most loaded contacts, once, at rest; `raceway view` recovers the stresses of all elements"
        why_not = "contact resultants on coarse meshes have no stresses of contacts below them"
        parts.decide("stress recovery", why, (not nodal, why_not))

    def cost(self, problem: Problem, balls: Balls, motion: PlannedMotion, parts: Decisions) -> Cost:
        """Meshing, factors and solves; contact resultants are calibrated as the bearing's own condensed rings."""
        cost = elastic_cost(problem)
        if cost is None:
            return Cost(START_S, scales=False, at_least=True)
        seconds = START_S + cost.equilibrium_s
        if problem.contact.discretisation == "resultant":
            seconds += section_cost(attrs.evolve(problem, mesh=None)).seconds
        if motion.recorded:
            seconds += cost.start_s + motion.turns * motion.steps_per_turn * cost.step_s
        return Cost(seconds, unknowns=cost.unknowns, mesh=predicted_mesh(problem), scales=False, bytes=cost.bytes)

    def build(self, problem: Problem, plan: ScenePlan) -> BuiltBearing:
        """See ``raceway.plugins.bodies.elastic_bearing``."""
        from raceway.plugins.bodies.elastic_bearing import build

        return build(problem, plan)
