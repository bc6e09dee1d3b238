"""What the plan leaves out is neither imported, allocated nor compiled, and the answer is the same with it."""

from __future__ import annotations

import json

import attrs
import pytest

from checks.validation import left_out
from checks.validation.command_line import ARTICLE, python
from raceway import load_scene, make_plan
from raceway.extend import run as compute
from raceway.planning.resolve import Derived, recorded_per_turn

#: A run in a process of its own: plan, modules, shapes of arrays, compiled kernels with their signatures.
RUN = """
import json, sys
from raceway import load_scene
from raceway.pipeline.run import run
result = run(load_scene(sys.argv[1], sys.argv[2:]))
from raceway.core.jit import Kernel, clock
modules = {name: module for name, module in sys.modules.items() if name.startswith("raceway.")}
kernels = {
    f"{kernel.__module__}:{kernel.__name__}": len(kernel.signatures)
    for module in modules.values() for value in vars(module).values()
    if isinstance(kernel := getattr(value, "kernel", value), Kernel)
}
from raceway.core.ring.system import surrogate
system, record = surrogate(result.model.system), None if result.simulation is None else result.simulation.whole
shapes = {name: list(getattr(system, name).shape) for name in ("table", "law_params", "law_state", "scalars")}
if record is not None:
    shapes |= {name: list(getattr(record, name).shape) for name in ("displacement", "gap", "ball")}
print(json.dumps({"plan": result.model.plan.to_dict(), "loaded": sorted(sys.modules), "kernels": kernels, "shapes": shapes, "made": clock["compiled"] + clock["loaded"]}))
"""


def run(*changes):
    done = python("-c", RUN, ARTICLE, *changes)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


SCENES = {
    "inertial balls, Newmark": (),
    "weightless balls, explicit": ("kinematics.spin_speed_rpm=0", "integrator.kind=central_difference"),
    "friction": ("contact.friction=0.1", "integrator.turns=2"),
    "friction under a growing force": ("contact.friction=0.1", "integrator.turns=3", "integrator.start=ramp"),
    "equilibria with friction": ("contact.friction=0.1", "integrator.kind=quasi_static", "integrator.turns=1"),
    "equilibria, penalty": ("contact.kind=penalty", "integrator.kind=quasi_static"),
    "steady orbit": ("integrator.kind=periodic",),
    "equilibrium only": ("identifier.kind=tangent",),
    "condensed bodies": ("bodies.kind=condensed", "kinematics.spin_speed_rpm=0", "integrator.turns=1"),
    "run-up": (
        'excitation={kind = "run_up", first_speed_rpm = 6e3, speed_rpm = 12e3, duration_s = 0.02, unbalance = 3.2e-4}',
        'identifier={kind = "order_tracking", window_turns = 2.0}',
    ),
}


_INERTIAL, _WEIGHTLESS = "contact_laws.hertz ring.kernels.rigid_inertial", "contact_laws.hertz ring.kernels.rigid_weightless"
_NEWMARK, _ROOTS = "periodic schemes.one_step.compiled", "ring.kernels.rigid_tangential ring.root"
#: Optional modules of the core that a scene imports, without "raceway.core."; of all that stand here it imports no other.
IMPORTED = {
    "inertial balls, Newmark": f"{_INERTIAL} {_NEWMARK}",
    "weightless balls, explicit": f"{_WEIGHTLESS} periodic schemes.explicit.compiled",
    "friction": f"{_INERTIAL} {_ROOTS} {_NEWMARK}",
    "friction under a growing force": f"{_INERTIAL} {_ROOTS} {_NEWMARK}",
    "equilibria with friction": f"{_INERTIAL} {_ROOTS} schemes.static.compiled",
    "equilibria, penalty": "contact_laws.penalty ring.kernels.rigid_inertial schemes.static.compiled",
    "steady orbit": f"{_INERTIAL} periodic",
    "equilibrium only": _INERTIAL,
    "condensed bodies": f"{_WEIGHTLESS} {_NEWMARK} condensed revolution hexahedron",
    "run-up": f"{_INERTIAL} {_NEWMARK} excitations.run_up",
    "elastic bodies": f"{_WEIGHTLESS} elastic condensed revolution hexahedron schemes.one_step.stepped",
}
OPTIONAL = {module for modules in IMPORTED.values() for module in modules.split()}


