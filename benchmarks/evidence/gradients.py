"""Derivatives by the keys of a scene: against central differences of whole runs, and what they cost."""

from __future__ import annotations

from typing import Any
from unittest import mock

import numpy as np

from benchmarks.evidence import Row, below
from raceway.bodies.model import Model, build_model
from raceway.core.jit import working_processor_time
from raceway.core.ring.system import System
from raceway.errors import ConvergenceError, SceneError
from raceway.pipeline.gradient.differences import WEIGHTS, derivative
from raceway.pipeline.gradient.motion import SteadyOrbit
from raceway.pipeline.gradient.statics import static_gradient
from raceway.pipeline.gradient.variation import NoDerivative
from raceway.pipeline.run import run
from raceway.pipeline.settle import settle
from raceway.planning.plan import make_plan
from raceway.scene.catalogue import single_presets
from raceway.scene.continuous import continuous_keys, with_number
from raceway.scene.file import load_scene
from raceway.scene.reading import scene_from_dict
from raceway.studies.sensitivities.front import sensitivities
from raceway.studies.sensitivities.sensitivities import sensitivities_of

TITLE = "Derivatives by the keys of a scene"
COMMAND = "python -m benchmarks.evidence gradients"
_QUANTITIES = ("displacement", "stiffness", "contact_force")
#: Steps of the runs' differences over those of the gradients, so that both do not share their error; of orbits over the number.
_OTHER_STEP, _ORBIT_STEP = 1.5, 1e-4
_RIGID, _CONDENSED, _ORBITS = 150, 50, 12
#: Keys of orbits, each of which takes four searches.
_OF_ORBITS = (
    "load.axial",
    "bearing.contact_angle_deg",
    "rotor.mass",
    "contact.damping",
    "excitation.speed_rpm",
    "excitation.force",
)

Tables = dict[str, Any]


def rows() -> list[Row]:
    rng = np.random.default_rng(23)
    return [*_static("rigid", _RIGID, rng), *_static("condensed", _CONDENSED, rng), *_orbits(rng), *_cost()]


def _scene(rng: np.random.Generator, bodies: str) -> Tables:
    axial = float(10.0 ** rng.uniform(1.7, 3.3))
    names = sorted(single_presets())
    tables: Tables = {
        "bearing": {"preset": "B7206C" if bodies == "condensed" else str(rng.choice(names))},
        "bodies": {"kind": bodies},
        "load": {"axial": axial, "radial": (axial * rng.uniform(-0.3, 0.3, 2)).tolist()},
        "supports": {"tilt": ["locked", "free", float(10.0 ** rng.uniform(3.0, 6.0))][rng.integers(3)]},
        "mounting": {"inner_temperature": float(rng.uniform(1.0, 15.0))},
    }
    if rng.random() < 0.5:
        tables["kinematics"] = {"spin_speed_rpm": float(rng.uniform(500.0, 12000.0))}
        if bodies == "rigid" and rng.random() < 0.3:
            tables["kinematics"]["gyroscopic"] = "outer_race"
    if rng.random() < 0.3:
        tables["bearing"] |= {"arrangement": str(rng.choice(["DB", "DF"])), "preload": axial, "row_distance": 0.016}
        tables["load"]["axial"] = 0.3 * axial
    return tables


def _model(tables: Tables) -> Model:
    scene = scene_from_dict(tables)
    return build_model(scene, make_plan(scene))


def _static(bodies: str, wanted: int, rng: np.random.Generator) -> list[Row]:
    worst, rough, counted, scenes, tried = 0.0, 0, 0, 0, 0
    while scenes < wanted:
        tried += 1
        try:
            model = _model(_scene(rng, bodies))
            still = settle(model)
        except (ConvergenceError, SceneError):
            continue
        found = [one for one in (_against_runs(model, still, key) for key in continuous_keys(model.scene)) if one]
        scenes += 1
        for what in _QUANTITIES:
            smooth = [one[what] for one in found if not one["remark"]]
            largest = max(size for _, size in smooth)
            worst = max(worst, max(off for off, _ in smooth) / largest)
        rough += sum(1 for one in found if one["remark"])
        counted += len(found)
    note = (
        f"{counted} derivatives by keys that change something, of {wanted} scenes ({tried} drawn, the others carry no equilibrium), seed 23; "
        f"{rough} of them told to lie at the edge of a contact and left out; steps of the runs 1.5 times those of the gradients"
    )
    name = f"displacement, stiffness and contact forces of {wanted} random scenes, {bodies} bodies, against differences of whole runs"
    return [below(f"{name}, relative to the largest", worst, 1e-6, COMMAND, note)]


def _against_runs(model: Model, still: Any, key: Any) -> Tables | None:
    """Of one key: quantity -> (largest difference, largest derivative), both times the number at the key."""
    if key.value == 0.0:
        return None
    try:
        found = static_gradient(model, still, key)
    except NoDerivative:
        return None
    if found.step == 0.0:
        return None
    step = _OTHER_STEP * found.step
    runs = {k: settle(build_model(with_number(model.scene, key.path, key.value + k * step), model.plan)) for k in WEIGHTS}
    result: Tables = {"remark": found.remark}
    for what in _QUANTITIES:
        other = derivative({k: getattr(one, what) for k, one in runs.items()}, step)
        scale = _scale(what, model)
        off, size = (np.abs(one * key.value / scale).max() for one in (getattr(found, what) - other, other))
        result[what] = float(off), float(size)
    return result


