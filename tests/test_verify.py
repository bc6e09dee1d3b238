"""The ``verify`` study itself: what it computes, refuses and reports."""

from __future__ import annotations

import json
from typing import ClassVar

import attrs
import pytest

from raceway import hookimpl
from raceway.errors import ConvergenceError, SceneError
from raceway.framework.registry import Registry
from raceway.integrators.newmark import Newmark
from raceway.studies.many.reference import reference_cases
from raceway.studies.verify import study as module
from raceway.studies.verify.study import COMPUTED, Verification, verify


def test_every_case_to_be_checked_is_computed_and_no_other():
    assert set(COMPUTED) == {name for name, case in reference_cases().items() if case.checked}


def test_as_dict_is_what_scripts_rely_on():
    table = verify(only="masta-dgbb-5").to_dict()
    assert json.loads(json.dumps(table, allow_nan=False)) == table
    assert table["passed"] is True and table["kept"] == {"published": {"within": 3, "of": 3}}
    assert len(table["rows"]) == 3
    for row in table["rows"]:
        assert {"case", "quantity", "reference", "computed", "error", "tolerance", "ok", "source", "basis"} <= set(row)
        assert row["source"].startswith("https://")


def test_numbers_that_no_source_published_are_not_counted_as_published():
    """Of the paper's unbalance only the inputs are used, and its load cases are lost: both sides of those are computed here."""
    found = verify(only=["masta-dgbb-1", "chung-ooi-1-glass", "seed-unbalance", "seed-static-pressures"])
    assert found.kept == {name: {"within": n, "of": n} for name, n in (("published", 1), ("closed form", 33), ("own", 10))}
    assert {row.case for row in found.rows if row.basis == "own"} == {"seed-static-pressures"}
    wrong = attrs.evolve(found, rows=tuple(attrs.evolve(row, ok=row.basis == "own") for row in found.rows))
    assert [kept["within"] for kept in wrong.kept.values()] == [0, 0, 10]


def test_several_cases_come_in_the_order_of_the_file():
    found = verify(only=["seed-unbalance", "masta-dgbb-1"])
    cases = [row.case for row in found.worst]
    assert cases == list(dict.fromkeys(row.case for row in found.rows)) == ["masta-dgbb-1", "seed-unbalance"]


@pytest.mark.parametrize(
    ("name", "said"),
    [("masta-dgbb-2", "masta-dgbb"), ("nsk-7206c-stiffness", "nsk-7206C-stiffness"), ("zzz", "known: masta-dgbb-1")],
)
def test_an_unknown_case_is_refused_with_the_nearest_name(name, said):
    with pytest.raises(SceneError) as caught:
        verify(only=name)
    assert said in str(caught.value)
    assert caught.value.exit_code == 2


def test_a_case_for_information_is_refused_with_its_reason():
    with pytest.raises(SceneError, match="a formula that this program need not compute"):
        verify(only="ross-friswell-ball")


def test_progress_counts_the_cases():
    seen = []
    verify(only=["masta-dgbb-1", "masta-dgbb-3"], on_progress=lambda *now: seen.append(now))
    assert seen == [("masta-dgbb-1", 0, 2), ("masta-dgbb-3", 1, 2), ("", 2, 2)]


def test_a_number_outside_its_tolerance_fails(monkeypatch):
    case = reference_cases()["masta-dgbb-1"]
    wrong = attrs.evolve(case, outputs={"dr_um": case.outputs["dr_um"] * 1.001})
    monkeypatch.setattr(module, "reference_cases", lambda: {case.id: wrong})
    found = verify()
    assert not found.passed
    # 0.1 % of the reference, less our own 7e-6.
    assert found.rows[0].error == pytest.approx(1e-3, rel=0.02)


def test_nothing_computed_is_not_a_pass():
    assert not Verification(()).passed


def test_a_solver_that_fails_is_a_row_with_its_reason(monkeypatch):
    def fails(case, registry):
        raise ConvergenceError("no static equilibrium found")
        yield

    monkeypatch.setitem(COMPUTED, "masta-dgbb-1", fails)
    found = verify(only="masta-dgbb-1")
    assert not found.passed
    assert "no static equilibrium" in found.rows[0].note
    assert json.loads(json.dumps(found.to_dict(), allow_nan=False))["rows"][0]["computed"] is None


def test_a_number_that_is_not_finite_is_a_row_without_one(monkeypatch):
    def no_number(case, registry):
        yield module.Number("x", 1.0, float("nan"), 1.0)

    monkeypatch.setitem(COMPUTED, "masta-dgbb-1", no_number)
    row = verify(only="masta-dgbb-1").rows[0]
    assert (row.ok, row.computed, row.error) == (False, None, None)
    assert "not a finite number" in row.note


@attrs.frozen
class Own(Newmark):
    """A third party's integrator that works."""

    name: ClassVar[str] = "own"


@attrs.frozen
class Broken(Newmark):
    """A third party's integrator that does not."""

    name: ClassVar[str] = "broken"

    @property
    def scheme(self):
        raise ZeroDivisionError("division by zero")


@attrs.frozen
class Direct(Newmark):
    """An integrator that finds a steady orbit and so cannot compute an impact."""

    name: ClassVar[str] = "direct"
    steady: ClassVar[bool] = True


class ThirdParty:
    @hookimpl
    def raceway_integrators(self):
        return [Own, Broken, Direct]


def test_third_party_integrators_are_run_and_a_broken_one_is_named():
    registry = Registry(third_party=False)
    registry.add(ThirdParty(), source="their-package")
    rows = {row.quantity: row for row in verify(only="chung-ooi-1-glass", registry=registry).rows}
    assert rows["peak force, own [N]"].ok
    assert rows["contact time, own [s]"].ok
    broken = rows["peak force, broken [N]"]
    assert not broken.ok
    assert "'broken' of their-package" in broken.note
    assert "ZeroDivisionError" in broken.note
    assert not any("direct" in quantity for quantity in rows)
    assert rows["peak force, newmark [N]"].ok
