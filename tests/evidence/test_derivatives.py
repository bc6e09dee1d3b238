"""Derivatives by scene keys and tolerance bands."""

import numpy as np
import pytest

from checks.validation.command_line import PRESETS
from raceway import ConvergenceError, SceneError, band, build_model, load_scene, scene_from_dict, sensitivities
from raceway.core.jit import working_processor_time
from raceway.extend import continuous_keys, run, solve_equilibrium, with_number
from raceway.pipeline.gradient import Gradients, NoDerivative, SteadyOrbit
from tests.test_gradients import derivative

pytestmark = pytest.mark.night

#: Keys of orbits, each of which takes four searches.
OF_ORBITS = {
    "load.axial", "bearing.contact_angle_deg", "rotor.mass", "contact.damping", "excitation.speed_rpm", "excitation.force"
}  # fmt: skip
LIMIT = {"at_most": 1e-6, "basis": "own other method"}


def drawn(rng, bodies):
    axial = float(10.0 ** rng.uniform(1.7, 3.3))
    names = sorted(file.stem for file in PRESETS.glob("*.toml"))
    tables = {
        "bearing": {"preset": "B7206C" if bodies == "condensed" else str(rng.choice(names))}, "bodies": {"kind": bodies},
        "load": {"axial": axial, "radial": (axial * rng.uniform(-0.3, 0.3, 2)).tolist()},
        "supports": {"tilt": ["locked", "free", float(10.0 ** rng.uniform(3.0, 6.0))][rng.integers(3)]},
        "mounting": {"inner_temperature": float(rng.uniform(1.0, 15.0))},
    }  # fmt: skip
    if rng.random() < 0.5:
        tables["kinematics"] = {"spin_speed_rpm": float(rng.uniform(500.0, 12000.0))}
        if bodies == "rigid" and rng.random() < 0.3:
            tables["kinematics"]["gyroscopic"] = "outer_race"
    if rng.random() < 0.3:
        tables["bearing"] |= {"arrangement": str(rng.choice(["DB", "DF"])), "preload": axial, "row_distance": 0.016}
        tables["load"]["axial"] = 0.3 * axial
    return tables


def scales(model):
    """By which entries are divided: lengths and tilts, forces and moments made alike by the arm of the tilts."""
    arm = np.array([1.0, 1.0, 1.0, 1.0 / model.system.arm, 1.0 / model.system.arm])
    return {"displacement": arm, "stiffness": 1.0 / np.outer(arm, arm), "contact_force": 1.0}


def moved(model, key, step):
    """Models at the places of a difference."""
    return {k: build_model(with_number(model.scene, key.path, key.value + k * step), model.plan) for k in (-2, -1, 1, 2)}


def static_errors(model, still, key, gradient):
    """Error and size of each quantity, both times the number at the key; None where the key changes nothing or an edge is
    near.  The steps of the runs are twice those of the gradients, so that both do not share their error."""
    if isinstance(gradient, NoDerivative) or not key.value or gradient.statics.step == 0.0 or gradient.statics.remark:
        return None
    gradient = gradient.statics
    step = 2.0 * gradient.step
    runs, result = {k: solve_equilibrium(one) for k, one in moved(model, key, step).items()}, {}
    for what, scale in scales(model).items():
        other = derivative({k: getattr(one, what) for k, one in runs.items()}, step)
        parts = getattr(gradient, what) - other, other
        result[what] = [float(np.abs(part * key.value / scale).max()) for part in parts]
    return result


@pytest.mark.parametrize(("bodies", "wanted", "seed"), [("rigid", 150, 23), ("condensed", 50, 24)])
def test_static_derivatives(claim, bodies, wanted, seed):
    rng, worst, count, scenes = np.random.default_rng(seed), 0.0, 0, 0
    while scenes < wanted:
        try:
            model = build_model(scene_from_dict(drawn(rng, bodies)))
            still = solve_equilibrium(model)
        except (ConvergenceError, SceneError):
            continue
        keys = continuous_keys(model.scene)
        gradients = Gradients(model, still).by_all(keys)
        pairs = zip(keys, gradients, strict=True)
        errors = [one for one in (static_errors(model, still, *pair) for pair in pairs) if one]
        scenes, count = scenes + 1, count + len(errors)
        for what in ("displacement", "stiffness", "contact_force"):
            off, size = (max(one[what][k] for one in errors) for k in (0, 1))
            worst = max(worst, off / size)
    quantity = (
        f"displacement, stiffness, contact forces of {wanted} random scenes, {bodies} bodies: largest error over the largest"
    )
    claim(
        quantity, worst, **LIMIT, source=f"differences of complete runs, {count} derivatives by keys that change something"
    )


def test_derivatives_of_steady_orbits(claim):
    rng, errors, count, wanted = np.random.default_rng(23), [], 0, 12
    for bodies in 150 * ["rigid"] + 50 * ["condensed"]:  # scenes of their own
        drawn(rng, bodies)
    while len(errors) < wanted:
        tables = drawn(rng, "rigid")
        tables.pop("kinematics", None)
        damping, speed = float(rng.choice([1e-3, 50.0])), float(rng.uniform(3000.0, 12000.0))
        kind = str(rng.choice(["unidirectional", "bidirectional"]))
        tables |= moving(kind, damping, speed, 0.1 * tables["load"]["axial"])
        try:
            error, keys = error_of_orbit(tables, 1e-4)
        except (ConvergenceError, SceneError):
            continue
        errors.append(error)
        count += keys
    quantity = f"Z of the steady orbit of {wanted} random scenes: largest error over the largest"
    claim(quantity, max(errors), **LIMIT, source=f"differences of complete searches to 1e-10, {count} derivatives")


