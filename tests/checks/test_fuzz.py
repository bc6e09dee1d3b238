"""The fuzz: some of its scenes are checked here, and it sees the faults that it looks for."""

import math
import signal
import subprocess
from collections import Counter

import attrs
import numpy as np
import pytest

from checks.robustness import _fuzz, fuzz
from checks.robustness._doors import GOOD, called, fronts
from checks.robustness._fuzz import Watch, cheap, check, ran
from checks.robustness._scenes import fill, scene, scene_keys
from checks.validation.command_line import MINIMAL
from raceway import ConvergenceError, load_scene

KEYS = len(scene_keys())


def test_every_key_of_the_schema_is_drawn(tmp_path):
    fill(tmp_path)
    drawn: set[str] = set()
    for seed in range(KEYS):
        scene(seed, tmp_path, drawn)
    assert drawn == {key.name for key in scene_keys()}
    # The schema was walked to its ends.
    assert {"contact[film].oil", "mounting.shaft_material", "bearing.rings.young", "bearing.row", "tolerances"} <= drawn


def test_checked_scenes_end_in_a_plan_or_a_message(tmp_path):
    """Each key alone, and half as many scenes with several."""
    fill(tmp_path)
    ends = Counter(check(scene(seed, tmp_path))[2] for seed in range(KEYS + KEYS // 2))
    # All ends are met, so that none of them is the test's own doing.
    assert ends["planned"] > 0.2 * ends.total() and min(ends["refused"], ends["foreseen"]) >= 1, ends
    assert not (tmp_path / "PWNED").exists()


@pytest.mark.slow
def test_runs_end_in_numbers_or_a_message(tmp_path):
    """Rigid bodies only; ``python -m checks fuzz`` runs 1500 scenes of all bodies."""
    fill(tmp_path)
    ends: Counter[str] = Counter()
    for seed in range(0, 2 * KEYS, 6):
        good, plan, _ = check(scene(seed, tmp_path))
        if good is not None and good.bodies.name == "rigid" and cheap(good, plan):
            end, faults = ran(good)
            assert not faults, (seed, faults)
            ends[end] += 1
    assert ends["finished"] >= 15, ends


@pytest.mark.slow
def test_fronts_end_in_an_answer_or_a_message(tmp_path):
    assert set(fronts()) == set(GOOD), "give it arguments in checks/robustness/_doors.py"
    fill(tmp_path)
    ends: Counter[str] = Counter()
    for seed in range(2 * len(GOOD)):
        _, end, faults = called(seed, tmp_path)
        assert not faults, (seed, faults)
        ends[end] += 1
    assert min(ends["answered"], ends["refused"]) >= len(GOOD) // 2, ends


def test_a_scene_is_the_same_in_every_process(tmp_path):
    fill(tmp_path)
    seeds = range(KEYS, KEYS + 20)
    assert [repr(scene(k, tmp_path)) for k in seeds] == [repr(scene(k, tmp_path)) for k in seeds]


@pytest.mark.parametrize(("raised", "word"), [(KeyError("x"), "traceback"), (ConvergenceError("residual nan N"), "nan"),
                                              (ConvergenceError(" "), "traceback"), (ConvergenceError("no solution"), None)])  # fmt: skip
def test_what_a_run_raises_is_judged(monkeypatch, raised, word):
    def fails(scene):
        raise raised

    monkeypatch.setattr(_fuzz, "run", fails)
    faults = ran(load_scene(MINIMAL))[1]
    assert [fault[0] for fault in faults] == ([] if word is None else [word])


def test_a_number_that_is_none_is_seen(monkeypatch):
    scene = load_scene(MINIMAL)
    good = _fuzz.run(scene)
    assert ran(scene) == ("finished", [])
    wrong = attrs.evolve(good, equilibrium=attrs.evolve(good.equilibrium, displacement=np.full(5, math.nan)))
    monkeypatch.setattr(_fuzz, "run", lambda scene: wrong)
    assert ran(scene)[1][0][0] == "nan"
    for size, why in ((None, "total: null without warning"), (1.5, "an error larger than Z without warning")):
        wrong = attrs.evolve(good, errors=attrs.evolve(good.errors, total=attrs.evolve(good.errors.total, size=size)))
        assert ran(scene)[1] == [["untold", "run", why]]


def test_files_and_processes_are_seen_while_the_watch_is_on(tmp_path):
    watch = Watch()
    (tmp_path / "before").write_text("")
    watch.on = True
    (tmp_path / "file").write_text("")
    subprocess.run(["true"], check=True)
    watch.on = False
    (tmp_path / "after").write_text("")
    told = " ".join(watch.seen)
    assert "subprocess.Popen" in told and "file" in told and "before" not in told and "after" not in told


def test_the_signal_tells_a_hang_from_a_crash():
    assert fuzz._word(-signal.SIGPROF) == fuzz._word(-signal.SIGALRM) == "hang"
    assert fuzz._word(-signal.SIGSEGV) == fuzz._word(1) == "died"
