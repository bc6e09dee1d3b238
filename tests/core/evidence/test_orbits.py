"""Periodic orbits and branches."""

import time

import numpy as np
import pytest

import raceway as rw
from checks.validation import several
from checks.validation.crossed import compared, crossed
from checks.validation.reference.ring import Ring
from checks.validation.reference.shooting import periodic as shooting
from checks.validation.reference.shooting import rotating as turning
from checks.validation.reference.shooting import swinging
from checks.validation.scenes import built_in, rig_force, rotating
from raceway.core.periodic.refinement import displacements, states
from raceway.core.periodic.special_points import FOLD, PAIR
from raceway.extend import Motion, Schedule, integrate, stiffness
from raceway.testing import model_of, ring_inertia, run, simulate, solve_equilibrium
from tests.core.validation import followed

Newmark = built_in("integrator", "newmark")
pytestmark = pytest.mark.night

ONE_WAY = {"kind": "unidirectional"}
#: Distance of two answers over their stated errors: less than the 4 by which twice as many steps change an error.
FACTOR = 3.0


def scene(axial=1000.0, tilt="locked", rpm=12000.0, inertia=False, **tables):
    """The article's bearing with its rotating force, solved for directly, changed."""
    found = rotating(axial, tilt, rpm, inertia, "periodic")
    for table, changes in tables.items():
        found[table] = {**found.get(table, {}), **changes}
    return found


def solved(tables, **integrator):
    return run(rw.scene_from_dict({**tables, "integrator": integrator or tables["integrator"]}))


def ramped(tables, turns, steps):
    """By Newmark's method, with a C2 ramp over two thirds of the turns."""
    return solved(tables, kind="newmark", turns=turns, steps_per_turn=steps, start="ramp")


def z_of(result) -> complex:
    return result.identification.dynamic_stiffness


def test_against_transients(claim):
    scenes = (
        scene(), scene(tilt="free", inertia=True), scene(excitation=ONE_WAY), scene(200.0), scene(bodies={"kind": "condensed"})
    )  # fmt: skip
    errors = [abs(z_of(solved(tables)) / z_of(ramped(tables, 400, 1440)) - 1.0) for tables in scenes]
    quantity = "Z, tilt locked and free, force of one direction, lift-off, condensed bodies: largest relative difference"
    claim(
        quantity, max(errors), at_most=1e-6, basis="own other method", source="400 turns of 1440 Newmark steps; (w h)^2 / 6"
    )


def least_ms(tables, repeats):
    """From the equilibrium to the recorded motion, the start on the orbit included; the first call may compile."""
    model = model_of(tables)
    equilibrium, spent = solve_equilibrium(model), []
    for _ in range(repeats + 1):
        begun = time.process_time_ns()
        simulate(model, equilibrium)
        spent.append((time.process_time_ns() - begun) * 1e-6)
    return min(spent[1:])


def test_cost(claim):
    """In turns, because what else the machine does slows down short work more than long."""
    ratios = []
    for tilt in ("locked", "free"):
        for inertia in (False, True):
            tables = scene(tilt=tilt, inertia=inertia)
            by_time = {**tables, "integrator": {"kind": "newmark", "turns": 12}}
            both = [(least_ms(tables, 60), least_ms(by_time, 10)) for _ in range(5)]
            direct, newmark = (min(times) for times in zip(*both, strict=True))
            ratios.append(direct / newmark)
    claim(
        "processor time over that of 12 turns of 360 Newmark steps, tilt locked and free, with and without ball inertia: largest",
        max(ratios),
        at_most=0.1,
        basis="regression",
        source="an order of magnitude",
        misses="a transient starts on the orbit too, and with the tilt free the search for it is most of either time",
        machine=True,
    )


def farthest(floquet, wanted) -> float:
    """Largest distance of a multiplier from the nearest one that is wanted, either way."""
    own = np.array([complex(one["real"], one["imag"]) for one in floquet["multipliers"]])
    off = np.abs(own[:, None] - wanted[None, :])
    return float(max(off.min(axis=0).max(), off.min(axis=1).max()))


