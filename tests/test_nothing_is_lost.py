"""What a run computed is neither lost nor taken for another's; numbers that mean nothing are told as such."""

import json

import attrs
import numpy as np
import pytest
from raceway_measure.fit.signals import recording_of, signals_of

from checks.validation.command_line import ARTICLE, MINIMAL, invoke
from checks.validation.cubes import block
from checks.validation.scenes import built_in
from raceway import ConvergenceError, MeshError, SceneError, build_model, make_plan, scene_from_dict
from raceway.extend import HexMesh, resolve
from raceway.framework.estimate import Estimate
from raceway.pipeline.error import Errors, Part
from raceway.planning.resolve import fits, record_bytes, recorded_per_turn
from raceway.testing import b7206c, run

HOOK = """
from raceway import hookimpl
@hookimpl
def raceway_run_finished(result): raise RuntimeError("the server is away")
"""


def test_a_hook_that_fails_after_the_run_does_not_lose_it(tmp_path):
    (tmp_path / "hook.py").write_text(HOOK)
    found = invoke("run", MINIMAL, "--plugin", tmp_path / "hook.py", "--out", tmp_path / "out", "--json")
    assert found.exit_code == 0, found.stderr
    content = json.loads((tmp_path / "out" / "result.json").read_text())
    assert content["identification"]["equivalent_stiffness"] > 0.0
    assert any("raises RuntimeError: the server is away" in text for text in content["warnings"])


def test_a_run_that_fails_leaves_no_result_of_another_one_beside_its_failure(tmp_path):
    assert invoke("run", MINIMAL, "--out", tmp_path).exit_code == 0
    first = (tmp_path / "result.json").read_text()
    assert invoke("run", MINIMAL, "--set", "load.axial=0", "--out", tmp_path).exit_code == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["failure.json", "result-older.json"]
    assert (tmp_path / "result-older.json").read_text() == first
    assert invoke("run", MINIMAL, "--out", tmp_path).exit_code == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["result-older.json", "result.json"]


def test_more_harmonics_than_samples_are_refused_by_the_plan():
    words = ["--set", "identifier.kind=sine_fit", "--set", "integrator.steps_per_turn=24", "--set"]
    found = invoke("plan", ARTICLE, *words, "identifier.harmonics=50")
    assert found.exit_code == 2
    assert "`identifier.harmonics` = 50: 50 harmonics, mean and drift are 102 unknowns, but 24 samples" in found.stderr
    assert invoke("plan", ARTICLE, *words, "identifier.harmonics=11").exit_code == 0


def test_a_number_below_its_error_is_not_resolved(monkeypatch):
    errors = attrs.evolve(Errors.unknown(Estimate.BEYOND_PLAN()), total=Part(1.3, Estimate.SUM()))
    monkeypatch.setattr("raceway.pipeline.run.errors_of", lambda *_: errors)
    result = run(
        scene_from_dict(
            b7206c(rotor={"mass": 2.0}, excitation={"kind": "bidirectional", "speed_rpm": 12000, "unbalance": 3e-4})
        )
    )
    assert result.warnings[0].startswith("Z is not resolved: its estimated error is 1.3 times its size")


def recorded(folder, y):
    time = np.arange(len(y)) / 20_000.0
    z = 1e-5 * np.sin(2.0 * np.pi * 200.0 * time)
    key = (np.arange(len(y)) % 100 < 5).astype(float)
    lines = [
        "time_s,y_um,z_um,key",
        *(f"{t:.9g},{1e6 * a:.7g},{1e6 * b:.7g},{k:g}" for t, a, b, k in zip(time, y, z, key, strict=True)),
    ]
    (folder / "record.csv").write_text("\n".join(lines))
    return folder / "record.csv"


#: Phases that no sampling repeats.
WAVE = 1e-5 * np.cos(2.0 * np.pi * 200.003 * np.arange(4000) / 20_000.0)


@pytest.mark.parametrize(("signal", "words"), [
    (np.minimum(WAVE, 0.8e-5), "of all samples of y lie at the top of its range, 8 µm: the signal is clipped"),
    (np.maximum(WAVE, -0.95e-5), "of all samples of y lie at the bottom"),
])  # fmt: skip
def test_a_signal_that_is_cut_off_is_refused(tmp_path, signal, words):
    with pytest.raises(SceneError, match=words):
        recording_of(signals_of(recorded(tmp_path, signal)))


@pytest.mark.parametrize("levels", [5, 20, 1000])
def test_a_coarse_resolution_is_not_taken_for_a_cut(tmp_path, levels):
    step = 1e-5 / levels
    assert len(recording_of(signals_of(recorded(tmp_path, step * np.round(WAVE / step)))).y) == 4000


def test_noise_is_not_taken_for_a_cut(tmp_path):
    noisy = WAVE + 1e-7 * np.random.default_rng(1).standard_normal(len(WAVE))
    assert len(recording_of(signals_of(recorded(tmp_path, noisy))).y) == 4000


