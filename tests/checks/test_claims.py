"""A claim asserts, its row stands in the report, and reports are made of whole modules without a failure."""

import math
from types import SimpleNamespace

import pytest

from checks import reports as files
from checks.claims import Claim, _Reports, claims_into, limits_of


@pytest.fixture
def rows():
    return []


def test_a_claim_asserts_and_leaves_a_row(rows):
    claim = claims_into(rows)
    claim("x", 2.96, near=2.95, within=0.01, unit="N", basis="published", source="a table")
    claim("e", 1e-10, at_most=1e-9, basis="closed form")
    (_, x), (_, e) = rows
    assert (x["low"], x["high"]) == pytest.approx((2.9205, 2.9795)) and e["low"] is None
    assert Claim(**x).holds and Claim(**x).limits == "2.9205 to 2.9795" and Claim(**e).limits == "at most 1e-09"


@pytest.mark.parametrize(("value", "limits", "words"), [
    (3.0, {"near": 2.95, "within": 0.01}, "x = 3 : 2.9205 to 2.9795"), (math.nan, {"at_most": 1.0}, "x = nan"),
    (0.5, {"at_most": 1.0, "misses": "for want of a mesh"}, "take `misses` away"),
])  # fmt: skip
def test_what_does_not_hold_fails_and_leaves_no_row(rows, value, limits, words):
    with pytest.raises(AssertionError, match=words):
        claims_into(rows)("x", value, basis="regression", **limits)
    assert not rows


def test_a_stated_miss_stays_visible(rows):
    claims_into(rows)("x", 2.0, at_most=1.0, basis="own other method", misses="the mesh is coarse")
    data = {"rows": [rows[0][1]]}
    assert files.misses({"one": data}).endswith("| **[one](one.json)** |\n| x | 2, ≤ 1 |")
    assert "| x | **2**, ≤ 1 | 1; misses: the mesh is coarse |" in files.table(data)


@pytest.mark.parametrize(("value", "misses"), [(2.0, "Python and its libraries"), (0.5, "")])
def test_a_value_of_the_machine_misses_or_holds(rows, value, misses):
    claims_into(rows)("x", value, at_most=1.0, basis="regression", misses="Python and its libraries", machine=True)
    assert rows[0][1]["misses"] == misses


@pytest.mark.parametrize("clock", [{"unit": "s"}, {"unit": "ms"}, {"machine": True}])
def test_no_quick_test_is_decided_by_the_clock(rows, clock):
    with pytest.raises(TypeError, match="mark its test `night`"):
        claims_into(rows, by_night=False)("x", 0.5, at_most=1.0, basis="regression", **clock)
    claims_into(rows)("x", 0.5, at_most=1.0, basis="regression", **clock)
    assert len(rows) == 1


@pytest.mark.parametrize("limits", [{}, {"near": 1.0}, {"near": 1.0, "within": 0.1, "at_most": 2.0}])
def test_a_claim_has_one_kind_of_limits(limits):
    with pytest.raises(TypeError, match="`near` with `within`"):
        limits_of(**{"near": None, "within": None, "at_least": None, "at_most": None, **limits})


def test_a_basis_is_one_of_the_list(rows):
    with pytest.raises(TypeError, match="none of closed form"):
        claims_into(rows)("x", 1.0, at_most=2.0, basis="experience")


def test_reports_are_of_modules_without_a_failure(rows, tmp_path, monkeypatch):
    monkeypatch.setattr(files, "ROOT", tmp_path)
    monkeypatch.setattr(
        files, "write", lambda name, title, rows, seconds, command: written.update({name: (title, rows, command)})
    )
    monkeypatch.setattr(files, "refresh", list)
    (tmp_path / "tests" / "evidence").mkdir(parents=True)
    for name in ("good", "bad"):
        (tmp_path / "tests" / "evidence" / f"test_{name}.py").write_text(f'"""Numbers that are {name}."""\n')
    written: dict[str, tuple] = {}
    claim = claims_into(rows)
    claim("second", 1.0, at_most=2.0, basis="closed form")
    claim("third", 1.0, at_most=2.0, basis="closed form")
    reports = _Reports()
    for name, line, failed, properties in (
        ("good", 9, False, rows),
        ("good", 3, False, [("claim", {**rows[0][1], "quantity": "first"})]),
        ("bad", 3, True, []),
    ):
        nodeid = f"tests/evidence/test_{name}.py::test_{line}"
        told = {"nodeid": nodeid, "when": "call", "failed": failed, "skipped": False, "duration": 0.5}
        reports.pytest_runtest_logreport(SimpleNamespace(**told, user_properties=properties, location=("", line, "")))
    reports.pytest_terminal_summary(SimpleNamespace(write_line=lambda line: None))
    title, kept, command = written.pop("good")
    assert title == "Numbers that are good" and command == "pytest --evidence tests/evidence/test_good.py"
    assert [row["quantity"] for row in kept] == ["first", "second", "third"] and not written