def monodromy(tables, result):
    model = model_of(tables)
    system, w, damping = model.system, 12000.0 * np.pi / 30.0, tables["contact"]["damping"]
    _, _, polar = ring_inertia(model.scene.bearing)
    ring = Ring(9.525e-3, 46e-3, 12, np.radians(15.0), 0.522, 0.522, damping=damping, spin=polar * w)
    force = (swinging if tables["excitation"]["kind"] == "unidirectional" else turning)(rig_force(12000.0), w)
    record = result.simulation.record
    q, v = record.displacement[-1].copy(), record.velocity[-1].copy()
    q[system.free == 0.0] = solve_equilibrium(model).displacement[system.free == 0.0]
    return shooting(ring, system.mass, system.load, force, system.free, 2.0 * np.pi / w, q, v)[2]


def test_multipliers(claim):
    errors, undamped = [], {"damping": 0.0}
    for tables in (
        scene(400.0, contact=undamped), scene(400.0, excitation=ONE_WAY, contact=undamped), scene(tilt="free", contact=undamped)
    ):  # fmt: skip
        result = solved(tables, kind="periodic", tolerance=1e-9)
        errors.append(farthest(result.stability["floquet"], monodromy(tables, result)))
    quantity = "Floquet multipliers, 400 N, 1000 N with the tilt free, both kinds of force: largest distance"
    source = "DOP853 with its variational equations on the reference's own equations"
    claim(quantity, max(errors), at_most=1e-6, basis="own other method", source=source)
    tables = scene(contact={"damping": 20.0})
    result = solved(tables, kind="periodic", tolerance=1e-9)
    own = np.sort([one["abs"] for one in result.stability["floquet"]["multipliers"]])
    error = np.abs(np.log(own) / np.log(np.sort(np.abs(monodromy(tables, result)))) - 1.0).max()
    source = (
        "the same; rates of the balls are not varied: off by the difference of the races' compliances over their sum, 2 %"
    )
    quantity = "decay of disturbances, contacts with 20 N s/m: largest relative difference"
    claim(quantity, error, at_most=0.05, basis="own other method", source=source)


def test_motion_that_is_taken(claim):
    apart, growth, error = [], [], []
    for damping, of in (
        (5000.0, lambda **own: several.heavy(82.0, **own)),
        (0.0, lambda **own: several.heavy(82.0, 0.0, **own)),
        (0.0, lambda **own: several.article(1000.0, **own)),
    ):
        direct, by_time = (run(rw.scene_from_dict(tables)) for tables in (of(kind="periodic", tolerance=1e-9), of()))
        wanted, multiplier, _ = several.by_integration(direct, damping)
        apart.append(abs(z_of(direct) / wanted - 1.0))
        growth.append(multiplier)
        error.append(abs(z_of(by_time) / z_of(direct) - 1.0) / by_time.error["total"])
    where = "82 kg near resonance with and without damping, the article's ring with its tilt free"
    source = "a turn by DOP853 on the reference's own equations"
    claim(f"{where}: Z, largest relative difference", max(apart), at_most=1e-6, basis="own other method", source=source)
    quantity = f"{where}: growth of disturbances per turn, largest"
    claim(quantity, max(growth), at_most=1.0 + 1e-5, basis="own other method", source=f"{source}: a motion that lasts")
    quantity = f"{where}: error of `newmark` over the stated one, largest"
    claim(quantity, max(error), at_most=FACTOR, basis="own other method", source="direct solution, which the turn confirms")


def test_random_scenes_by_two_integrators(claim):
    """With friction both runs of a scene begin differently."""
    count = 700
    for first, second in map(crossed, range(60)):
        rubs = first["contact"]["friction"] > 0.0
        assert not rubs or first["integrator"]["start"] != second["integrator"]["start"]
    pairs = [pair for pair in map(compared, range(count)) if pair is not None]
    quantity = f"{count} random scenes, each by two integrators: share of pairs that run and state an error"
    source = "one in ten may stick, or have no steady motion"
    claim(quantity, len(pairs) / count, at_least=0.9, basis="regression", source=source)
    for words, rubs, share in (
        ("without friction", False, 0.99), ("with friction 0.03 to 0.3 from different starts", True, 0.95)
    ):  # fmt: skip
        judged = [(distance, told) for friction, distance, told in pairs if (friction > 0.0) == rubs]
        good = sum(distance <= FACTOR or told for distance, told in judged)
        quantity = (
            f"share of pairs {words}: apart by at most {FACTOR:g} times their stated errors, or several motions reported"
        )
        source = f"{len(judged)} scenes; the other integrator"
        claim(quantity, good / len(judged), at_least=share, basis="own other method", source=source)