def check_modules(name, loaded):
    """Libraries of meshes and pictures take no part."""
    assert not set(loaded) & {"gmsh", "matplotlib", "meshio", "pyvista"}
    assert {module for module in OPTIONAL if f"raceway.core.{module}" in loaded} == set(IMPORTED[name].split())


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_a_run_imports_compiles_and_allocates_what_its_plan_says(name):
    changes = SCENES[name]
    scene = load_scene(ARTICLE, changes)
    plan = make_plan(scene)
    compute(scene)  # compiles what is not in the cache yet: a process of its own has a time limit
    found = run(*changes)
    expected = json.loads(json.dumps(plan.to_dict()))
    for one in (found["plan"], expected):
        one.pop("predicted_wall_s")  # each process times the machine
    assert found["plan"] == expected
    check_modules(name, found["loaded"])
    for module in IMPORTED[name].split():
        here = {
            kernel: made for kernel, made in found["kernels"].items() if kernel.partition(":")[0] == f"raceway.core.{module}"
        }
        # A kernel that another one calls is read from the cache with that one: rigid bodies within condensed ones, roots in a loop.
        within = scene.bodies.name == "condensed" or module in ("ring.root", "schemes.static.compiled")
        assert not here or any(here.values()) or within, here
    # One compiled version of a kernel serves every scene, and what no scene uses has none.
    assert set(found["kernels"].values()) <= {0, 1}
    # Kernels that are made around others: those of condensed bodies, and the loop around the solver of equilibria.
    around = found["made"] - sum(found["kernels"].values())
    assert 0 <= around <= 2 * (scene.bodies.name == "condensed") + (scene.integrator.kind == "quasi_static")
    _check_shapes(found["shapes"], scene, plan)
    names = {kernel.partition(":")[2] for kernel, made in found["kernels"].items() if made}
    if plan.balls != "tangential":
        assert not names & {"find_root", "rigid_tangential", "gyroscopic_moment"}
    assert ("square" in names) == (scene.contact.kind == "penalty")
    assert ("three_halves" in names) == (scene.contact.kind == "hertz")


#: Coarse rings and balls with a force a contact, for one turn of 8 steps.
ELASTIC = (
    "bodies.kind=elastic",
    'mesh={kind = "structured", element_size = 3.2e-3, nodes_per_semi_axis = 0, azimuth_cells = 24}',
    "kinematics.spin_speed_rpm=0", "integrator.turns=1", "integrator.steps_per_turn=8",
)  # fmt: skip


@pytest.mark.slow
def test_elastic_bodies_with_whole_contacts_need_of_condensed_ones_what_calibrates_them():
    scene = load_scene(ARTICLE, ELASTIC)
    compute(scene)  # as above
    found = run(*ELASTIC)
    assert found["plan"] == json.loads(json.dumps(make_plan(scene).to_dict()))
    check_modules("elastic bodies", found["loaded"])
    assert {"raceway.plugins.bodies.condensed_bearing", "raceway.core.fem.revolution"} <= set(found["loaded"])
    assert "raceway.plugins.bodies.condensed_bearing" not in found["loaded"]
    assert {"raceway.core.fem.elastic.resultant", "raceway.core.contact.hertz"} <= set(found["loaded"])
    assert set(found["kernels"].values()) <= {0, 1}


