"""Pressures at surface points.

Resultants and points of the same bodies are two methods: what they share are the compliances.
"""

from __future__ import annotations

from functools import cache

import attrs
import numpy as np
import pytest

from checks.validation.condensed import largest, quantities, tables
from checks.validation.reference.mindlin import Mindlin
from checks.validation.single import single
from raceway import scene_from_dict
from raceway.core.fem.patches.friction import Friction
from raceway.testing import model_of, run, settled, simulate, solve_equilibrium

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
#: Coefficient and load [N] of the single contact.
MU, LOAD = 0.1, 300.0


@cache
def solved(tilt, points):
    return settled(tables(tilt, points))


def test_pressure_of_a_single_contact(claim):
    hertz, fine = {}, []
    for load in (100.0, 300.0, 1000.0):
        coarse, many = (case.peak(case.at_load(load)[1]) for case in (single(4, load), single(12, load)))
        hertz[load] = abs(coarse / float(single(4, load).ellipse.peak_pressure(load)) - 1.0)
        fine.append(abs(coarse / many - 1.0))
    quantity, source = "single contact, 4 points per semi-axis, peak pressure: largest relative error", "Hertz"
    claim(f"{quantity}, 100 and 300 N", max(hertz[100.0], hertz[300.0]), at_most=0.01, basis="closed form", source=source)
    source = "Hertz; the groove's torus is no paraboloid: 12 points give 1.5 % more"
    claim(f"{quantity}, 1000 N", hertz[1000.0], at_most=0.015, basis="closed form", source=source)
    claim(f"{quantity}, 100 to 1000 N", max(fine), at_most=0.005, **OWN, source="12 points")


def test_structural_compliance_of_a_single_contact(claim):
    case = single(8, 300.0, room=1.9)
    rest = [1e9 * (case.at_load(load)[0] - float(case.ellipse.approach(load))) / load for load in (100.0, 300.0, 1000.0)]
    quantity = "single contact, (approach - Hertz's) / load at 100, 300 and 1000 N: spread"
    source = "a structural compliance does not depend on the load; 6 % of it"
    claim(quantity, max(rest) - min(rest), at_most=0.05, unit="nm/N", basis="closed form", source=source)


def test_friction_of_a_single_contact(claim):
    """8 points along a semi-axis, pressed by 300 N and pulled along the groove."""
    case = single(8, LOAD, shear=True)
    answer = case.at_load(LOAD)[1]
    a, b = (float(axis) for axis in case.ellipse.semi_axes(LOAD))
    mindlin = Mindlin(a, b, 212e9, 0.29, MU * float(answer.load.sum()))
    friction, none = Friction(case.patch, MU), np.zeros(case.patch.rows * case.patch.columns)

    def at_force(pull):
        low, high = 0.0, 4.0 * float(mindlin.displacement(0.999 * mindlin.limit))
        for _ in range(50):
            middle = 0.5 * (low + high)
            found = friction.pull(answer.nodes, answer.load, middle, none)
            low, high = (middle, high) if found.force < pull else (low, middle)
        return middle, found

    moved, sticks, rest = [], [], []
    for share in (0.25, 0.5, 0.75, 0.9):
        pull = share * mindlin.limit
        (displacement, found), closed = at_force(pull), float(mindlin.displacement(pull))
        moved.append(abs(displacement / closed - 1.0))
        rest.append(1e9 * (displacement - closed) / pull)
        sticks.append(abs(float((found.sliding == 0).mean()) / mindlin.stick_share(pull) - 1.0))
    word, source = "single contact, 300 N, pulled by 0.25 to 0.9 mu Q", "Mindlin (1949), Cattaneo (1938)"
    claim(
        f"{word}: displacement: largest relative error", max(moved), at_most=0.03, basis="closed form",
        source=f"{source}; finite bodies",
    )  # fmt: skip
    claim(
        f"{word}: share of points that stick: largest relative error", max(sticks), at_most=0.1, basis="closed form",
        source=f"{source}; half a row of points around the ellipse",
    )  # fmt: skip
    claim(
        f"{word}: (displacement - Mindlin's) / pull: spread", max(rest) - min(rest), at_most=0.3, unit="nm/N", basis="closed form",
        source="a structural compliance does not depend on the pull; 2 % of Mindlin's 14 nm/N",
    )  # fmt: skip
    slides = friction.pull(answer.nodes, answer.load, 3e-6, none).force / mindlin.limit
    claim(
        "single contact pulled further: force over mu Q",
        slides,
        near=1.0,
        within=1e-9,
        basis="closed form",
        source="Coulomb",
    )
    end, first = at_force(0.75 * mindlin.limit)
    slip, lost = first.slip, 0.0
    for place in np.concatenate([np.linspace(end, -end, 80)[1:], np.linspace(-end, end, 80)[1:]]):
        found = friction.pull(answer.nodes, answer.load, place, slip)
        slip, lost = found.slip, lost + found.lost
    quantity, loop = (
        "single contact, cycle of +-0.75 mu Q: energy lost over Mindlin's loop",
        mindlin.loop(0.75 * mindlin.limit),
    )
    claim(quantity, lost / loop, near=1.0, within=0.03, basis="closed form", source=f"{source}; 160 steps of a cycle")


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
    claim(
        f"{quantity}: stiffness",
        stiffness,
        within=0.05,
        **bounds,
        source="slip of Mindlin's annulus; friction is 3 % of a load",
    )
    why = "a resultant has Mindlin's first stiffness until it slides, points give half as much again before they do"
    source = "all contacts slide: the same mu Q over the same way"
    claim(f"{quantity}: damping", damping, within=0.15, **bounds, source=source, misses=why if force == 200.0 else "")