def test_curve_over_speed(claim):
    """B7206C, 400 N, tilt free, 40 N along one direction, rotor.damping 200 N s/m, 500 to 30 000 r/min."""
    curve, spent = rw.follow(followed.SCENE, followed.OVER), []
    for _ in range(3):
        begun = time.process_time()
        curve = rw.follow(followed.SCENE, followed.OVER)
        spent.append(time.process_time() - begun)
    kinds = [label.kind for label in curve.labels]
    assert len(curve.rows) >= 200 and curve.end == "" and len(curve.unstable) == 3 and kinds.count(FOLD) == 2
    source = "while one waits"
    claim("processor time of a curve of 200 orbits", min(spent), at_most=5.0, unit="s", basis="regression", source=source)
    fold = next(label.point for label in curve.labels if label.kind == FOLD)
    pairs = [label.point for label in curve.labels if label.kind == PAIR and label.point is not None]
    balance, turn, flow = [], [], []
    for point in [*followed.beside(fold), *pairs]:
        z, own = followed.z_of(point), point.floquet.multipliers
        balance.append(abs(followed.by_harmonic_balance(point) / z - 1.0))
        by_turn, multipliers, _ = followed.by_integration(point)
        turn.append(abs(by_turn / z - 1.0))
        flow.append(max(float(np.abs(own - multiplier).min()) for multiplier in multipliers))
    where = "orbits on either side of a fold and at Neimark-Sacker points, unstable ones too"
    for what, errors, limit, source in (
        ("Z, largest relative difference", balance, 1e-4, "24 harmonics of the reference ring"),
        ("Z, largest relative difference", turn, 1e-6, "a turn of the reference ring by DOP853"),
        ("multipliers, largest distance", flow, 1e-5, "monodromy matrix of the reference ring"),
    ):
        claim(f"{where}: {what} from {source}", max(errors), at_most=limit, basis="own other method", source=source)
    upper = [label.point for label in curve.labels if label.kind == FOLD][1]
    upper = next(point for point in followed.beside(upper, 3) if point.floquet.verdict == "stable")
    errors = []
    for point, turns, rest in ((followed.on_the_way(12000.0), 1200, True), (upper, 2000, False)):
        coarse, fine = (transient(point, turns, steps, rest) for steps in (720, 1440))
        errors.append(abs((fine + (fine - coarse) / 3.0) / followed.z_of(point) - 1.0))
    quantity = "Z at 12 000 r/min from rest and between the folds from 5 % beside: largest relative difference"
    source = "1200 and 2000 turns of 720 and 1440 Newmark steps, extrapolated"
    claim(quantity, max(errors), at_most=1e-6, basis="own other method", source=source)


def transient(point, turns, steps, rest) -> complex:
    """Z of the last turn [N/m]."""
    problem = point.solved.problem
    system, w = problem.system, problem.speed
    q, v, _, ball, _ = (part[0] for part in states(point.solved, np.zeros(1)))
    mean = displacements(point.solved, 2.0 * np.pi * np.arange(64) / 64).mean(axis=0)
    q, v = (mean, np.zeros(5)) if rest else (mean + 1.05 * (q - mean), 1.05 * w * v)
    now = system.evaluate(q, v, ball=ball)
    start = Motion(q.copy(), v, system.acceleration(q, v, system.outer_force(0.0), now), now.ball, now.ball.copy())
    dt = 2.0 * np.pi / w / steps
    first = integrate(Newmark(), system, start, Schedule(dt, steps, turns - 1, steps))
    last = integrate(Newmark(), system, first.final, Schedule(dt, steps, 1, 1, first=steps * (turns - 1)))
    turned = 2.0 / steps * np.exp(-1j * w * last.time)
    return complex(stiffness(turned @ last.force, turned @ last.displacement))
