"""Derivatives from neighbouring solutions are those of whole runs."""

import attrs
import numpy as np
import pytest

import raceway as rw
from checks.validation.command_line import invoke
from raceway import SceneError, build_model, scene_from_dict
from raceway.extend import continuous_keys, key_of, resolve, with_number
from raceway.pipeline.first_order import derivatives, values
from raceway.pipeline.gradient import FOURTH_ORDER, SECOND_ORDER, Gradients, NoDerivative, SteadyOrbit, unevenness
from raceway.planning.columns import why_no_column
from raceway.testing import b7206c, settled, solve_equilibrium

LOADED = b7206c(load={"axial": 400.0, "radial": [120.0, 30.0]}, supports={"tilt": "free"})
#: Whole runs are solved to 1e-11; a step of 1e-4 leaves 1e-7 of that in a difference.
TOLERANCE = 1e-6


def derivative(values, step):
    """Of fourth order, of values at multiples -2, -1, 1, 2 of a step."""
    return (8.0 * (values[1] - values[-1]) - (values[2] - values[-2])) / (12.0 * step)


def test_kinks_and_turning_points_are_told_apart():
    """By x^3 at 1, where half the second derivative over the first is 1, by a kink, and by x^2 at 0."""
    h = 1e-3
    for function, at, expected in (
        (lambda x: x**3, 1.0, 3.0 * h / (3.0 + h**2)),
        (lambda x: max(x, 0.0), 0.0, 1.0),
        (lambda x: x**2, 0.0, 0.0),
    ):
        before, middle, after = (np.array([function(at + k * h)]) for k in (-1, 0, 1))
        assert unevenness([before[None], after[None]], middle)[0] == pytest.approx(expected, rel=1e-5)


def static_gradient(model, still, key):
    answer = Gradients(model, still, moving=False).by_all([key])[0]
    if isinstance(answer, NoDerivative):
        raise answer
    return answer.statics


def parts(one):
    """Displacement, stiffness and contact forces of an equilibrium, or their derivatives."""
    return [np.ravel(values) for values in (one.displacement, one.stiffness, one.contact_force)]


def by_runs(model, path, step, of):
    """The same derivative from equilibria that are solved for again."""
    value = key_of(model.scene, path).value
    found = {}
    for k in (-2, -1, 1, 2):
        one = build_model(with_number(model.scene, path, value + k * step), model.plan)
        found[k] = of(one, solve_equilibrium(one))
    return derivative(found, step)


def test_weights_of_differences_leave_the_fifth_power():
    """Of odd powers of the step: the first once, the third not at all."""
    for weights, third in ((SECOND_ORDER, 1.0), (FOURTH_ORDER, 0.0)):
        assert sum(2.0 * weight * k for k, weight in weights.items()) == pytest.approx(1.0, rel=1e-15)
        assert sum(2.0 * weight * k**3 for k, weight in weights.items()) == pytest.approx(third, abs=1e-15)


SCENES = {
    "tilts free": LOADED,
    "pair with preload and temperatures": LOADED | {
        "bearing": {"preset": "B7206C", "arrangement": "DB", "preload": 200.0}, "mounting": {"inner_temperature": 12.0, "outer_temperature": 5.0}},
    "fast, with gyroscopic moments": LOADED | {
        "supports": {"tilt": 2e4}, "kinematics": {"spin_speed_rpm": 15000.0, "gyroscopic": "outer_race"}},
    "held axially": LOADED | {"supports": {"axial": "displacement", "tilt": "free"}},
    "friction": LOADED | {"contact": {"friction": 0.05}},
    "spring": LOADED | {
        "bearing": {"preset": "B7206C", "arrangement": "DB", "preload": 300.0, "preload_kind": "spring"}, "kinematics": {"spin_speed_rpm": 9000.0}},
}  # fmt: skip


@pytest.mark.parametrize("name", SCENES)
def test_derivatives_of_an_equilibrium_are_those_of_whole_runs(name):
    model, still = settled(SCENES[name])
    seen = 0
    for key in continuous_keys(model.scene):
        if key.value == 0.0:
            continue  # of a symmetric scene most of these are 0 but for rounding
        try:
            found = static_gradient(model, still, key)
        except NoDerivative:
            continue
        if found.step == 0.0:
            assert not any(part.any() for part in parts(found))
            continue
        runs = by_runs(model, key.path, 10.0 * found.step, lambda _, e: np.concatenate(parts(e)))
        ends = np.cumsum([part.size for part in parts(still)])[:-1]
        for own, now, other in zip(parts(found), parts(still), np.split(runs, ends), strict=True):
            scale = np.abs(other).max() + np.abs(now).max() / abs(key.value) * 1e-3
            assert np.abs(own - other).max() <= TOLERANCE * scale, key.path
            seen += 1
    assert seen > 15