def test_derivatives_beside_a_resonance(claim):
    """The ring's lateral motion at three times the speed: Z is no cubic within 1e-4 of the speed."""
    tables = {
        "bearing": {"preset": "7206A-NSK"},
        "load": {"axial": 123.5909851483739, "radial": [24.9558737565642, 15.70969487048965]},
        "supports": {"tilt": "free"},
        "mounting": {"inner_temperature": 3.267315162923901},
        **moving("bidirectional", 0.001, 7478.364624826643, 12.359098514837392),
    }
    error, _ = error_of_orbit(tables, 2.5e-5)
    quantity = "Z of a steady orbit beside a superharmonic resonance: largest error over the largest derivative"
    source = "differences of complete searches to 1e-10, whose steps change no digit of this"
    misses = "the derivative by the speed rests on differences itself, over steps that are long beside the resonance"
    claim(quantity, error, **LIMIT, source=source, misses=misses)


def moving(kind, damping, speed, force):
    return {
        "rotor": {"mass": 2.0, "transverse_inertia": 1e-3}, "contact": {"damping": damping},
        "excitation": {"kind": kind, "speed_rpm": speed, "amplitude": "constant", "force": force},
        "integrator": {"kind": "periodic", "tolerance": 1e-10},
    }  # fmt: skip


def error_of_orbit(tables, step):
    """Largest error of a derivative over the largest derivative, both times the numbers at the keys, and how many keys there are."""
    model = build_model(scene_from_dict(tables))
    gradients, off, size = Gradients(model, solve_equilibrium(model)), [], []
    for key in continuous_keys(model.scene):
        if key.path not in OF_ORBITS or not key.value:
            continue
        gradient = gradients.by_all([key])[0]
        if isinstance(gradient, NoDerivative):
            continue
        lines = {}
        for k, one in moved(model, key, step * abs(key.value)).items():
            there = SteadyOrbit.of(one, solve_equilibrium(one))
            lines[k] = there.line[[0, 4]]
        other = complex(*derivative(lines, step * abs(key.value)))
        off.append(abs(gradient.motion.dynamic_stiffness - other) * abs(key.value))
        size.append(abs(other) * abs(key.value))
    return max(off) / max(size), len(off)


def seconds(work) -> float:
    begun = working_processor_time()
    work()
    return working_processor_time() - begun


def test_cost_of_all_derivatives(claim):
    article = load_scene("examples/b7206.toml")
    static = [load_scene(f"examples/{name}.toml").with_(excitation=None) for name in ("b7206", "b7206_condensed")]
    orbits = [
        article.with_(excitation={"kind": kind}, integrator={"kind": "periodic"})
        for kind in ("unidirectional", "bidirectional")
    ]
    misses = {"static": "building columns in Python", "static, condensed bodies": "two models a key"}
    misses["steady orbit of a turn and of a pitch"] = (
        "columns of the rings' inertia and orbits of a turn for loads across the axis"
    )
    parts = (
        ("static", static[:1], 1.0), ("static, condensed bodies", static[1:], 2.0),
        ("steady orbit of a turn and of a pitch", orbits, 2.0),
    )  # fmt: skip
    for words, scenes, limit in parts:
        ratios = []
        for scene in scenes:
            sensitivities(scene)  # kernels and meshes
            complete = min(seconds(lambda scene=scene: run(scene)) for _ in range(10))
            ratios.append(min(sensitivities(scene).gradients_s for _ in range(10)) / complete)
        claim(
            f"all derivatives over the run, processor time, {words}: larger",
            max(ratios), at_most=limit, basis="regression", source="as dear as a run, two of a motion", misses=misses.get(words), machine=True,
        )  # fmt: skip


def test_preload_moves_stiffness(claim):
    off = []
    for name, wanted in (("7206C", 4.8), ("7206A5", 3.9), ("7206A", 3.5)):
        scene = {"bearing": {"preset": name, "arrangement": "DB", "preload": 400.0}}
        share = sensitivities(scene, ["bearing.preload"])["bearing.preload"].influence["kxx"]
        off.append(abs(10.0 * share - wanted))
    quantity = "10 % of preload moves kxx of 7206C, 7206A5, 7206A by 4.8, 3.9, 3.5 %: largest distance"
    source = "numbers of the requirement, which names no preload: DB pairs at 400 N"
    claim(quantity, max(off), at_most=0.3, unit="percentage points", basis="regression", source=source)


@pytest.mark.parametrize(
    ("words", "orbits", "count", "limit"), [("static", False, 2048, 1.0), ("steady orbit of a pitch", True, 2048, 10.0)]
)
def test_cost_of_a_band(claim, words, orbits, count, limit):
    scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 400.0}}
    if orbits:
        scene |= {"rotor": {"mass": 2.0}, "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 1e-4}}
    given = {"load.axial": "±10 %", "bearing.contact_angle_deg": "±1 deg"}
    band(scene, given, count=2)  # kernels
    begun = working_processor_time()
    samples = band(scene, given, count=count).samples
    spent = (working_processor_time() - begun) * 10_000 / samples
    quantity = f"10 000 samples of a band, {words}: processor time"
    claim(quantity, spent, at_most=limit, unit="s", basis="regression", source="seconds, as one waits")
