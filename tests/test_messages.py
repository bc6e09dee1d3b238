"""Scenes and consoles as they come: each ends in one message that says what is wrong."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from validation.command_line import ARTICLE, MINIMAL, invoke, raceway

HEAD = '[bearing]\npreset = "B7206C"\n[load]\n'
FILES = {
    "nested": (HEAD + "radial = " + "[" * 500 + "]" * 500, "nested too deep"),
    "digits": (HEAD + "axial = " + "9" * 5000, "a number has thousands of digits"),
    "large": (HEAD + "axial = " + "9" * 400, "must be a finite number"),
}


@pytest.mark.parametrize("case", FILES)
def test_scenes_of_odd_numbers(case, tmp_path):
    text, words = FILES[case]
    (tmp_path / "scene.toml").write_text(text)
    found = invoke("check", tmp_path / "scene.toml")
    assert found.exit_code == 2 and words in found.stderr and "unexpected" not in found.stderr


def test_a_byte_order_mark_is_no_mistake(tmp_path):
    (tmp_path / "scene.toml").write_bytes(b"\xef\xbb\xbf" + (HEAD + "axial = 1000.0").encode())
    assert invoke("check", tmp_path / "scene.toml").exit_code == 0


def test_pipes_and_devices_are_no_scenes(tmp_path):
    os.mkfifo(tmp_path / "pipe.toml")
    for path in (tmp_path / "pipe.toml", "/dev/zero"):
        found = raceway("check", path)
        assert found.returncode == 2 and "is no file" in found.stderr


def test_closed_and_narrow_consoles():
    command = f'"{sys.executable}" -m raceway check "{MINIMAL}" >&-'
    closed = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
    assert closed.returncode == 0 and closed.stderr == ""
    narrow = raceway("run", MINIMAL, "--out", os.devnull + "x", LC_ALL="C", PYTHONIOENCODING="ascii", PYTHONUTF8=0)
    assert "unexpected" not in narrow.stderr


def test_a_console_that_knows_ascii_only(tmp_path):
    found = raceway("run", MINIMAL, "--out", tmp_path, LC_ALL="C", PYTHONIOENCODING="ascii", PYTHONUTF8=0)
    assert found.returncode == 0, found.stderr
    assert "N/um" in found.stdout


def test_numba_without_its_compiler_is_refused(tmp_path):
    found = raceway("run", MINIMAL, "--out", tmp_path, NUMBA_DISABLE_JIT=1)
    assert found.returncode == 2 and "NUMBA_DISABLE_JIT is set" in found.stderr and "unexpected" not in found.stderr


CANNOT_RUN = {
    "no load": (["load.axial=0"], "`load.axial` = 0.0: nothing loads the bearing"),
    "window": (
        ["excitation.kind=bidirectional", "identifier.kind=order_tracking", "identifier.window_turns=20.0"],
        "is longer than the record of 12 turns",
    ),
    "step": (["integrator.kind=central_difference", "integrator.steps_per_turn=8"], "far above the stable step"),
}


@pytest.mark.parametrize("case", CANNOT_RUN)
def test_check_foresees_what_a_run_would_fail_at(case):
    changes, words = CANNOT_RUN[case]
    found = invoke("check", ARTICLE, *(word for change in changes for word in ("--set", change)))
    assert found.exit_code == 2, found.output
    assert words in found.stderr


def test_a_reader_that_goes_away_is_no_error():
    command = f"{sys.executable} -m raceway schema | head -n 1"
    found = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=60, check=False)
    assert found.stdout == "{\n"
    assert found.stderr == ""