def test_an_axial_load_on_hertz_contacts_has_the_slope_of_its_power():
    """With contacts at 90 degrees kxx would grow as F^(1/3); at a small free angle the angle's growth adds to it."""
    model, still = settled(b7206c(bearing={"preset": "B7206C", "contact_angle_deg": 75.0}, load={"axial": 1.0}))
    slope = static_gradient(model, still, key_of(model.scene, "load.axial")).stiffness[0, 0] / still.stiffness[0, 0]
    assert slope == pytest.approx(1.0 / 3.0, rel=0.01)


ORBIT = b7206c(
    load={"axial": 400.0, "radial": [60.0, 0.0]}, supports={"tilt": "free"}, rotor={"mass": 2.0},
    contact={"damping": 200.0}, excitation={"kind": "unidirectional", "speed_rpm": 9000.0, "unbalance": 2e-5},
    integrator={"kind": "periodic", "tolerance": 1e-10},
)  # fmt: skip


def test_a_held_displacement_moves_along_orbits():
    model, still = settled(ORBIT | {"supports": {"axial": "displacement"}, "contact": {}, "load": {"axial": 300.0}})
    found = Gradients(model, still).by_path("load.axial").motion.equivalent_stiffness
    expected = by_runs(model, "load.axial", 0.1, lambda one, e: SteadyOrbit.of(one, e).line[2])
    assert found == pytest.approx(expected, rel=1e-5)


