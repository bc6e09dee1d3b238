"""Pressures at surface points.

Resultants and points of the same bodies are two methods: what they share are the compliances.
"""

from functools import cache

import attrs
import numpy as np
import pytest

from checks.validation.condensed import largest, quantities, tables
from raceway import scene_from_dict
from raceway.testing import run, settled

pytestmark = pytest.mark.night

#: Displacements [um, mrad], ball loads [N] and peak pressures [MPa], tangents of stiffness; 1000 N axial and 500 N on a ball.
PROTOTYPE = {
    "locked": {
        "x": 28.837, "y": 1.972, "most": 350.3, "least": 174.7, "inner": 1656.0, "outer": 1383.0,
        "kxx": 65.52, "kyy": 256.0, "kzz": 257.3, "k tilt_y": 17.61, "k tilt_z": 17.67,
    },
    "free": {
        "x": 27.064, "y": 13.701, "tilt_z": 1.5465, "most": 398.6, "least": 214.2, "inner": 1736.0, "outer": 1443.0,
        "kxx": 66.08, "kyy": 269.6, "kzz": 256.2,
    },
}  # fmt: skip
SEPARATE = "a separate program with incompatible elements, 8 points per semi-axis"
OWN = {"basis": "own other method"}


@cache
def solved(tilt, points):
    return settled(tables(tilt, points))


def held_poles(model, found):
    """Diagonal of the mean tangent in which no contact feels the load on the ball's other pole: contacts two by two in series."""
    system = model.system
    system.evaluate(found.displacement, ball=found.ball)
    row = system.pool.row(system.table)
    stiff = [contact.mean_stiffness(seen) for contact, seen in zip(row.balls.contacts, row.last.relative, strict=True)]
    z = system.ball_count
    both = np.zeros((2 * z, 2 * z))
    for k, (inner, outer) in enumerate(zip(stiff[:z], stiff[z:], strict=True)):
        both[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = inner - inner @ np.linalg.solve(inner + outer, inner)
    jacobian = system._groove(found.displacement, np.zeros(5), 0.0)[1]
    return attrs.evolve(found, stiffness=jacobian.T @ both @ jacobian)


@pytest.mark.parametrize("tilt", PROTOTYPE)
def test_separate_program(claim, tilt):
    model, found = solved(tilt, 8)
    loads, columns = found.contact_force[: model.system.ball_count], model.bearing.ball_columns(model, found)
    pressures = {race: 1e-6 * columns[f"peak_pressure_nodal_{race}_pa"].max() for race in ("inner", "outer")}
    ours = {**quantities(found), "most": loads.max(), "least": loads.min(), **pressures}
    wanted = PROTOTYPE[tilt]
    stiff = {name: value for name, value in wanted.items() if name.startswith("k")}
    word, bounds = f"bearing, tilt {tilt}, 8 points: largest relative error of", {"at_most": 0.01, **OWN}
    others = {name: value for name, value in wanted.items() if name not in stiff}
    claim(f"{word} displacements, ball loads, pressures", largest(ours, others), **bounds, source=SEPARATE)
    source = f"{SEPARATE}; as there, with the load on a ball's other pole held"
    claim(f"{word} stiffness", largest(quantities(held_poles(model, found)), stiff), **bounds, source=source)


def test_difference_quotients(claim):
    """Equilibria under loads that differ by 3 % of the axial one: what the forces say, with no tangent in it."""
    model, found = solved("locked", 8)
    part, columns = 30.0, []
    for way in np.eye(5)[:3]:
        ends = [
            attrs.evolve(model.system, load=model.system.load + sign * part * way).solve_equilibrium(
                found.displacement, found.ball
            )[0]
            for sign in (1.0, -1.0)
        ]
        columns.append((ends[0] - ends[1])[:3] / (2.0 * part))
    quotients = np.diag(np.linalg.inv(np.array(columns).T))
    error = np.abs(np.diag(found.stiffness)[:3] / quotients - 1.0).max()
    source = "difference quotients of equilibria over 60 N; points that enter the contacts"
    claim("kxx, kyy, kzz, tilt locked, 8 points: largest relative error", error, at_most=0.005, **OWN, source=source)


@pytest.mark.parametrize(("word", "points"), [("resultants", None), ("4 points", 4)])
def test_eight_points(claim, word, points):
    moved, stiff, coupled = [], [], []
    for tilt, couplings in (("locked", [(0, 1)]), ("free", [(0, 1), (0, 4), (1, 4)])):
        one, two = (solved(tilt, count)[1] for count in (points, 8))
        chosen = np.abs(two.displacement) > 1e-9
        moved.append(np.abs(one.displacement[chosen] / two.displacement[chosen] - 1.0).max())
        stiff.append(np.abs(np.diag(one.stiffness) / np.diag(two.stiffness) - 1.0).max())
        coupled += [abs(one.stiffness[at] / two.stiffness[at] - 1.0) for at in couplings]
    quantity, source = f"{word} against 8 points, tilt locked and free: largest difference of", "own 8 points per semi-axis"
    claim(f"{quantity} displacements", max(moved), at_most=0.01, **OWN, source=source)
    claim(f"{quantity} diagonal stiffness", max(stiff), at_most=0.01, **OWN, source=source)
    source += "; couplings are a tenth of the diagonal, and ripple by 20 % at one place of 4 points"
    claim(f"{quantity} couplings", max(coupled), at_most=0.05, **OWN, source=source)


@pytest.mark.parametrize("force", [200.0, 600.0])
def test_friction_of_a_bearing(claim, force):
    """A force that rotates: points that slip one by one, and contacts that slip all at once."""
    pairs = []
    for points in (4, None):
        given = tables(points=points, load={"axial": 1000.0}, rotor={"mass": 2.0})
        given["contact"] = {**given.get("contact", {}), "friction": 0.03}
        given["excitation"] = {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": force}
        given["integrator"] = {"kind": "quasi_static", "turns": 3, "steps_per_turn": 48}
        found = run(scene_from_dict(given)).to_dict()["identification"]
        pairs.append((found["equivalent_stiffness"], found["equivalent_damping"]))
    stiffness, damping = np.divide(*pairs)
    quantity, bounds = f"rotating {force:g} N on 1 kN, friction 0.03, 4 points over resultants", {"near": 1.0, **OWN}
    source = "slip of Mindlin's annulus; friction is 3 % of a load"
    claim(f"{quantity}: stiffness", stiffness, within=0.05, **bounds, source=source)
    why = "a resultant has Mindlin's first stiffness until it slides, points give half as much again before they do"
    source = "all contacts slide: the same mu Q over the same way"
    claim(f"{quantity}: damping", damping, within=0.15, **bounds, source=source, misses=why if force == 200.0 else "")
