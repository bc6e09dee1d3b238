"""The conformance suite of kinds of bodies.

Bodies are built for their own ``example_scene()``, or for a ball bearing, and for that scene with more asked for (``_EXTRAS``): what
bodies do not compute, they must refuse.
"""

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import attrs
import numpy as np

from raceway.answers.quantities import K
from raceway.bodies.columns import Builder
from raceway.bodies.model import BuiltBearing, Equilibrium, Model
from raceway.core.record import Schedule
from raceway.core.ring.kernels.layout import CAGE
from raceway.core.time.schemes import integrate
from raceway.errors import Mistake, RacewayError, SceneError
from raceway.framework.contracts import BodiesKind, Cost, Traits
from raceway.framework.duties import gives_columns, unused_with_bodies
from raceway.framework.hookspecs import hookimpl
from raceway.framework.loading.registry import Registry
from raceway.integrators.methods import CentralDifference, Newmark, QuasiStatic
from raceway.pipeline.run import run
from raceway.planning.columns import why_not
from raceway.planning.parts import Decisions, decide_balls, decide_motion, decide_tilts
from raceway.planning.plan import make_plan
from raceway.planning.resolve import resolve
from raceway.scene.keys import with_number
from raceway.scene.scene import Scene, scene_from_dict
from raceway.scene.tables import PLUGIN_TABLES, TABLES
from raceway.storage.files import without_nan
from raceway.storage.tables import Tables
from raceway.testing.integrator import FromPython, has_both
from raceway.testing.suite import ConformityError, Suite, b7206c, check_shape, duty, require, settled

#: Part of the loads that an equilibrium may leave: compiled ones leave 1e-11, finite elements are iterated to 1e-7.
_BALANCE = 1e-6
#: Load that is added for a difference, over the loads: its own curvature leaves 1e-6, an iteration's residual 1e-4.
_MORE, _TANGENT = 1e-3, 1e-3
#: What two iterations that end at 1e-11 of the loads may be apart on soft coordinates.
_COLUMNS = 1e-7
#: Contact angles of bodies that deform are those of their rigid planes.
_ANGLES = 0.02
#: Steps of the explicit limit that each method takes, over it.
_STEPS, _OF_LIMIT = 12, 0.1
Changes = dict[str, Tables]  # keys by table
#: Model, equilibrium, and the displacement (5,) of the plain scene -> whether the bearing shows a change.
Shows = Callable[[Model, Equilibrium, np.ndarray], bool]