def test_gyroscopic_moments(claim):
    apart = []
    for rpm in (15000.0, 40000.0):
        more = {
            "load": {"axial": 1000.0, "radial": [300.0, 0.0]},
            "kinematics": {"gyroscopic": "shared", "spin_speed_rpm": rpm},
        }
        one, two = (quantities(settled(tables("free", points, **more))[1]) for points in (4, None))
        apart.append(largest(one, {name: value for name, value in two.items() if not name.startswith("k")}))
    quantity = "gyroscopic moments at 15 000 and 40 000 r/min, 4 points: displacements: largest difference"
    source = "resultants of the same bodies: 1 % without moments, and half of that for them"
    claim(quantity, max(apart), at_most=0.015, **OWN, source=source)


def dynamic_stiffness(model):
    equilibrium = solve_equilibrium(model)
    motion = simulate(model, equilibrium, lambda what, done, total: None)
    return float(model.scene.identifier.method.identify([motion.record], equilibrium, model).equivalent_stiffness)


@pytest.mark.parametrize(("rpm", "within"), [(12000.0, 2e-5), (50000.0, 2e-3)])
def test_inertia_of_balls(claim, rpm, within):
    """Dynamic stiffness with and without the balls' mass against K_ee - K_ep (K_pp - m w^2)^-1 K_pe of the tangents at rest."""
    given = tables(points=3, load={"axial": 1000.0}, rotor={"mass": 2.0}, kinematics={})
    given["contact"]["damping"] = 0.0
    given["excitation"] = {"kind": "bidirectional", "speed_rpm": rpm, "amplitude": "constant", "force": 200.0}
    given["integrator"] = {"kind": "newmark", "turns": 4, "steps_per_turn": 90}
    stiffness = []
    for factor in (1.0, 0.0):
        model = model_of(given)
        stiffness.append(
            dynamic_stiffness(
                attrs.evolve(model, system=attrs.evolve(model.system, ball_mass=factor * model.system.ball_mass))
            )
        )
    model, rest = settled(given)
    system = model.system
    system.evaluate(rest.displacement, ball=rest.ball)
    row, jacobian = system.pool.row(system.table), system._groove(rest.displacement, np.zeros(5), 0.0)[1]
    still = row.balls.smoothed_stiffness(row.last, row.centre, row.where)
    mass = system.ball_mass * (2.0 * np.pi * rpm / 60.0) ** 2 * np.eye(len(still.ball_stiffness))
    moving = attrs.evolve(still, ball_stiffness=still.ball_stiffness - mass)
    without, having = ((jacobian.T @ row.balls.tangent(one) @ jacobian)[1, 1] for one in (still, moving))
    error = abs(stiffness[0] / stiffness[1] - having / without)
    quantity = f"relative change of the dynamic stiffness by the mass of the balls, {rpm:g} r/min: error"
    source = f"linear theory with tangents at rest, change {having / without - 1.0:.2g}; points ripple by some percent"
    claim(quantity, error, at_most=within, **OWN, source=source)
