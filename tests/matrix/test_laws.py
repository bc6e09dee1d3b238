"""Laws that know the speed, reach beyond touching or depend on the rate, with every integrator and excitation.

Each is held against the same scene with Hertz' dry contacts: a film moves K of a bearing under an axial load by less than 1 %
(docs/film.md, sprung preload), dashpots that take a hundredth of the spring's force move it by 1e-4.  0.5 % for methods with
inertia and 3 % for a series of equilibria, as in ``test_matrix``, come on top.
"""

import json
import sys
from functools import cache
from pathlib import Path

import pytest

from raceway import SceneError, scene_from_dict
from raceway.testing import Registry, default_registry, run
from tests.matrix.combinations import crossed, options

PACKAGE = Path(__file__).parents[2] / "examples" / "third_party_law"
OIL = {"kind": "film", "oil": "VG 32", "temperature_c": 40.0}
DRY = "dry"
CONTACTS = {
    DRY: {"kind": "hertz"}, "film": OIL, "c = tau k": {"kind": "hertz", "time_constant": 2.5e-6},
    "film, c = tau k": {**OIL, "time_constant": 2.5e-6}, "hunt_crossley": {"kind": "hunt_crossley", "dissipation": 0.5},
    "hunt_crossley with memory": {"kind": "hunt_crossley", "restitution": 0.9},
}  # fmt: skip


@cache
def registry():
    """With the law of examples/third_party_law."""
    sys.path.insert(0, str(PACKAGE))
    try:
        import raceway_hunt_crossley as package
    finally:
        sys.path.remove(str(PACKAGE))
    found = Registry(third_party=False)
    found.add(package)
    return found


@cache
def outcome(contact, excitation, integrator, bodies="rigid", steps=120):
    """The run's result, or its refusal."""
    identifier = "order_tracking" if excitation == "run_up" else "fft_1x"
    implicit = default_registry().find("integrator", integrator).plugin.implicit
    # Films are renewed in every step of a run-up: a fifth of the example's half second, to the same speed.
    short = {"duration_s": 0.1} if excitation == "run_up" and "film" in contact else {}
    tables = {
        "bearing": {"preset": "B7206C"}, "load": {"axial": 2000.0}, "rotor": {"mass": 2.0}, "bodies": {"kind": bodies},
        "excitation": {"kind": excitation, **options("excitation", excitation), **short}, "contact": CONTACTS[contact],
        "integrator": {"kind": integrator, "turns": 6, "steps_per_turn": steps if implicit else "auto"},
        "identifier": {"kind": identifier, **options("identifier", identifier)},
    }  # fmt: skip
    try:
        return run(scene_from_dict(tables, registry()), registry())
    except SceneError as refused:
        return refused


@pytest.mark.parametrize("contact", [name for name in CONTACTS if name != DRY])
@pytest.mark.parametrize(("excitation", "integrator"), crossed())
def test_laws_with_speed_rate_and_reach(excitation, integrator, contact):
    method = default_registry().find("integrator", integrator).plugin
    found, dry = outcome(contact, excitation, integrator), outcome(DRY, excitation, integrator)
    if isinstance(found, SceneError):
        # What no law runs, and a law's memory, of which a steady motion knows nothing.
        assert isinstance(dry, SceneError) or ("memory" in contact and method.steady), str(found)
        return
    assert "NaN" not in json.dumps(found.to_dict(), allow_nan=False)
    near = 0.01 + (0.005 if method.inertial else 0.03)
    assert found.equivalent_stiffness == pytest.approx(dry.equivalent_stiffness, rel=near)
    if "film" in contact:
        assert found.to_dict()["equilibrium"]["balls"][0]["inner_film_central_m"] > 0.0
    if "tau" in contact and method.inertial:
        # c = tau k of springs, of which K is all but the inertia of balls and the turn of their forces: some percent.
        assert found.equivalent_damping == pytest.approx(2.5e-6 * found.equivalent_stiffness, rel=0.1)


@pytest.mark.parametrize("contact", ["film", "film, c = tau k", "hunt_crossley"])
def test_condensed_bodies_run_them(contact):
    found, dry = (outcome(one, "bidirectional", "newmark", "condensed") for one in (contact, DRY))
    assert found.equivalent_stiffness == pytest.approx(dry.equivalent_stiffness, rel=0.015)
    # Rings and balls on rigid seats change K by as much as they do under dry contacts.
    rigid, dry_rigid = (outcome(one, "bidirectional", "newmark") for one in (contact, DRY))
    assert found.equivalent_stiffness / dry.equivalent_stiffness == pytest.approx(
        rigid.equivalent_stiffness / dry_rigid.equivalent_stiffness, rel=2e-3
    )


@pytest.mark.parametrize("contact", ["film, c = tau k", "hunt_crossley", "hunt_crossley with memory"])
def test_the_estimated_error_is_that_of_z(contact):
    """Against steps sixteen times finer from the same kind of start: the estimate is an estimate, good to a factor of 3."""
    rough, fine = (outcome(contact, "bidirectional", "newmark", "rigid", steps) for steps in (60, 960))
    off = abs(rough.dynamic_stiffness / fine.dynamic_stiffness - 1.0)
    assert off / 3.0 < rough.error["total"] < 1e-2