def _check_shapes(shapes, scene, plan):
    from raceway.core.ring.kernels.layout import COLUMNS
    from raceway.extend import SCALARS

    z = scene.bearing.ball_count
    # Positions, slips of what rubs, structural approaches of what deforms.
    columns = (
        2
        + 2 * (plan.balls == "tangential")
        + 2 * (scene.bodies.name == "condensed")
        + 2 * plan.keeps("interaction of balls through the rings")
    )
    # Compliances of bodies and between balls stand behind the scalars.
    assert shapes["table"] == [z, COLUMNS]
    assert (shapes["scalars"] == [SCALARS]) == (scene.bodies.name == "rigid")
    assert shapes["law_params"][0] == 2 * z and shapes["law_state"] == [2 * z, 0]
    if plan.time_step_s is None:
        assert "gap" not in shapes
        return
    rows = shapes["displacement"][0]
    assert shapes["gap"] == [rows, 2 * z] and shapes["ball"] == [rows, z, columns]
    per_turn = recorded_per_turn(plan.predicted_steps // plan.turns, plan.turns)
    assert rows == plan.turns * per_turn


def test_every_part_of_a_scene_is_decided_with_a_reason():
    parts = (
        "tilts", "centrifugal force", "friction", "gyroscopic moments of the balls", "gyroscopic moments of ring and rotor",
        "orbiting balls", "elastic rings and balls", ("time integration", "steady orbit"), "contact damping", "further rows", "pictures",
        "other mirror half", "a compliance per ball and contact", "stress recovery", "history of every step",
    )  # fmt: skip
    for changes in (
        (),
        ("supports.tilt=free", "contact.friction=0.1", "rotor.polar_inertia=1e-3", "identifier.kind=tangent"),
        ("bodies.kind=condensed",),
        ("bodies.kind=condensed", "contact.discretisation=nodal", "mesh.kind=structured"),
        (
            "bodies.kind=elastic",
            "contact.discretisation=nodal",
            "mesh.kind=structured",
            "mesh.element_size=3.2e-3",
            "mesh.nodes_per_semi_axis=1",
            "mesh.growth=3.0",
        ),
    ):
        plan = make_plan(load_scene(ARTICLE, changes))
        decided = [*plan.kept, *plan.left_out]
        assert all(part.why for part in decided)
        for words in parts:
            assert sum(part.part.startswith(words) for part in decided) == 1, words
    condensed = make_plan(load_scene(ARTICLE, ("bodies.kind=condensed",)))
    left_out = {part.part for part in condensed.left_out}
    assert {"other mirror half", "stress recovery", "a compliance per ball and contact"} <= left_out
    fine = make_plan(load_scene(ARTICLE, ("integrator.steps_per_turn=2880",)))
    assert "history of every step" in {part.part for part in fine.left_out}


def test_a_part_that_is_forced_in_is_kept_and_says_so():
    scene = load_scene(ARTICLE)
    plan, forced = make_plan(scene), make_plan(scene, ("friction",))
    assert plan.balls == "inertial" and forced.balls == "tangential"
    assert next(part.why for part in forced.kept if part.part == "friction") == "forced"
    assert "friction" in {part.part for part in plan.left_out}


@pytest.mark.parametrize(
    "rule", ["tangential", "ball_inertia", "orbiting", "turns", "integration", "pitch", "mirror", "stresses"]
)
def test_answers_are_equal_with_a_part_and_without(rule, monkeypatch):
    monkeypatch.setattr(left_out, "_REPEATS", 1)  # times are the benchmark's
    found = left_out.RULES[rule]()
    assert found.difference <= found.bound <= 1e-6


def test_a_saving_counts_above_the_noise_only():
    def rule(difference=0.0, cpu=0.010, forced=0.020, size=10, size_forced=10, spread=0.0):
        return left_out.Rule("r", "", difference, 1e-10, "", cpu, forced, size, size_forced, spread)

    assert rule().holds and rule().saves
    assert not rule(difference=1.0).holds and not rule(difference=1.0).saves
    # 0.8 % faster, or faster by less than times spread, or by microseconds: equal answers, and nothing saved.
    for noise in (rule(cpu=0.0379, forced=0.0382), rule(spread=0.011), rule(cpu=9e-6, forced=23e-6)):
        assert noise.holds and not noise.saves
    assert rule(cpu=0.020, size=2**20, size_forced=2**21).saves
    # Dearer than with the part: the rule is no good.
    assert not rule(cpu=0.030).holds


def test_a_rule_whose_answers_can_hardly_differ_holds_with_a_saving_only():
    rule = left_out.Rule("r", "", 0.0, 1e-10, "", 0.010, 0.020, 10, 10, must_save=True)
    assert rule.holds
    assert not attrs.evolve(rule, cpu_s=0.020).holds and not attrs.evolve(rule, difference=1.0).holds


def test_a_time_integration_that_is_not_left_out_is_noticed(monkeypatch):
    # By its memory: times of a busy machine may differ by anything.
    monkeypatch.setattr(left_out, "_REPEATS", 1)
    assert left_out.RULES["integration"]().smaller
    monkeypatch.setattr("raceway.planning.resolve.Problem.recorded", Derived(lambda problem: (True, "")))
    assert not left_out.RULES["integration"]().smaller


@pytest.mark.slow
def test_compliances_that_are_kept_are_made_anew_by_the_rule_that_measures_them(monkeypatch):
    from raceway.plugins.bodies import condensed_bearing as compliances

    made = []
    whole = compliances._elastic_bodies
    monkeypatch.setattr(compliances, "_elastic_bodies", lambda *words: made.append(1) or whole(*words))
    monkeypatch.setattr(left_out, "compared", lambda rule, scene, planned, forced, **more: (planned(), forced()))
    once, each = left_out.compliances()
    assert len(made) == 1 + len(each) and (once == each).all()