def _scale(what: str, model: Model) -> np.ndarray | float:
    """By which entries are divided: lengths and tilts, forces and moments made alike by the arm of the tilts."""
    if what == "contact_force":
        return 1.0
    arm = np.array([1.0, 1.0, 1.0, 1.0 / model.system.arm, 1.0 / model.system.arm])
    return arm if what == "displacement" else 1.0 / np.outer(arm, arm)


def _orbits(rng: np.random.Generator) -> list[Row]:
    worst, counted, scenes = 0.0, 0, 0
    while scenes < _ORBITS:
        tables = _scene(rng, "rigid")
        tables["rotor"] = {"mass": 2.0, "transverse_inertia": 1e-3}
        tables["contact"] = {"damping": float(rng.choice([1e-3, 50.0]))}
        speed = float(rng.uniform(3000.0, 12000.0))
        kind = str(rng.choice(["unidirectional", "bidirectional"]))
        force = {"amplitude": "constant", "force": 0.1 * tables["load"]["axial"]}
        tables |= {
            "excitation": {"kind": kind, "speed_rpm": speed, **force},
            "integrator": {"kind": "periodic", "tolerance": 1e-10},
        }
        tables.pop("kinematics", None)
        try:
            model = _model(tables)
            still = settle(model)
            orbit = SteadyOrbit.of(model, still)
            each = [
                _orbit_against_runs(model, still, orbit, key)
                for key in continuous_keys(model.scene)
                if key.path in _OF_ORBITS and key.value
            ]
        except (ConvergenceError, SceneError):
            continue
        found = [one for one in each if one is not None]
        worst = max(worst, max(off for off, _ in found) / max(size for _, size in found))
        counted, scenes = counted + len(found), scenes + 1
    note = f"{counted} derivatives, dashpots of 0.001 and 50 N s/m; orbits solved to 1e-10 of their amplitude"
    name = f"Z of the steady orbit of {_ORBITS} random scenes against differences of whole searches, relative to the largest"
    return [below(name, worst, 1e-6, COMMAND, note)]


def _orbit_against_runs(model: Model, still: Any, orbit: SteadyOrbit, key: Any) -> tuple[float, float] | None:
    try:
        found = orbit.gradient(static_gradient(model, still, key))
    except NoDerivative:
        return None
    step = _ORBIT_STEP * abs(key.value)
    lines = {}
    for k in WEIGHTS:
        one = build_model(with_number(model.scene, key.path, key.value + k * step), model.plan)
        moved = SteadyOrbit.of(one, settle(one))
        real, damping, _, _ = moved.line
        lines[k] = np.array([real, damping * moved.solved.problem.speed])
    runs = derivative(lines, step)
    other = complex(*runs)
    return abs(found.dynamic_stiffness - other) * abs(key.value), abs(other) * abs(key.value)


def _cost() -> list[Row]:
    result = []
    static: Tables = {"excitation": None}
    for name, scene in (
        ("static, rigid bodies", load_scene("examples/b7206.toml").with_(**static)),
        ("static, condensed bodies", load_scene("examples/b7206_condensed.toml").with_(**static)),
        ("steady orbit, one turn, unidirectional", _orbit_scene("unidirectional")),
        ("steady orbit, one pitch, bidirectional", _orbit_scene("bidirectional")),
    ):
        sensitivities(scene)  # kernels and meshes
        whole = min(_seconds(lambda scene=scene: run(scene)) for _ in range(3))
        found = min((sensitivities(scene) for _ in range(3)), key=lambda one: one.gradients_s)
        taken = found.gradients_s
        ratio = taken / whole
        note = f"{len(found.rows)} keys, {found.models} models built, {1e3 * taken:.0f} ms of processor time; run {1e3 * whole:.1f} ms, each the least of three. Building two models a key and evaluating contacts from Python is what it costs"
        if name.startswith("static"):
            label = f"further equilibria for all derivatives, {name}"
            result.append(below(label, _further_equilibria(scene), 1.0, COMMAND, note))
        limit = 2.0
        result.append(below(f"all derivatives over the run, processor time, {name}", ratio, limit, COMMAND, note))
    return result


def _orbit_scene(kind: str) -> Any:
    scene = load_scene("examples/b7206.toml")
    return scene.with_(excitation={"kind": kind}, integrator={"kind": "periodic"})


def _further_equilibria(scene: Any) -> int:
    """Solutions for an equilibrium that derivatives by all keys begin."""
    model = build_model(scene, make_plan(scene))
    still, begun, plain = settle(model), 0, System.settle

    def counted(self: System, *given: Any, **options: Any) -> Any:
        nonlocal begun
        begun += 1
        return plain(self, *given, **options)

    with mock.patch.object(System, "settle", counted):
        sensitivities_of(model, still, continuous_keys(scene))
    return begun


def _seconds(work: Any) -> float:
    begun = working_processor_time()
    work()
    return working_processor_time() - begun
