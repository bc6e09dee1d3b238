"""Screens show what results hold: they change units and count, and compute nothing else."""

import ast
import json
from pathlib import Path

import numpy as np
import pytest

from raceway.pipeline.result import tilts_follow
from validation.command_line import ARTICLE, invoke

PACKAGE = Path(__file__).parents[1] / "raceway"
#: All but the module that writes numbers with so many digits.
SCREENS = [path for path in (*PACKAGE.glob("commands/screen/*.py"), *PACKAGE.rglob("*screen.py")) if path.name != "text.py"]
#: What ``raceway verify`` sorts its rows by, and does not show.
SORTED_BY = {"verify": ["row['error'] / row['tolerance']"]}


def number(node):
    """A literal number, or arithmetic of such: a factor of units."""
    if isinstance(node, ast.BinOp):
        return number(node.left) and number(node.right)
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float)


def count(node):
    """How many there are, plain or less another count."""
    if isinstance(node, ast.BinOp):
        return count(node.left) or count(node.right)
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "len"


@pytest.mark.parametrize("path", SCREENS, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_a_screen_changes_units_and_counts_only(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    arithmetic = [
        n for n in ast.walk(tree) if isinstance(n, ast.BinOp) and isinstance(n.op, ast.Mult | ast.Div | ast.Sub | ast.Pow)
    ]
    computed = [ast.unparse(n) for n in arithmetic if not (number(n.left) or number(n.right) or count(n))]
    assert computed == SORTED_BY.get(path.parent.name, []), "compute it where the result is made, and name it there"
    imported = {alias.name for n in ast.walk(tree) if isinstance(n, ast.Import | ast.ImportFrom) for alias in n.names}
    modules = {n.module for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)} | imported
    assert not modules & {"math", "cmath", "numpy"}


def test_what_the_screen_of_a_run_shows_is_in_its_result(tmp_path):
    words = ("--set", "supports.tilt=free", "--set", "bearing.radial_clearance=3e-5", "--out", tmp_path)
    found = invoke("run", ARTICLE, *words)
    assert found.exit_code == 0, found.stderr
    text, result = " ".join(found.stdout.split()), json.loads((tmp_path / "result.json").read_text())
    equilibrium, identification = result["equilibrium"], result["identification"]
    assert f"kyy, tilt free {1e-6 * equilibrium['kyy_tilts_follow_n_per_m']:.5g} N/µm" in text
    assert f"contact angle {equilibrium['free_contact_angle_deg']:.5g} deg, from the clearance" in text
    wide = identification["dynamic_stiffness_imag_error"]
    # Im Z = w C: both errors are one.
    speed = 2.0 * np.pi * identification["frequency_hz"]
    assert wide == pytest.approx(speed * identification["equivalent_damping_error"])


@pytest.mark.parametrize("tilt", ["free", 3e4])
def test_tilts_that_follow_are_condensed_statically(tilt):
    """Against the response of all three coordinates to a radial force alone."""
    root = np.random.default_rng(5).normal(size=(5, 5))
    k = root @ root.T + np.eye(5)
    held = [1, 3, 4]
    supported = k + np.diag([0.0, 0.0, 0.0, *(2 * [0.0 if tilt == "free" else tilt])])
    moved = np.linalg.solve(supported[np.ix_(held, held)], [1.0, 0.0, 0.0])
    assert tilts_follow(k, tilt) == pytest.approx(1.0 / moved[0], rel=1e-10)
    assert tilts_follow(k, "locked") is None
    assert tilts_follow(np.diag([1.0, 2.0, 3.0, 0.0, 0.0]), "free") == 2.0