@pytest.mark.parametrize("fault", ["doubled", "unmerged", "apart"])
def test_meshes_that_are_not_one_body_are_refused(fault, tmp_path):
    mesh = block()
    count = len(mesh.points)
    if fault == "doubled":
        bad, words = HexMesh(mesh.points, np.vstack([mesh.cells, mesh.cells[:3]]), {}, {}), "3 cells are duplicated"
    else:
        shift = np.ptp(mesh.points[:, 0]) * (1.0 if fault == "unmerged" else 2.0)
        other = mesh.points + 4e-11 * np.cos(np.arange(3 * count)).reshape(-1, 3)  # .inp files have eleven figures
        points = np.vstack([mesh.points, other + [shift, 0.0, 0.0]])
        bad = HexMesh(points, np.vstack([mesh.cells, mesh.cells + count]), {}, {})
        words = "`: 30 points coincide with others" if fault == "unmerged" else "its cells form 2 parts"
    form, mesher = built_in("format", "vtu")(), built_in("mesher", "file")(inner_ring=str(tmp_path / "body.vtu"))
    form.write(tmp_path / "body.vtu", bad)
    with pytest.raises(MeshError, match=words):
        mesher.mesh(scene_from_dict(b7206c()).bearing)
    form.write(
        tmp_path / "body.vtu", HexMesh(mesh.points * [1e-6, 1.0, 1.0], mesh.cells, {}, {})
    )  # layers of 0.01 um in 30 mm
    assert len(mesher.mesh(scene_from_dict(b7206c()).bearing)["inner_ring"].points) == count


def test_a_groove_is_not_deeper_than_its_balls_centre():
    with pytest.raises(SceneError, match="must be below half the ball's diameter"):
        scene_from_dict(b7206c(bearing={"shoulder_height": 0.005}))


def test_an_ellipse_around_the_ball_is_refused():
    """Young's modulus in MPa."""
    soft = {"young": 212e3}
    with pytest.raises(ConvergenceError, match="no such contact exists"):
        run(scene_from_dict(b7206c(bearing={"rings": soft, "balls": soft}, load={"axial": 20_000.0})))


def test_units_that_are_unlikely_are_told(tmp_path):
    found = invoke("check", MINIMAL, "--set", "bearing.rings.young=2.12e5", "--set", "kinematics.radial_expansion=1.2")
    assert found.exit_code == 0
    assert "`bearing.rings.young` = 212000 Pa is less than 1 GPa" in found.stderr
    assert "`kinematics.radial_expansion` = 1.2 m is more than 1 m" in found.stderr
    assert "warning" not in invoke("check", MINIMAL).stderr


def test_the_plan_of_explicit_steps_knows_a_tilt_stiffness():
    def planned(tilt):
        scene = scene_from_dict(
            b7206c(
                supports={"tilt": tilt},
                rotor={"mass": 2.0, "transverse_inertia": 1e-4},
                excitation={"kind": "bidirectional", "speed_rpm": 12000, "unbalance": 3e-4},
                integrator={"kind": "central_difference"},
            )  # fmt: skip
        )
        return scene, make_plan(scene).predicted_steps

    scene, steps = planned(1e9)
    _, free = planned("free")
    assert resolve(scene).highest_frequency >= (1e9 / 2e-4) ** 0.5
    assert steps > 20 * free
    model = build_model(scene)
    real = model.system.critical_time_step(model.system.evaluate(model.guess).stiffness)
    # 12 turns of 5 ms in steps of 0.8 of the limit: the plan is to know their number within a factor of two.
    assert steps == pytest.approx(12 * 5e-3 / (0.8 * real), rel=0.5)


def test_records_are_predicted_with_what_is_copied_of_them():
    """Of 12 balls: 16 numbers of the ring and 8 a ball, eight bytes each, and three copies of all at the peak."""
    assert record_bytes(10, 360, 12) == 4 * 8 * 10 * 360 * (16 + 8 * 12)
    # Steps that no number of samples divides are all recorded: a second run with such a number is asked, too.
    assert record_bytes(1000, 3607, 12) > 20 * record_bytes(1000, 3600, 12)
    assert fits(1000, 3600, 12) and not fits(10_000, 3607, 12)


def test_explicit_steps_of_a_slow_turn_are_recorded_at_their_samples():
    """At 1 r/min a turn takes millions of steps, a multiple of the samples: the record fits, and the plan refuses nothing."""
    excitation = {"kind": "bidirectional", "speed_rpm": 1.0, "amplitude": "constant", "force": 400.0}
    integrator = {"kind": "central_difference", "turns": 3}
    plan = make_plan(scene_from_dict(b7206c(excitation=excitation, integrator=integrator)))
    assert plan.predicted_steps > 1e6
    assert recorded_per_turn(plan.predicted_steps // plan.turns, plan.turns) == 360