#: For kinds that give no scene of their own: 30 mm bore under a skew load and a turning force.
_USUAL: Tables = b7206c(
    title="conformance", load={"radial": [200.0, 0.0]}, kinematics={"ball_inertia": False},
    excitation={"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 1e-4},
    integrator={"kind": "newmark", "turns": 2, "steps_per_turn": 90},
)  # fmt: skip


def _moves(_model: Model, equilibrium: Equilibrium, plain: np.ndarray) -> bool:
    return not np.array_equal(equilibrium.displacement, plain)


def _has_no_potential(model: Model, _equilibrium: Equilibrium, _plain: np.ndarray) -> bool:
    return not model.system.conservative


def _is_damped(model: Model, equilibrium: Equilibrium, _plain: np.ndarray) -> bool:
    """Bodies that are stepped from Python may know rates in motion only."""
    q, ball = equilibrium.displacement, equilibrium.ball
    return not model.traits.compiled or bool(model.system.evaluate(q, ball=ball).damping.any())


def _passes(model: Model, equilibrium: Equilibrium, _plain: np.ndarray) -> bool:
    """Rolling elements are elsewhere a millisecond later."""
    q, ball = equilibrium.displacement, equilibrium.ball
    now, later = (model.system.evaluate(q, ball=ball, t=t).contact_force for t in (0.0, 1e-3))
    return not np.array_equal(now, later)


#: What a plain scene has none of.
PLAIN: Changes = {"kinematics": {"ball_inertia": False}}
#: What a scene may ask for beyond a plain one: changed keys, and how a bearing shows them.
_EXTRAS: dict[str, tuple[Changes, Shows]] = {
    "free tilts": (
        {"supports": {"tilt": "free"}, "rotor": {"mass": 1.0, "transverse_inertia": 1e-3}},
        lambda model, _equilibrium, _plain: bool(model.system.free[3:].all()),
    ),
    "a held axial displacement": (
        {"supports": {"axial": "displacement"}}, lambda model, _equilibrium, _plain: bool(model.system.free[0] == 0.0),
    ),
    "a pair of rows": (
        {"bearing": {"arrangement": "DB", "row_distance": 0.02}},
        lambda model, _equilibrium, _plain: model.system.ball_count == 2 * model.problem.bearing.ball_count,
    ),
    "an expanded inner ring": ({"kinematics": {"radial_expansion": 1e-6}}, _moves),
    "a soft seat": ({"supports": {"outer_seat": 1e13}}, _moves),
    "surface points": ({"contact": {"discretisation": "nodal"}}, _moves),
    "inertia of the balls": ({"kinematics": {"ball_inertia": True}}, _moves),
    "gyroscopic moments": ({"kinematics": {"ball_inertia": True, "gyroscopic": "outer_race"}}, _has_no_potential),
    "orbiting balls": ({"kinematics": {"orbiting": True}}, _passes),
    "friction": ({"contact": {"friction": 0.05}}, _has_no_potential),
    "damping of the contacts": ({"contact": {"damping": 100.0}}, _is_damped),
}  # fmt: skip


@attrs.frozen
class _Package:
    """A plug-in module with one kind of bodies."""

    kind: type

    @hookimpl
    def raceway_bodies(self) -> list[type]:
        return [self.kind]


def _registry_with(bodies: BodiesKind) -> Registry:
    """What is installed, what else the kind's own package brings, and the kind itself."""
    registry, cls = Registry(), type(bodies)
    # A package's own contact laws may be all that its bodies run with.
    for name in (cls.__module__.split(".")[0], cls.__module__):
        module = sys.modules.get(name)
        if any(word.startswith("raceway_") for word in vars(module or object)) and name != "raceway":
            registry.add(module)
    if ("bodies", cls.name) not in registry.entries:
        registry.add(_Package(cls))
    return registry


def _scene_of(bodies: BodiesKind, changes: Changes | None = None, registry: Registry | None = None) -> Scene:
    """The kind's ``example_scene()``, or the usual one, with these bodies; ``changes`` : keys by table."""
    registry = registry or _registry_with(bodies)
    example = getattr(type(bodies), "example_scene", lambda: _USUAL)()
    tables = {name: table for name, table in example.items() if name != "bodies"}
    for name, keys in (changes or {}).items():
        tables[name] = {**tables.get(name, {}), **keys}
    try:
        scene = scene_from_dict(tables, registry)
    except SceneError as why:
        raise ConformityError(f"example_scene() is no scene: {why}") from why
    return attrs.evolve(scene, bodies=bodies, source={**scene.source, "bodies": {"kind": bodies.name}})


def _is_key(scene: Scene, path: str) -> bool:
    """Whether a path names a key, or a table, of the scene."""
    table, _, key = path.partition(".")
    if table not in (*TABLES, *PLUGIN_TABLES):
        return False
    part = getattr(scene, table)
    if part is None or key in ("", "kind"):
        return True
    plugins = [getattr(part, f.name) for f in attrs.fields(type(part)) if "plugin" in f.metadata][:1]
    return key.partition(".")[0] in {f.name for e in (part, *plugins) if e is not None for f in attrs.fields(type(e))}


def _force_imbalance(model: Model, q: np.ndarray, ball: np.ndarray) -> float:
    """What is left of the loads on the free coordinates at a state (5,), (Z, k), over all forces."""
    system = model.system
    now = system.without(CAGE).evaluate(q, ball=ball)
    weight = np.array([1.0, 1.0, 1.0, 1.0 / system.arm, 1.0 / system.arm]) * system.free
    residual = now.force + system.stiffness @ q - system.load
    return float(np.abs(residual * weight).max() / (np.abs(now.contact_force).sum() + np.abs(system.load * weight).sum()))


@contextmanager
def _nothing_built() -> Iterator[None]:
    """No bearing comes into being."""

    def refuse(cls: type, *_args: object, **_keys: object) -> None:
        require(False, f"builds a {cls.__name__}: that is for build() alone")

    BuiltBearing.__new__ = refuse  # type: ignore[assignment, method-assign]
    try:
        yield
    finally:
        del BuiltBearing.__new__


class BodiesSuite(Suite):
    """Duties of ``raceway.framework.contracts.BodiesKind``."""

    kind = "bodies"

    @duty("faults(problem): a list of Mistakes with a key and a remedy, none for its example; nothing is built")
    def test_faults(self, bodies: BodiesKind) -> str:
        registry, refusals = _registry_with(bodies), []
        with _nothing_built():
            for word, changes in {"its example": {}, **{word: changes for word, (changes, _) in _EXTRAS.items()}}.items():
                scene = _scene_of(bodies, changes, registry)
                faults = bodies.faults(resolve(scene))
                require(isinstance(faults, list), f"{word}: faults() returns {type(faults).__name__}, not a list")
                for fault in faults:
                    require(isinstance(fault, Mistake), f"{word}: faults() holds {fault!r}, which is no Mistake")
                    require(_is_key(scene, fault.path), f"{word}: `{fault.path}` is no key of a scene")
                    require(len(fault.message) > 20, f"{word}: '{fault.message}' names no reason and no remedy")
                require(changes or not faults, f"its example is refused: {'; '.join(map(str, faults))}")
                refusals += [word] if faults else []
        return f"refused: {', '.join(refusals) or 'nothing'}"

    @duty("traits, stable_step, decide, unused, cost: as the contract types them, of keys that exist; nothing is built")
    def test_plan(self, bodies: BodiesKind) -> None:
        scene = _scene_of(bodies)
        problem = resolve(scene)
        with _nothing_built():
            traits, limit, parts = bodies.traits(problem), bodies.stable_step(problem), Decisions()
            require(isinstance(traits, Traits), f"traits() returns {type(traits).__name__}, not Traits")
            require(all(type(trait) is bool for trait in attrs.astuple(traits)), f"{traits} holds more than True and False")
            require(limit is None or 0.0 < limit < np.inf, f"stable_step() = {limit!r} is neither None nor a time [s]")
            balls = decide_balls(problem, parts)
            motion = decide_motion(problem, parts, decide_tilts(problem, parts), balls.friction)
            decide: Callable[..., object] = bodies.decide
            require(decide(problem, parts) is None, "decide() returns something: parts are included or left out")
            for part in (*parts.kept, *parts.left_out):
                good = all(isinstance(word, str) and word for word in (part.part, part.why))
                require(good, f"{part} needs a name and a reason in words")
            names = [part.part for part in (*parts.kept, *parts.left_out)]
            twice = sorted({name for name in names if names.count(name) > 1})
            require(not twice, f"{', '.join(twice)} is decided twice")
            for path, why in unused_with_bodies(scene):
                require(_is_key(scene, path) and why, f"unused() names `{path}`, which is no key, or gives no reason")
            cost = bodies.cost(problem, balls, motion, parts)
        require(isinstance(cost, Cost), f"cost() returns {type(cost).__name__}, not Cost")
        require(0.0 < cost.seconds < np.inf, f"cost().seconds = {cost.seconds} is no time")
        require(0.0 <= cost.once <= cost.seconds, f"cost().once = {cost.once} s is no part of {cost.seconds} s")
        require(cost.unknowns is None or cost.unknowns > 0, f"cost().unknowns = {cost.unknowns}")

    @duty("build(problem, plan): a BuiltBearing with a system and a first guess (5,)")
    def test_build(self, bodies: BodiesKind) -> None:
        scene = _scene_of(bodies)
        bearing = bodies.build(resolve(scene), make_plan(scene))
        kind = type(bearing).__name__
        require(isinstance(bearing, BuiltBearing), f"build() returns {kind}, not a raceway.extend.BuiltBearing")
        check_shape("`guess`", bearing.guess, (5,))
        z = scene.bearing.balls_in_all
        require(bearing.system.ball_count == z, f"the system has {bearing.system.ball_count} balls, the scene {z}")
        check_shape("`basis.azimuth`", bearing.basis.azimuth, (z,))
        require(bearing.largest_motion > 0.0, f"`largest_motion` = {bearing.largest_motion} m")

    @duty("the equilibrium balances the loads")
    def test_equilibrium(self, bodies: BodiesKind) -> str:
        model, equilibrium = settled(_scene_of(bodies))
        unbalance = _force_imbalance(model, equilibrium.displacement, equilibrium.ball)
        require(unbalance < _BALANCE, f"{unbalance:.2g} of the loads is left")
        require(equilibrium.iterations >= 0, f"{equilibrium.iterations} iterations")
        return f"{unbalance:.1e} of the loads is left"

    @duty("the tangent is the derivative of the force by the displacement, symmetric where forces have a potential")
    def test_tangent(self, bodies: BodiesKind) -> str:
        model, equilibrium = settled(_scene_of(bodies))
        system, free = model.system, np.flatnonzero(model.system.free > 0.0)
        size = np.array([1.0, 1.0, 1.0, system.arm, system.arm]) * _MORE * max(np.abs(system.load).max(), 1.0)
        K = system.reduced(equilibrium.stiffness + system.stiffness)
        worst = 0.0
        for k, at in enumerate(free):
            loads = (system.load + change * np.eye(5)[at] for change in (size[at], -size[at]))
            systems = (attrs.evolve(system, load=load) for load in loads)
            up, down = (moved.solve_equilibrium(equilibrium.displacement)[0][free] for moved in systems)
            response = K @ (up - down) / (2.0 * size[at])
            worst = max(worst, float(np.abs((response - np.eye(len(free))[k]) * size[free] / size[at]).max()))
        require(worst < _TANGENT, f"K dq differs by {worst:.2g} of the load that moves the ring by dq")
        if not system.conservative:
            return f"{worst:.1e}; no potential"
        scale = np.sqrt(np.abs(np.diag(K)))
        skew = float(np.abs((K - K.T) / np.outer(scale, scale)).max())
        require(skew < _BALANCE, f"the forces have a potential, but K - K^T is {skew:.2g} of K")
        return f"differences {worst:.1e}, K - K^T {skew:.1e}"

    @duty(
        "columns(problem, plan): at several points at once the equilibria are those of each alone",
        lambda bodies: "" if gives_columns(bodies) else "no columns",
    )
    def test_columns(self, bodies: BodiesKind) -> str:
        scene = _scene_of(bodies)
        if why := why_not(resolve(scene), False):
            return f"its example has none: {why}"
        loads = scene.load.radial[0] * np.array([1.0, 0.6, 1.3])
        bearing = Builder(make_plan(scene)).at({"load.radial[0]": loads})
        states, worst = bearing.equilibria(), 0.0
        for k, load in enumerate(loads.tolist()):
            model, alone = settled(with_number(scene, "load.radial[0]", load))
            require(states.status[k] == 0, f"no equilibrium under {load:g} N, where a run finds one")
            angles = bearing.contact_angles(states)
            for column, number in (
                (states.q[k], alone.displacement), (states.force[k], alone.contact_force),
                (angles[0][k], alone.angle_inner), (angles[1][k], alone.angle_outer),
            ):  # fmt: skip
                same = np.isnan(column) == np.isnan(number)
                off = np.nanmax(np.abs(column - number), initial=0.0) / np.nanmax(np.abs(number), initial=1e-300)
                require(same.all(), f"under {load:g} N other contacts are open")
                worst = max(worst, float(off))
        require(worst < _COLUMNS, f"columns differ by {worst:.2g} from single points")
        return f"{worst:.1e} from single points"

    @duty("contact forces (2 Z,) and gaps: never negative, none where open; with their angles they balance the loads")
    def test_contacts(self, bodies: BodiesKind) -> str:
        model, equilibrium = settled(_scene_of(bodies))
        z, force, gap = model.system.ball_count, equilibrium.contact_force, equilibrium.gap
        for word, values in (("contact_force", force), ("gap", gap)):
            check_shape(f"`{word}`", values, (2 * z,))
            require(np.isfinite(values).all(), f"`{word}` is not finite")
        require((force >= 0.0).all(), f"a contact pulls with {force.min():.3g} N")
        races = (("inner", equilibrium.angle_inner, force[:z]), ("outer", equilibrium.angle_outer, force[z:]))
        for word, angle, part in races:
            check_shape(f"the {word} contact angle", angle, (z,))
            matches = (np.isnan(angle) == (part == 0.0)).all()
            require(matches, f"{word} angles are nan where a contact is open, and only there")
        q, ball, forces = (np.repeat(each[None], 3, axis=0) for each in (equilibrium.displacement, equilibrium.ball, force))
        several = model.bearing.contact_angles(model, q, ball, forces, np.zeros(3))
        shapes = [np.shape(angle) for angle in several]
        require(shapes == [(3, z)] * 2, f"the angles of three states have the shapes {shapes}, not (3, {z})")
        check_shape("over_edges() of three states", model.bearing.over_edges(model, *several, forces), (3,))
        # Sum of the inner races' forces against the loads on the free translations.
        load, inner = np.where(force[:z] > 0.0, force[:z], 0.0), np.nan_to_num(equilibrium.angle_inner)
        side = np.array([side for side, _ in model.problem.bearing.rows])[model.basis.row]
        radial = load * np.cos(inner)
        total = np.array([side @ (load * np.sin(inner)), radial @ np.cos(model.azimuth), radial @ np.sin(model.azimuth)])
        residual = (total - model.system.load[:3]) * model.system.free[:3]
        share = float(np.abs(residual).max() / load.sum())
        require(share < _ANGLES, f"with their angles the inner races' forces leave {share:.2g} of them unbalanced")
        return f"{share:.1e} of them is left"

    @duty("contact_ellipse, ball_columns, edge_warnings, report, warnings, mesh_error, contact_error: shapes and types")
    def test_told(self, bodies: BodiesKind) -> None:
        model, equilibrium = settled(_scene_of(bodies))
        bearing, load = model.bearing, np.linspace(0.0, 2.0 * equilibrium.contact_force.max(), 7)
        for race in (0, 1):
            ellipse = bearing.contact_ellipse(model, race, load)
            require([np.shape(part) for part in ellipse] == [(7,)] * 3, "contact_ellipse(): three arrays like `load`")
            require(all(np.isfinite(a).all() and (np.diff(a) >= 0.0).all() for a in ellipse), "contact_ellipse() falls")
            require(ellipse[0][0] == 0.0 < ellipse[0][1], "the peak pressure begins at 0 without a load, and grows")
        for name, column in bearing.ball_columns(model, equilibrium).items():
            fits = np.shape(column) == (model.system.ball_count,)
            require(fits, f"ball_columns()['{name}'] has the shape {np.shape(column)}, not (Z,)")
        json.dumps(without_nan(bearing.report(model, equilibrium)), allow_nan=False)
        edges = bearing.edge_warnings(model, equilibrium.angle_inner, equilibrium.angle_outer, equilibrium.contact_force)
        words = [*bearing.warnings(model, equilibrium), *edges]
        require(all(isinstance(word, str) and word for word in words), f"warnings are sentences, not {words!r}")
        for name in ("mesh_error", "contact_error"):
            answer = getattr(bearing, name)(model, equilibrium)
            good = isinstance(answer, tuple) and len(answer) == 2 and isinstance(answer[1], str) and bool(answer[1])
            require(good, f"{name}() returns {answer!r}, not (number or None, how it was equilibrium)")
            require(answer[0] is None or 0.0 <= answer[0] < np.inf, f"{name}() is {answer[0]!r}")

    @duty("steps of newmark, central_difference and quasi_static; compiled and stepped drivers agree where there are both")
    def test_steps(self, bodies: BodiesKind) -> str:
        model, equilibrium = settled(_scene_of(bodies))
        system, has_loop = model.system, model.traits.compiled
        schedule, worst = Schedule(_OF_LIMIT * system.critical_time_step(equilibrium.stiffness), _STEPS, 1), 0.0
        for method in (Newmark(), CentralDifference(), QuasiStatic()):
            begin = model.bearing.at_rest if method.inertial else model.bearing.at_equilibrium
            start = begin(system, equilibrium.displacement, equilibrium.ball, False)
            record = integrate(method, system, start, schedule)
            motion = record.displacement - equilibrium.displacement
            size = float(np.abs(motion).max())
            require(np.isfinite(motion).all() and size > 0.0, f"{method.name}: the ring does not move under the force")
            if has_loop and has_both(method):
                from_python = integrate(FromPython(method), system, start, schedule)
                worst = max(worst, float(np.abs(from_python.displacement - record.displacement).max()) / size)
                # Both end their iterations at 1e-9 of all forces, of which the excitation is a small part.
                require(worst < 1e-5, f"{method.name}: drivers differ by {worst:.2g} of the motion")
        return f"drivers differ by {worst:.1e} of the motion" if has_loop else "stepped"

    @duty("the same scene gives the same equilibrium to the last bit")
    def test_repeats(self, bodies: BodiesKind) -> None:
        first, second = (settled(_scene_of(bodies))[1] for _ in range(2))
        for word in ("displacement", "stiffness", "contact_force"):
            require(np.array_equal(getattr(first, word), getattr(second, word)), f"`{word}` differs")

    @duty("what else a scene asks for is refused by the plan, or computed: nothing is left out in silence")
    def test_refused_or_computed(self, bodies: BodiesKind) -> str:
        registry, names = _registry_with(bodies), []
        plain = settled(_scene_of(bodies, PLAIN, registry))[1].displacement
        for word, (changes, shows) in _EXTRAS.items():
            scene = _scene_of(bodies, changes, registry)
            try:
                make_plan(scene)
            except SceneError:
                continue
            if not bodies.traits(resolve(scene)).resultants:
                continue
            names.append(word)
            try:
                model, equilibrium = settled(scene)
            except RacewayError as why:
                raise ConformityError(f"{word}: neither refused by faults() nor computed: {why}") from why
            left_over = _force_imbalance(model, equilibrium.displacement, equilibrium.ball)
            require(left_over < _BALANCE, f"{word}: {left_over:.2g} of the loads is left")
            require(shows(model, equilibrium, plain), f"{word}: changes nothing: refuse it by faults()")
        return f"computed: {', '.join(names) or 'nothing'}"

    @duty("a whole run ends with a stiffness, an error table and a result.json that names the kind")
    def test_run(self, bodies: BodiesKind) -> str:
        registry = _registry_with(bodies)
        result = run(_scene_of(bodies, registry=registry), registry)
        content = json.loads(json.dumps(result.to_dict(), allow_nan=False))
        require(content["scene"]["bodies"]["kind"] == bodies.name, "result.json names another kind of bodies")
        stiffness = K.of(content)
        require(stiffness is not None and stiffness > 0.0, f"the stiffness is {stiffness} N/m")
        return f"K = {stiffness:.4g} N/m"