TURNING = {"excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 1e-4}}
MOVING = {
    "a pitch": b7206c(load={"axial": 300.0}, **TURNING),
    "a turn, damped": ORBIT | {"integrator": {"kind": "periodic"}},
    "a pitch, dashpots by stiffness": b7206c(load={"axial": 300.0}, contact={"time_constant": 1e-6}, **TURNING),
    "gyroscopic moments": b7206c(kinematics={"gyroscopic": "shared"}, supports={"tilt": "free"}, **TURNING),
    "a pair": SCENES["pair with preload and temperatures"] | {"load": {"axial": 100.0}, "supports": {}} | TURNING,
}


@pytest.mark.parametrize("name", MOVING)
def test_columns_have_the_derivatives_of_models(name):
    model, still = settled(MOVING[name])
    gradients = Gradients(model, still)
    keys = [key for key in continuous_keys(model.scene) if key.value]
    ends = gradients._ends(keys)
    keys = [key for key in keys if key.path not in ends and not why_no_column(model.problem, key.path)]
    columns = gradients._by_columns(keys)
    assert len(columns) > 15
    numbers = {}
    for key in keys[::2]:  # a model takes a tenth of a second
        if key.path in columns:
            both = columns[key.path], gradients._by_models(key)
            numbers[key.path] = [
                key.value * np.append(one.statics.stiffness.ravel(), [one.motion.dynamic_stiffness.real, one.motion.dynamic_stiffness.imag])
                for one in both
            ]  # fmt: skip
    first, other = np.array(list(numbers.values())).transpose(1, 0, 2)
    # Rounding over the steps of the differences; searches of preloads and of rates of dashpots end earlier.
    limit = 1e-6 if name in ("a pair", "a pitch, dashpots by stiffness") else 2e-9
    assert np.abs(first - other).max() <= limit * np.abs(other).max()


@pytest.mark.parametrize("path", ["excitation.speed_rpm", "bearing.contact_angle_deg", "contact.damping", "rotor.mass"])
def test_derivatives_of_a_steady_orbit_are_those_of_whole_searches(path):
    model, still = settled(ORBIT)
    gradients, key = Gradients(model, still), key_of(model.scene, path)
    orbit, found = gradients.orbit, gradients.by_path(path).motion

    def line(one, e):
        """Re Z, C, K, amplitude, Im Z."""
        return SteadyOrbit.of(one, e).line

    runs = by_runs(model, path, 2e-4 * key.value, line)
    # Orbits are solved to 1e-10 of their size, which a step of 2e-4 makes 5e-7 of |Z|; C is a small part of |Z|.
    omega = orbit.solved.problem.speed
    floor = 1e-6 * abs(orbit.line[0]) / key.value
    assert found.equivalent_stiffness == pytest.approx(runs[2], rel=1e-5, abs=floor)
    assert found.equivalent_damping * omega == pytest.approx(runs[1] * omega, rel=1e-5, abs=floor)
    assert found.amplitude == pytest.approx(runs[3], rel=1e-5, abs=1e-6 * orbit.line[3] / key.value)
    assert found.dynamic_stiffness.real == pytest.approx(runs[0], rel=1e-5, abs=floor)
    assert found.dynamic_stiffness.imag == pytest.approx(runs[4], rel=1e-5, abs=floor)


def test_every_number_of_a_motion_has_its_derivative():
    """By the speed, on which all of them depend; C is 3e-4 of |Z|, to which orbits are solved."""
    model, still = settled(ORBIT)
    gradients = Gradients(model, still)
    told = values(model, still, gradients.orbit)
    found = derivatives(model, still, gradients.by_path("excitation.speed_rpm"))
    runs = by_runs(model, "excitation.speed_rpm", 1.8, lambda m, e: np.array([*values(m, e, SteadyOrbit.of(m, e)).values()]))
    assert set(found) == set(told)
    for name, expected in zip(told, runs, strict=True):
        assert found[name] == pytest.approx(expected, rel=1e-2 if name == "C" else 1e-5), name


def test_steps_pass_no_knot_of_the_tables_of_compliances():
    """One contact lies 2 % of an interval from a knot, where derivatives of the stiffness jump: 4e-6 of them if steps pass it."""
    load = {"axial": 1843.8916451132752, "radial": [495.1466379641419, -92.98271863387704]}
    turning = {"mounting": {"inner_temperature": 1.4346647411771407}, "kinematics": {"spin_speed_rpm": 819.5406685711882}}
    model, still = settled(b7206c(bodies={"kind": "condensed"}, load=load, supports={"tilt": "free"}, **turning))
    found = static_gradient(model, still, key_of(model.scene, "load.axial"))
    runs = by_runs(model, "load.axial", 1.5 * found.step, lambda _, e: e.stiffness)
    assert np.abs(found.stiffness - runs).max() <= 1e-8 * np.abs(runs).max()


def test_condensed_bodies_refuse_what_changes_their_meshes():
    scene = scene_from_dict(LOADED | {"bodies": {"kind": "condensed"}})
    same, other = with_number(scene, "load.axial", 500.0), with_number(scene, "bearing.ball_diameter", 0.0096)
    assert scene.bodies.same_bodies(*map(resolve, (scene, same)))
    assert not scene.bodies.same_bodies(*map(resolve, (scene, other)))


def test_keys_come_from_the_declarations():
    paths = {key.path for key in continuous_keys(scene_from_dict(ORBIT))}
    assert {"load.radial[1]", "bearing.rings.young", "excitation.unbalance", "contact.damping"} <= paths
    assert not {path for path in paths if path.startswith(("integrator", "identifier", "mesh"))}
    assert not {"bearing.ball_count", "kinematics.orbiting", "supports.tilt"} & paths


def test_a_contact_at_the_edge_is_told():
    """Balls about to lift off: the radial load at which the least loaded ball carries next to nothing."""
    low, high = 0.0, 2000.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        model, still = settled(b7206c(load={"axial": 400.0, "radial": [middle, 0.0]}))
        low, high = (middle, high) if still.contact_force[: model.system.ball_count].min() > 0.0 else (low, middle)
    found = static_gradient(model, still, key_of(model.scene, "load.axial"))
    assert "opens or closes" in found.remark


BAD = [
    ("load.axail", LOADED, "did you mean 'load.axial'"), ("bearing.ball_count", LOADED, "no continuous key"),
    ("integrator.kind", LOADED, "setting of a method"), ("contact.damping", LOADED, "end of its range"),
]  # fmt: skip


@pytest.mark.parametrize(("path", "tables", "words"), BAD)
def test_what_has_no_derivative_is_refused_in_one_sentence(path, tables, words):
    model, still = settled(tables)
    with pytest.raises(SceneError, match=words):
        Gradients(model, still).by_path(path)


def test_surface_points_have_no_derivative():
    model, still = settled(LOADED)
    nodal = attrs.evolve(model, problem=resolve(scene_from_dict(LOADED | {"bodies": {"kind": "elastic"}, "contact": {"kind": "penalty", "discretisation": "nodal"}, "mesh": {"kind": "structured", "element_size": 2e-3}})))  # fmt: skip
    with pytest.raises(SceneError, match="one by one"):
        Gradients(nodal, still)


def test_the_command_writes_what_it_shows(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text('[bearing]\npreset = "B7206C"\n[load]\naxial = 1000.0\n')
    done = invoke("sensitivities", str(file), "--out", str(tmp_path), "--no-pictures", "--by", "load.axial")
    assert done.exit_code == 0 and "load.axial" in done.output
    found = rw.sensitivities(file, ["load.axial"])
    line = (tmp_path / "sensitivities.csv").read_text().splitlines()[1].split(",")
    assert line[0] == "load.axial" and float(line[3]) == pytest.approx(found["load.axial"].influence["kxx"], rel=1e-12)


def test_derivatives_of_an_unstable_orbit_are_told_to_be_such():
    found = rw.sensitivities(rw.load_scene("examples/folds.toml", ["excitation.speed_rpm=21784"]), ["load.axial"])
    assert "disturbances grow" in found.warnings[0]
    assert not rw.sensitivities(rw.load_scene("examples/folds.toml", ["excitation.speed_rpm=12e3"]), ["load.axial"]).warnings


def test_a_key_that_is_asked_for_and_has_no_derivative_is_refused():
    found = invoke("sensitivities", "examples/b7206.toml", "--by", "contact.friction")
    assert found.exit_code == 2 and "`contact.friction` = 0" in found.stderr
