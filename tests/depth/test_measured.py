"""A force from a CSV file: same answer as the formula that made it; every bad file gives one clear message."""

import math

import pytest

from raceway import SceneError, load_scene, scene_from_dict
from raceway.testing import b7206c, run

RPM = 12000.0
FORCE = 300.0


def turning(path, samples=360, turns=1, offset=0.0, sense=1.0):
    """The bidirectional force at equal intervals, as a logger would write it."""
    period = 60.0 / RPM
    lines = ["t, Fy, Fz"]
    for k in range(samples * turns):
        angle = 2.0 * math.pi * k / samples
        lines.append(
            f"{offset + period * k / samples:.12g}, {FORCE * math.cos(angle):.9g}, {sense * FORCE * math.sin(angle):.9g}"
        )
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return str(path)


def scene(excitation, turns=4, **tables):
    tables = {"rotor": {"mass": 2.0}, "integrator": {"turns": turns, "steps_per_turn": 360}, **tables}
    return scene_from_dict(b7206c(excitation=excitation, **tables))


@pytest.mark.parametrize("identifier", ["fft_1x", "sine_fit", "tangent"])
def test_same_stiffness_as_the_formula(tmp_path, identifier):
    """1e-4: the interpolation of 360 samples per turn is off by 1e-6 of the force at most."""
    named = {"identifier": {"kind": identifier}}
    formula = run(scene({"kind": "bidirectional", "speed_rpm": RPM, "amplitude": "constant", "force": FORCE}, **named))
    file = turning(tmp_path / "force.csv")
    measured = run(scene({"kind": "measured", "file": file, "speed_rpm": RPM, "repeats": True}, **named))
    assert measured.equivalent_stiffness == pytest.approx(formula.equivalent_stiffness, rel=1e-4)
    assert measured.identification.force_amplitude == pytest.approx(FORCE, rel=1e-4)
    # What the identifier leaves unused may be told; nothing else.
    assert not [text for text in measured.warnings if "has no effect" not in text]


def test_a_record_that_is_run_through_once(tmp_path):
    """Its length sets the turns; it starts with a ramp, since nothing says that it repeats."""
    file = turning(tmp_path / "force.csv", turns=12, offset=7.5)
    formula = run(scene({"kind": "bidirectional", "speed_rpm": RPM, "amplitude": "constant", "force": FORCE}))
    measured = run(scene({"kind": "measured", "file": file, "speed_rpm": RPM}))
    assert measured.model.plan.turns == 12
    assert measured.equivalent_stiffness == pytest.approx(formula.equivalent_stiffness, rel=1e-3)
    assert any("ramp" in warning for warning in measured.warnings)


@pytest.mark.parametrize(("sense", "declared"), [(1.0, 1), (-1.0, -1), (0.0, 0)])
def test_declared_sense_and_amplitude(tmp_path, sense, declared):
    file = turning(tmp_path / "force.csv", sense=sense)
    excitation = scene({"kind": "measured", "file": file, "speed_rpm": RPM, "repeats": True}).excitation
    assert excitation.sense == declared
    assert excitation.amplitude_n == pytest.approx(FORCE, rel=1e-6)
    assert excitation.period_s == pytest.approx(60.0 / RPM)


def test_file_is_found_beside_the_scene(tmp_path):
    turning(tmp_path / "force.csv")
    path = tmp_path / "scene.toml"
    path.write_text(
        '[bearing]\npreset = "B7206C"\n[load]\naxial = 1000.0\n[excitation]\nkind = "measured"\nfile = "force.csv"\n'
        "speed_rpm = 12000.0\nrepeats = true\n",
        encoding="utf-8",
    )
    assert load_scene(path).excitation.amplitude_n == pytest.approx(FORCE, rel=1e-6)


GOOD = "\n".join(f"{k * 1e-4:.6f},{k % 3}.5" for k in range(12))


@pytest.mark.parametrize(("text", "words"), [
    (None, "No such file"), ("", "is empty: a header line and samples are needed"),
    ("time,Fy\n" + GOOD, "the first line must name t"),
    ("t,force\n" + GOOD, "the first line must name t and some of Fx"),
    ("t,Fy,Fq\n" + GOOD, "no numbers stand under 'Fq' of line 1"), ("t,Fy\n0,1\n1e-4,1\n", "2 samples; at least 8"),
    ("t,Fy\n" + GOOD.replace("2.5", "two"), "line 4: 2 numbers are needed, found '0.000200,two'"),
    ("t,Fy\n" + GOOD.replace("2.5", "nan"), "line 4: a sample is missing (0.000200,nan)"),
    ("t,Fy\n" + GOOD.replace("2.5", "2.5,7"), "line 4: 2 numbers are needed"),
    ("t,Fy\n" + GOOD.replace("0.000300", "0.000200"), "line 5: time must grow"),
    ("t,Fy,Fy\n" + "\n".join(f"{k * 1e-4},1,2" for k in range(12)), "duplicated"),
    (b"t,Fy\n\xff\xfe\n", "line 2: 2 numbers are needed"),
    ("t,Fy\n" + "\n".join(f"{k * 1e-4},0.0" for k in range(12)), "the force is zero"),
])  # fmt: skip
def test_bad_file_gives_one_clear_message(tmp_path, text, words):
    path = tmp_path / "force.csv"
    if isinstance(text, bytes):
        path.write_bytes(text)
    elif text is not None:
        path.write_text(text, encoding="utf-8")
    with pytest.raises(SceneError) as caught:
        run(scene({"kind": "measured", "file": str(path), "speed_rpm": RPM, "repeats": True}))
    message = str(caught.value)
    assert words in message and "\n" not in message
    assert len(caught.value.mistakes) == 1


def test_uneven_times_are_refused_or_resampled(tmp_path):
    """A logger's jitter is resampled; a gap of many intervals is not bridged."""
    lines = ["t,Fy"] + [f"{k * 1e-4 + (1e-6 if k % 2 else 0.0):.7f},{math.cos(k)}" for k in range(60)]
    path = tmp_path / "jitter.csv"
    path.write_text("\n".join(lines), encoding="utf-8")
    assert scene({"kind": "measured", "file": str(path), "speed_rpm": RPM}).excitation.amplitude_n > 0.0
    gap = ["t,Fy"] + [f"{(k if k < 30 else k + 50) * 1e-4:.6f},{math.cos(k)}" for k in range(60)]
    path = tmp_path / "gap.csv"
    path.write_text("\n".join(gap), encoding="utf-8")
    with pytest.raises(SceneError, match=r"line 32: a gap of 0\.0051 s"):
        scene({"kind": "measured", "file": str(path), "speed_rpm": RPM})


def test_a_directory_is_not_a_file(tmp_path):
    with pytest.raises(SceneError, match="cannot be read|Is a directory"):
        scene({"kind": "measured", "file": str(tmp_path), "speed_rpm": RPM})
