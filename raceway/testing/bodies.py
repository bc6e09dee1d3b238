"""The conformance suite of kinds of bodies."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Bearing, Model
from raceway.core.schemes.drivers import integrate
from raceway.core.stepping.record import Schedule
from raceway.errors import Mistake, RacewayError, SceneError
from raceway.framework.contracts import Cost, Traits
from raceway.framework.registry import Registry
from raceway.integrators.central_difference import CentralDifference
from raceway.integrators.newmark import Newmark
from raceway.integrators.quasi_static import QuasiStatic
from raceway.pipeline.result import without_nan
from raceway.pipeline.run import run
from raceway.planning.decisions import decide_balls, decide_motion, decide_tilts
from raceway.planning.parts import Decisions
from raceway.planning.plan import make_plan
from raceway.scene.scene import Scene
from raceway.testing.asked import OTHERS, PLAIN
from raceway.testing.bearings import is_key, registry_with, scene_of, settled, unbalanced
from raceway.testing.drivers import FromPython, has_both
from raceway.testing.suite import ConformityError, Suite, duty, require

if TYPE_CHECKING:
    from raceway.framework.contracts import BodiesKind

#: Part of the loads that an equilibrium may leave: compiled ones leave 1e-11, finite elements are iterated to 1e-7.
_BALANCE = 1e-6
#: Load that is added for a difference, over the loads: its own curvature leaves 1e-6, an iteration's residual 1e-4.
_MORE, _TANGENT = 1e-3, 1e-3
#: Contact angles of bodies that deform are those of their rigid planes.
_ANGLES = 0.02
#: Steps of the explicit limit that each method takes, over it.
_STEPS, _OF_LIMIT = 12, 0.1


@contextmanager
def _nothing_built() -> Iterator[None]:
    """No bearing comes into being."""

    def refuse(cls: type, *_args: object, **_keys: object) -> None:
        require(False, f"builds a {cls.__name__}: that is for build() alone")

    Bearing.__new__ = refuse  # type: ignore[assignment, method-assign]
    try:
        yield
    finally:
        del Bearing.__new__


def _refusal(scene: Scene) -> SceneError | None:
    """What the plan says of a scene; None where it takes it."""
    try:
        make_plan(scene)
    except SceneError as refused:
        return refused
    return None


class BodiesSuite(Suite):
    """Duties of ``raceway.framework.contracts.BodiesKind``."""

    kind = "bodies"

    @duty("faults(scene): a list of Mistakes with a key and a remedy, none for its example; nothing is built")
    def test_faults(self, bodies: BodiesKind) -> str:
        registry, refused = registry_with(bodies), []
        with _nothing_built():
            for word, changes in {"its example": {}, **{word: one.changes for word, one in OTHERS.items()}}.items():
                scene = scene_of(bodies, changes, registry)
                found = bodies.faults(scene)
                require(isinstance(found, list), f"{word}: faults() returns {type(found).__name__}, not a list")
                for one in found:
                    require(isinstance(one, Mistake), f"{word}: faults() holds {one!r}, which is no Mistake")
                    require(is_key(scene, one.path), f"{word}: `{one.path}` is no key of a scene")
                    require(len(one.message) > 20, f"{word}: '{one.message}' names no reason and no remedy")
                require(changes or not found, f"its example is refused: {'; '.join(map(str, found))}")
                refused += [word] if found else []
        return f"refused: {', '.join(refused) or 'nothing'}"

    @duty(
        "traits, stable_step, decide, unused, cost: as the contract types them, finite, of keys that exist; nothing is built"
    )
    def test_plan(self, bodies: BodiesKind) -> None:
        scene = scene_of(bodies)
        with _nothing_built():
            traits, limit, parts = bodies.traits(scene), bodies.stable_step(scene), Decisions()
            require(isinstance(traits, Traits), f"traits() returns {type(traits).__name__}, not Traits")
            require(all(type(one) is bool for one in attrs.astuple(traits)), f"{traits} holds more than True and False")
            require(limit is None or 0.0 < limit < np.inf, f"stable_step() = {limit!r} is neither None nor a time [s]")
            balls = decide_balls(scene, parts)
            motion = decide_motion(scene, parts, decide_tilts(scene, parts), balls.friction)
            decide: Callable[..., object] = bodies.decide
            require(decide(scene, parts) is None, "decide() returns something: parts are kept or left out")
            for one in (*parts.kept, *parts.left_out):
                good = all(isinstance(word, str) and word for word in (one.part, one.why))
                require(good, f"{one} needs a name and a reason in words")
            names = [one.part for one in (*parts.kept, *parts.left_out)]
            twice = sorted({name for name in names if names.count(name) > 1})
            require(not twice, f"{', '.join(twice)} is decided twice")
            for path, why in bodies.unused(scene):
                require(is_key(scene, path) and why, f"unused() names `{path}`, which is no key, or gives no reason")
            cost = bodies.cost(scene, balls, motion, parts)
        require(isinstance(cost, Cost), f"cost() returns {type(cost).__name__}, not Cost")
        require(0.0 < cost.seconds < np.inf, f"cost().seconds = {cost.seconds} is no time")
        require(0.0 <= cost.once <= cost.seconds, f"cost().once = {cost.once} s is no part of {cost.seconds} s")
        require(cost.unknowns is None or cost.unknowns > 0, f"cost().unknowns = {cost.unknowns}")

    @duty("build(scene, plan): a Bearing with a system and a first guess (5,)")
    def test_build(self, bodies: BodiesKind) -> None:
        scene = scene_of(bodies)
        bearing = bodies.build(scene, make_plan(scene))
        require(
            isinstance(bearing, Bearing), f"build() returns {type(bearing).__name__}, not a raceway.bodies.model.Bearing"
        )
        require(np.shape(bearing.guess) == (5,), f"`guess` has the shape {np.shape(bearing.guess)}, not (5,)")
        z = scene.bearing.balls_in_all
        require(bearing.system.ball_count == z, f"the system has {bearing.system.ball_count} balls, the scene {z}")
        require(
            bearing.basis.azimuth.shape == (z,), f"`basis.azimuth` has the shape {bearing.basis.azimuth.shape}, not ({z},)"
        )
        require(bearing.largest_motion > 0.0, f"`largest_motion` = {bearing.largest_motion} m")

    @duty("the equilibrium balances the loads")
    def test_equilibrium(self, bodies: BodiesKind) -> str:
        model, found = settled(scene_of(bodies))
        left = unbalanced(model, found.displacement, found.ball)
        require(left < _BALANCE, f"{left:.2g} of the loads is left")
        require(found.iterations >= 0, f"{found.iterations} iterations")
        return f"{left:.1e} of the loads is left"

    @duty("the tangent is the derivative of the force by the displacement, symmetric where forces have a potential")
    def test_tangent(self, bodies: BodiesKind) -> str:
        model, found = settled(scene_of(bodies))
        system, free = model.system, np.flatnonzero(model.system.free > 0.0)
        size = np.array([1.0, 1.0, 1.0, system.arm, system.arm]) * _MORE * max(np.abs(system.load).max(), 1.0)
        K = system.reduced(found.stiffness + system.stiffness)
        worst = 0.0
        for k, at in enumerate(free):
            ends = []
            for sign in (1.0, -1.0):
                load = system.load + sign * size[at] * np.eye(5)[at]
                ends.append(attrs.evolve(system, load=load).settle(found.displacement)[0][free])
            moved = K @ (ends[0] - ends[1]) / (2.0 * size[at])
            worst = max(worst, float(np.abs((moved - np.eye(len(free))[k]) * size[free] / size[at]).max()))
        require(worst < _TANGENT, f"K dq differs by {worst:.2g} of the load that moves the ring by dq")
        if not system.conservative:
            return f"{worst:.1e}; no potential"
        scale = np.sqrt(np.abs(np.diag(K)))
        skew = float(np.abs((K - K.T) / np.outer(scale, scale)).max())
        require(skew < _BALANCE, f"the forces have a potential, but K - K^T is {skew:.2g} of K")
        return f"differences {worst:.1e}, K - K^T {skew:.1e}"

    @duty(
        "contact forces (2 Z,) and gaps: never negative, none in an open contact; with their angles they balance the loads"
    )
    def test_contacts(self, bodies: BodiesKind) -> str:
        model, found = settled(scene_of(bodies))
        z, force, gap = model.system.ball_count, found.contact_force, found.gap
        for word, values in (("contact_force", force), ("gap", gap)):
            require(np.shape(values) == (2 * z,), f"`{word}` has the shape {np.shape(values)}, not ({2 * z},)")
            require(np.isfinite(values).all(), f"`{word}` is not finite")
        require((force >= 0.0).all(), f"a contact pulls with {force.min():.3g} N")
        for word, angle, part in (("inner", found.angle_inner, force[:z]), ("outer", found.angle_outer, force[z:])):
            require(np.shape(angle) == (z,), f"the {word} angles have the shape {np.shape(angle)}, not ({z},)")
            require(
                (np.isnan(angle) == (part == 0.0)).all(), f"{word} angles are nan where a contact is open, and only there"
            )
        q, ball, forces = (np.repeat(each[None], 3, axis=0) for each in (found.displacement, found.ball, force))
        several = model.bearing.contact_angles(model, q, ball, forces, np.zeros(3))
        shapes = [np.shape(angle) for angle in several]
        require(shapes == [(3, z)] * 2, f"the angles of three states have the shapes {shapes}, not (3, {z})")
        over = np.shape(model.bearing.over_edges(model, *several, forces))
        require(over == (3,), f"over_edges() of three states has the shape {over}, not (3,)")
        return _carried(model, found)

    @duty("contact_ellipse, ball_columns, edge_warnings, report, warnings, mesh_error, contact_error: shapes and types")
    def test_told(self, bodies: BodiesKind) -> None:
        model, found = settled(scene_of(bodies))
        bearing, load = model.bearing, np.linspace(0.0, 2.0 * found.contact_force.max(), 7)
        for race in (0, 1):
            told = bearing.contact_ellipse(model, race, load)
            require(
                len(told) == 3 and all(np.shape(one) == (7,) for one in told), "contact_ellipse(): three arrays like `load`"
            )
            require(all(np.isfinite(one).all() and (np.diff(one) >= 0.0).all() for one in told), "contact_ellipse() falls")
            require(told[0][0] == 0.0 < told[0][1], "the peak pressure begins at 0 without a load, and grows")
        for name, column in bearing.ball_columns(model, found).items():
            shape = np.shape(column)
            require(shape == (model.system.ball_count,), f"ball_columns()['{name}'] has the shape {shape}, not (Z,)")
        json.dumps(without_nan(bearing.report(model, found)), allow_nan=False)
        edges = bearing.edge_warnings(model, found.angle_inner, found.angle_outer, found.contact_force)
        words = [*bearing.warnings(model, found), *edges]
        require(all(isinstance(one, str) and one for one in words), f"warnings are sentences, not {words!r}")
        for name in ("mesh_error", "contact_error"):
            answer = getattr(bearing, name)(model, found)
            good = isinstance(answer, tuple) and len(answer) == 2 and isinstance(answer[1], str) and bool(answer[1])
            require(good, f"{name}() returns {answer!r}, not (number or None, how it was found)")
            require(answer[0] is None or 0.0 <= answer[0] < np.inf, f"{name}() is {answer[0]!r}")

    @duty(
        "steps of newmark, central_difference and quasi_static; where forces are compiled, compiled and stepped drivers agree"
    )
    def test_steps(self, bodies: BodiesKind) -> str:
        model, found = settled(scene_of(bodies))
        system, compiled = model.system, model.traits.compiled
        schedule, worst = Schedule(_OF_LIMIT * system.critical_time_step(found.stiffness), _STEPS, 1), 0.0
        for method in (Newmark(), CentralDifference(), QuasiStatic()):
            begin = model.bearing.at_rest if method.inertial else model.bearing.at_equilibrium
            start = begin(system, found.displacement, found.ball, False)
            record = integrate(method, system, start, schedule)
            moved = record.displacement - found.displacement
            size = float(np.abs(moved).max())
            require(np.isfinite(moved).all() and size > 0.0, f"{method.name}: the ring does not move under the force")
            if compiled and has_both(method):
                other = integrate(FromPython(method), system, start, schedule)
                worst = max(worst, float(np.abs(other.displacement - record.displacement).max()) / size)
                # Both end their iterations at 1e-9 of all forces, of which the excitation is a small part.
                require(worst < 1e-5, f"{method.name}: drivers differ by {worst:.2g} of the motion")
        return f"drivers differ by {worst:.1e} of the motion" if compiled else "stepped"

    @duty("the same scene gives the same equilibrium to the last bit")
    def test_repeats(self, bodies: BodiesKind) -> None:
        one, two = (settled(scene_of(bodies))[1] for _ in range(2))
        for word in ("displacement", "stiffness", "contact_force"):
            require(np.array_equal(getattr(one, word), getattr(two, word)), f"`{word}` differs")

    @duty("what else a scene asks for is refused by the plan, or computed: nothing is left out in silence")
    def test_refused_or_computed(self, bodies: BodiesKind) -> str:
        registry, computed = registry_with(bodies), []
        plain = settled(scene_of(bodies, PLAIN, registry))[1].displacement
        for word, asked in OTHERS.items():
            scene = scene_of(bodies, asked.changes, registry)
            if _refusal(scene) is None and bodies.traits(scene).resultants:
                computed.append(word)
                self._computes(word, scene, plain)
        return f"computed: {', '.join(computed) or 'nothing'}"

    def _computes(self, word: str, scene: Scene, plain: np.ndarray) -> None:
        try:
            model, found = settled(scene)
        except RacewayError as why:
            raise ConformityError(f"{word}: neither refused by faults() nor computed: {why}") from why
        left = unbalanced(model, found.displacement, found.ball)
        require(left < _BALANCE, f"{word}: {left:.2g} of the loads is left")
        require(OTHERS[word].shows(model, found, plain), f"{word}: changes nothing: refuse it by faults()")

    @duty("a whole run ends with a stiffness, an error table and a result.json that names the kind")
    def test_run(self, bodies: BodiesKind) -> str:
        registry: Registry = registry_with(bodies)
        result = run(scene_of(bodies, registry=registry), registry)
        told = json.loads(json.dumps(result.to_dict(), allow_nan=False))
        require(told["scene"]["bodies"]["kind"] == bodies.name, "result.json names another kind of bodies")
        stiffness = told["identification"]["equivalent_stiffness"]
        require(stiffness is not None and stiffness > 0.0, f"the stiffness is {stiffness} N/m")
        return f"K = {stiffness:.4g} N/m"


def _carried(model: Model, found: Equilibrium) -> str:
    """Sum of the inner races' forces against the loads on the free translations."""
    z, azimuth = model.system.ball_count, model.azimuth
    load = np.where(found.contact_force[:z] > 0.0, found.contact_force[:z], 0.0)
    angle = np.nan_to_num(found.angle_inner)
    side = np.array([side for side, _ in model.scene.bearing.rows])[model.basis.row]
    radial = load * np.cos(angle)
    total = np.array([side @ (load * np.sin(angle)), radial @ np.cos(azimuth), radial @ np.sin(azimuth)])
    rest = (total - model.system.load[:3]) * model.system.free[:3]
    left = float(np.abs(rest).max() / load.sum())
    require(left < _ANGLES, f"with their angles the inner races' forces leave {left:.2g} of them unbalanced")
    return f"{left:.1e} of them is left"
