"""The ``verify`` study itself: what it computes, refuses and reports."""

import json
from functools import wraps
from typing import ClassVar

import attrs
import pytest
from raceway_checks.verify.reference import reference_cases
from raceway_checks.verify.study import COMPUTED, Verification, verify

from checks.validation.command_line import invoke
from checks.validation.scenes import built_in
from raceway import ConvergenceError, SceneError, hookimpl
from raceway.extend import Registry

Newmark = built_in("integrator", "newmark")


def test_every_case_to_be_checked_is_computed_and_no_other():
    assert set(COMPUTED) == {name for name, case in reference_cases().items() if case.checked}


def test_as_dict_is_what_scripts_rely_on():
    table = verify(only="masta-dgbb-5").to_dict()
    assert json.loads(json.dumps(table, allow_nan=False)) == table
    assert table["passed"] is True and table["kept"] == {"published": {"within": 4, "of": 4}}
    assert len(table["rows"]) == 4
    for row in table["rows"]:
        assert {"case", "quantity", "reference", "computed", "error", "tolerance", "ok", "source", "basis"} <= set(row)
        assert row["source"].startswith("https://")


@pytest.mark.parametrize("name", ["harris-mindel-1973-hertz-inner", "harris-table-6.1"])
def test_ellipses_are_the_published_ones(name):
    assert verify(only=name).to_dict()["passed"]


def test_numbers_that_no_source_published_are_not_counted_as_published(monkeypatch):
    """Of the paper's unbalance only the inputs are used, and its load cases are lost: both sides of those are computed, at night."""
    monkeypatch.setitem(COMPUTED, "seed-static-pressures", lambda case, _: [case.row("x", 1.0, 1.0, 1.0)])
    found = verify(only=["masta-dgbb-1", "chung-ooi-1-glass", "seed-unbalance", "seed-static-pressures"])
    assert found.kept == {name: {"within": n, "of": n} for name, n in (("published", 2), ("closed form", 33), ("own", 1))}
    assert {row.case for row in found.rows if row.basis == "own"} == {"seed-static-pressures"}
    wrong = attrs.evolve(found, rows=tuple(attrs.evolve(row, ok=row.basis == "own") for row in found.rows))
    assert [kept["within"] for kept in wrong.kept.values()] == [0, 0, 1]


def test_several_cases_come_in_the_order_of_the_file_with_progress():
    seen = []
    found = verify(only=["seed-unbalance", "masta-dgbb-1"], progress=lambda *now: seen.append(now))
    cases = [row.case for row in found.worst]
    assert cases == list(dict.fromkeys(row.case for row in found.rows)) == ["masta-dgbb-1", "seed-unbalance"]
    assert seen == [("masta-dgbb-1", 0, 2), ("seed-unbalance", 1, 2), ("", 2, 2)]


@pytest.mark.parametrize(("name", "said"), [
    ("masta-dgbb-2", "masta-dgbb"), ("nsk-7206c-stiffness", "nsk-7206C-stiffness"),
    ("zzz", "known: masta-dgbb-1"),
    ("ross-friswell-ball", "a formula that this program need not compute"),
])  # fmt: skip
def test_a_case_that_is_unknown_or_for_information_is_refused(name, said):
    with pytest.raises(SceneError) as caught:
        verify(only=name)
    assert said in str(caught.value) and caught.value.exit_code == 2


def test_a_number_outside_its_tolerance_fails_and_nothing_computed_is_no_pass(monkeypatch):
    case = reference_cases()["masta-dgbb-1"]
    wrong = attrs.evolve(case, outputs={"dr_um": case.outputs["dr_um"] * 1.001})
    monkeypatch.setattr("raceway_checks.verify.study.reference_cases", lambda: {case.id: wrong})
    found = verify()
    assert not found.passed and not Verification(()).passed
    # 0.1 % of the reference, less our own 7e-6.
    assert found.rows[0].error == pytest.approx(1e-3, rel=0.02)


def fails(case, registry):
    raise ConvergenceError("no static equilibrium found")
    yield


def no_number(case, registry):
    yield case.row("x", 1.0, float("nan"), 1.0)


@pytest.mark.parametrize(("computed", "said"), [(fails, "no static equilibrium"), (no_number, "not a finite number")])
def test_what_gives_no_number_is_a_row_with_its_reason(monkeypatch, computed, said):
    monkeypatch.setitem(COMPUTED, "masta-dgbb-1", computed)
    found = verify(only="masta-dgbb-1")
    (row,) = found.rows
    assert not found.passed and (row.ok, row.computed, row.error) == (False, None, None) and said in row.note
    assert json.loads(json.dumps(found.to_dict(), allow_nan=False))["rows"][0]["computed"] is None


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
    for quantity in ("peak force, own [N]", "contact time, own [s]", "peak force, newmark [N]"):
        assert rows[quantity].ok
    broken = rows["peak force, broken [N]"]
    assert not broken.ok and "'broken' of their-package" in broken.note and "ZeroDivisionError" in broken.note
    assert not any("direct" in quantity for quantity in rows)


def test_verify_fails_with_code_1(monkeypatch):
    @wraps(verify)
    def off(*given, **named):
        done = verify(*given, **named)
        return attrs.evolve(done, rows=tuple(attrs.evolve(row, ok=False) for row in done.rows))

    content = json.loads(invoke("verify", "--only", "seed-unbalance", "--json").stdout)
    assert all(row["ok"] for row in content["rows"])
    monkeypatch.setattr("raceway_checks.verify.study.verify", off)
    found = invoke("verify", "--only", "seed-unbalance")
    assert found.exit_code == 1 and "0 of" in found.stdout
