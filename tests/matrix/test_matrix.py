"""Combinations of all kinds run, are finite, keep their energy and agree with their class of answers, or are refused with a reason.

Tolerances on Z against Hertz, Newmark and a record's 1x line of the same bodies, excitation and tilt boundary:

same law, any inertial integrator, any 1x line of a record: 0.5 %.  The methods are of second order at 120 steps a turn
    (1e-5), a run-up's window moves with its samples (1e-3).
``quasi_static``: its K against K, 3 % (tilt locked) and 10 % (free or held by a shaft): the contacts carry F0, not
    F0 + m w^2 r (physics.md, section 6).
``tangent``: 10 % and 30 %: small signals against some 500 N on 2000 N axial.
``impedance_fit``: 10 % and 30 %: one K for several whirl speeds, at which amplitudes and the shape of tilts differ.
pressures at surface points: 4 % more: with three points along a semi-axis forces ripple by 3 % over a small orbit.
another law: a factor 1.6 more, up or down: a law calibrated at the load has Hertz's force there, and a slope that is
    4/3 of Hertz's for the penalty's square.
"""

import pytest

from raceway import SceneError, make_plan, scene_from_dict
from raceway.testing import default_registry
from tests.matrix.combinations import (
    Combination,
    NeedsOptions,
    Outcome,
    combinations,
    only_planned,
    options,
    outcome,
    reference,
    runs_elastic,
    tables,
    together,
)
from tests.matrix.conftest import KEY

#: Tables that may say why a combination cannot run.
OPTIONS = ("bodies", "contact", "identifier", "integrator", "mesh")


def wide(cell: Combination) -> float:
    """Relative tolerance on K for one law."""
    locked = cell.tilt == "locked"
    needs = default_registry().find("identifier", cell.identifier).plugin.needs
    if "record" not in needs or "speeds" in needs:
        return 0.10 if locked else 0.30
    if not default_registry().find("integrator", cell.integrator).plugin.inertial:
        return 0.03 if locked else 0.10
    return 0.005


def well_refused(refusal: SceneError) -> None:
    """The reason belongs to an option of the combination, in more than a word."""
    assert all(m.path.split(".")[0] in OPTIONS for m in refusal.mistakes), str(refusal)
    assert all(len(m.message) > 20 for m in refusal.mistakes)


def has_to_run(cell: Combination) -> bool:
    """Built-in cells that nothing may refuse: nothing that could run hides among the refusals."""
    if cell.bodies == "elastic":
        return runs_elastic(cell) and cell.law in ("hertz", "penalty")
    plain = cell.bodies in ("rigid", "condensed") and cell.discretisation == "resultant" and cell.law in ("hertz", "penalty")
    known = cell.integrator in ("newmark", "generalized_alpha", "central_difference", "quasi_static")
    periodic = cell.excitation in ("bidirectional", "unidirectional", "measured")
    line = cell.identifier in ("fft_1x", "sine_fit", "order_tracking", "tangent")
    run_up = cell.excitation == "run_up" and cell.identifier == "order_tracking"
    return plain and known and ((periodic and line) or run_up)


def judged(cell: Combination) -> str:
    """What became of a cell, in a word that is counted; its numbers are held against the reference."""
    try:
        for kind, name in (("excitation", cell.excitation), ("contact_law", cell.law), ("integrator", cell.integrator)):
            options(kind, name)
        options("identifier", cell.identifier)
    except NeedsOptions:
        return "need options"
    if only_planned(cell):
        told = "accepted by the plan"
        try:
            assert make_plan(scene_from_dict(tables(cell))).dofs > 0
        except SceneError as refusal:
            well_refused(refusal)
            told = "refused with a reason"
            assert not has_to_run(cell)
        return told
    found = outcome(cell)
    if not isinstance(found, Outcome):
        assert not has_to_run(cell), str(found)
        well_refused(found)
        return "refused with a reason"
    assert "NaN" not in found.text
    assert found.stiffness > 0.0
    # Newmark and its kin leave 1e-4 of the largest energy at 120 steps a turn; central differences less.
    # Elastic bodies take eight steps a turn: some percent.
    assert found.drift is None or found.drift < (0.05 if cell.bodies == "elastic" else 5e-3)
    expected = reference(cell.excitation, cell.tilt, cell.bodies)
    if expected is not None and cell.law != "line":  # whose contacts are lines, which balls do not have
        k = expected.real + found.mass * found.speed**2
        nodal = cell.discretisation == "nodal"
        factor = 1.0 if cell.law == "hertz" or nodal else 1.6
        within = wide(cell) + (0.04 if nodal else 0.0)
        assert k / factor * (1.0 - within) < found.stiffness < k * factor * (1.0 + within)
    return "run"


@pytest.mark.parametrize("cell", list(together(2)), ids=str)
def test_two_kinds_together(cell, record_property):
    record_property(KEY, judged(cell))


@pytest.mark.slow
@pytest.mark.parametrize("law", default_registry().names("contact_law"))
@pytest.mark.parametrize("excitation", default_registry().names("excitation"))
def test_three_kinds_together_and_all_that_rigid_bodies_have_to_run(excitation, law, record_property):
    cells = dict.fromkeys([*together(3), *(c for c in combinations() if c.bodies != "condensed" and has_to_run(c))])
    for cell in cells:
        if (cell.excitation, cell.law) == (excitation, law):
            record_property(KEY, judged(cell))


def test_elastic_rings_and_balls_on_rigid_seats_are_stiffer_by_some_percent():
    """5 to 8 % of the contacts' stiffness (physics.md, section 10); less where free tilts share the displacement."""
    for tilt in ("locked", "free"):
        rigid, condensed = (reference("bidirectional", tilt, bodies) for bodies in ("rigid", "condensed"))
        assert 1.01 < condensed.real / rigid.real < 1.10


def test_refusals_name_the_way_out():
    def reason(**changes):
        cell = Combination("bidirectional", "hertz", "resultant", "newmark", "fft_1x", "locked", "rigid")
        from attrs import evolve

        return str(outcome(evolve(cell, **changes)))

    assert "rigid bodies have no surface points: use 'resultant'" in reason(discretisation="nodal")
    assert "is required by elastic bodies" in reason(bodies="elastic", tilt="free")
    assert "use 'order_tracking'" in reason(excitation="run_up")
    assert "several speeds" in reason(excitation="run_up", identifier="impedance_fit")
    assert "does not repeat every turn at 7200 r/min" in reason(excitation="measured", identifier="impedance_fit")
