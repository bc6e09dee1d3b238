"""What the plan leaves out is neither imported nor compiled, and the answer is the same with it."""

import json

import numpy as np
import pytest

from checks.validation.command_line import ARTICLE, python
from raceway import build_model, load_scene, make_plan
from raceway.extend import CAGE
from raceway.extend import run as compute
from raceway.testing import simulate, solve_equilibrium

#: A run in a process of its own: modules, and signatures of each compiled kernel.
RUN = """
import json, sys
from raceway import load_scene
from raceway.extend import run
run(load_scene(sys.argv[1], sys.argv[2:]))
from raceway.core.jit import Kernel
kernels = {
    f"{kernel.__module__}:{kernel.__name__}": len(kernel.signatures)
    for name, module in list(sys.modules.items()) if name.startswith("raceway.") for value in vars(module).values()
    if isinstance(kernel := getattr(value, "kernel", value), Kernel)
}
print(json.dumps([sorted(sys.modules), kernels]))
"""
#: Optional modules that a scene imports, without "raceway.core."; of all that stand here it imports no other.
IMPORTED = {
    (): "ring.kernels.rigid_inertial periodic",
    ("kinematics.spin_speed_rpm=0", "integrator.kind=central_difference"): "ring.kernels.rigid_inertial periodic time.compiled",
    ("contact.friction=0.1", "integrator.turns=2"): "ring.kernels.rigid_inertial periodic time.compiled",
    ("identifier.kind=tangent",): "ring.kernels.rigid_inertial",
    ("bodies.kind=condensed", "kinematics.spin_speed_rpm=0", "integrator.turns=1"): (
        "ring.kernels.rigid_inertial ring.kernels.structural fem.hexahedron fem.revolution periodic time.compiled"
    ),
}  # fmt: skip
OPTIONAL = {"fem.elastic", *(module for modules in IMPORTED.values() for module in modules.split())}


@pytest.mark.slow
@pytest.mark.parametrize("changes", IMPORTED, ids=" ".join)
def test_a_run_imports_and_compiles_what_its_plan_says(changes):
    compute(load_scene(ARTICLE, changes))  # compiles what is not in the cache yet: a process of its own has a time limit
    done = python("-c", RUN, ARTICLE, *changes)
    assert done.returncode == 0, done.stderr
    modules, kernels = json.loads(done.stdout)
    assert {module for module in OPTIONAL if f"raceway.core.{module}" in modules} == set(IMPORTED[changes].split())
    # One compiled version of a kernel serves every scene, and what no scene uses has none.
    assert set(kernels.values()) <= {0, 1}
    names = {kernel.partition(":")[2] for kernel, made in kernels.items() if made}
    assert "three_halves" in names and "square" not in names, "the penalty law's"


NODAL = ("contact.discretisation=nodal", "mesh.kind=structured")
ELASTIC = ("bodies.kind=elastic", *NODAL, "mesh.element_size=3.2e-3", "mesh.nodes_per_semi_axis=1", "mesh.growth=3.0")


def test_every_part_of_a_scene_is_decided_with_a_reason():
    parts = (
        "tilts", "centrifugal force", "friction", "gyroscopic moments of the balls", "gyroscopic moments of ring and rotor",
        "orbiting balls", "elastic rings and balls", ("time integration", "steady orbit"), "contact damping", "further rows", "pictures",
        "other mirror half", "a compliance per ball and contact", "stress recovery", "history of every step",
    )  # fmt: skip
    free = ("supports.tilt=free", "contact.friction=0.1", "rotor.polar_inertia=1e-3", "identifier.kind=tangent")
    for changes in ((), free, ("bodies.kind=condensed",), ("bodies.kind=condensed", *NODAL), ELASTIC):
        plan = make_plan(load_scene(ARTICLE, changes))
        decided = [*plan.kept, *plan.left_out]
        assert all(part.why for part in decided)
        for words in parts:
            assert sum(part.part.startswith(words) for part in decided) == 1, words
    left_out = {part.part for part in make_plan(load_scene(ARTICLE, ("bodies.kind=condensed",))).left_out}
    assert {"other mirror half", "stress recovery", "a compliance per ball and contact"} <= left_out
    fine = make_plan(load_scene(ARTICLE, ("integrator.steps_per_turn=2880",)))
    assert "history of every step" in {part.part for part in fine.left_out}


def test_a_part_that_is_forced_in_is_kept_and_says_so():
    scene = load_scene(ARTICLE)
    plan, forced = make_plan(scene), make_plan(scene, ("friction",))
    assert plan.balls == "inertial" and forced.balls == "tangential"
    assert next(part.why for part in forced.kept if part.part == "friction") == "forced"
    assert "friction" in {part.part for part in plan.left_out}


def answer(changes, force=(), cage=None):
    """Dynamic stiffness [N/m] of the example with changes, some parts forced in; and whether a motion was integrated."""
    scene = load_scene(ARTICLE, changes)
    plan = make_plan(scene, force)
    model = build_model(scene, plan)
    if cage is not None:
        model.system.scalars[CAGE] = cage
    equilibrium = solve_equilibrium(model)
    records = [simulate(model, equilibrium).record] if plan.turns > 0 else []
    return scene.identifier.method.identify(records, equilibrium, model).dynamic_stiffness, bool(records)


ORBIT = ("integrator.kind=periodic", "load.axial=400", "excitation.amplitude=constant", "excitation.force=1500")


@pytest.mark.parametrize(
    ("changes", "forced", "bound"),
    [
        ((), {"force": ("friction",)}, 1e-10),
        (("kinematics.spin_speed_rpm=0",), {"force": ("centrifugal force of the balls",)}, 1e-10),
        ((), {"cage": 1e-290}, 1e-10),  # azimuths are computed anew each step, and stay
        pytest.param(("integrator.kind=quasi_static",), {"force": ("other turns",)}, 1e-10, marks=pytest.mark.slow),
        # Both orbits are known to 1e-7.
        pytest.param(ORBIT, {"changes": (*ORBIT, "integrator.symmetry=none")}, 1e-6, marks=pytest.mark.slow),
        # 1e9 N m/rad lets the ring tilt by a thousandth of what its contacts would.
        ((), {"changes": ("supports.tilt=1e9",)}, 1e-4),
    ],
    ids=["friction", "centrifugal force", "orbiting", "other turns", "pitch", "tilts"],
)
def test_answers_are_equal_with_a_part_and_without(changes, forced, bound):
    wanted = answer(**{"changes": changes, **forced})[0]
    assert np.abs(answer(changes)[0] - wanted) <= bound * np.abs(wanted)


def test_an_identifier_of_the_equilibrium_gets_no_record_and_answers_alike_with_one():
    changes = ("integrator.kind=newmark", "identifier.kind=tangent")
    (planned, integrated), (forced, record) = answer(changes), answer(changes, ("time integration (newmark)",))
    assert planned == forced and (integrated, record) == (False, True)
