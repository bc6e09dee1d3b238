"""Steady temperatures of scenes with [heat]: heat, temperatures, expansion and viscosity, loads, and heat again.

The temperatures x of inner rings, balls and outer rings are where those that follow from them are the same, G(x) = x: the bearing is
solved for with x in [mounting] and, as the oil in a contact's inlet is as warm as its surfaces, the mean over all contacts in the lubricant;
friction gives the heat, the network of ``raceway.core.quantities.thermal`` its temperatures.
n points are solved for at once as columns: Broyden's method (good update) from cold, then, for points where it finds nothing, half steps
of x <- G(x), which follow the warming up.  Where these run away there is no steady temperature: more heat is made the
warmer the bearing is than can leave it.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from itertools import product

import attrs
import numpy as np

from raceway.bodies.columns import Builder, ColumnBearing, solved_columns
from raceway.bodies.model import model_of
from raceway.bodies.mounting import preload_table
from raceway.core.quantities.thermal import NODES
from raceway.errors import ConvergenceError, RacewayError, SceneError
from raceway.framework.loading.registry import default_registry
from raceway.pipeline.equilibrium import solve_equilibrium
from raceway.pipeline.quantities import plugins_stating, solved_point, stated_numbers
from raceway.planning.columns import column_problem, why_not
from raceway.planning.plan import ScenePlan, make_plan, plan_of
from raceway.planning.resolve import Problem, resolve
from raceway.plugins.quantities.heat import NO_THINNING, ZERO_C, thermal_network
from raceway.scene.keys import with_columns
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables

#: Nodes that a bearing feels, and the temperature of [mounting] [C] from which its keys count.
_FELT, _MOUNTED_C = ("inner", "balls", "outer"), 20.0
_FELT_NODES = [NODES.index(node) for node in _FELT]
#: Of their surfaces in the contacts.
_IN_CONTACTS = (0.25, 0.5, 0.25)
#: Change of temperatures [K] within which they are steady before the last step; steps at most of either method.
_TOLERANCE, _QUICK, _SLOW = 1e-3, 25, 300
#: Longest step of Broyden's method [K].
_LONGEST = 50.0
#: Temperature [C] beyond which no bearing runs: steel has lost its hardness, and oils burn.
_HOTTEST = 400.0
#: The life of a band.
_LIFE = "l10r_hours"
#: Speeds at once, and rounds, in which the first one without steady temperatures is looked for: to 1/4000 of the range.
_SPEEDS, _ROUNDS = 17, 3

#: Reason of points without steady temperatures.
RUNAWAY = f"no steady temperature below {_HOTTEST:g} °C: the friction heat exceeds the heat removed at every temperature up to there"
#: Part of the highest temperature that steady ones reach at the limit speed where it is no fold that ends them.
_AT_LIMIT = 0.9

#: Temperatures (m, 6) that follow from columns of keys at points (m,), with factors of friction and conductances.
Solve = Callable[[Mapping[str, np.ndarray], np.ndarray, list[np.ndarray]], np.ndarray]


@attrs.frozen(eq=False)
class Warmth:
    """Steady temperatures of n points."""

    columns: Mapping[str, np.ndarray]  # of the keys of temperatures (n,), those of the cold bearing where nothing is steady
    temperatures: np.ndarray  # (n, 6) of all nodes [C]
    runaway: np.ndarray  # (n,) whether there are none: heat outgrows what can leave


def warm(scene: Scene, columns: Mapping[str, np.ndarray], plan: ScenePlan, factors: Sequence[np.ndarray] = ()) -> Warmth:
    """Steady temperatures of a scene with [heat] at points.

    columns : (n,) of continuous keys of the scene, at least one;  plan : of one of the points
    factors : (n,) of ``thermal_network``
    """
    assert scene.heat is not None, "callers look"
    # Keys of the temperatures of ``_FELT``, and of the oil in the contacts.
    oil = "lubricant.temperature_c" if scene.lubricant is not None else "contact.temperature_c"
    n = len(next(iter(columns.values())))
    keys = ("mounting.inner_temperature", "mounting.ball_temperature", "mounting.outer_temperature", oil)
    inlet, ambient = (
        np.broadcast_to(columns.get(f"heat.{key}", getattr(scene.heat, key)), n) for key in ("oil_inlet_c", "ambient_c")
    )
    start, nodes = np.repeat(inlet[:, np.newaxis], len(_FELT), axis=1), np.full((n, len(NODES)), np.nan)
    if why_not(resolve(scene), False):
        solve: Solve = partial(_one_by_one, scene, plan)
    else:
        solve = partial(_in_columns, Builder(plan).mounted({**columns, **_at(keys, start)}))

    def image(level: np.ndarray, rows: np.ndarray) -> np.ndarray:
        at = {key: column[rows] for key, column in columns.items()} | _at(keys, level)
        nodes[rows] = solve(at, rows, [factor[rows] for factor in factors])
        return nodes[rows][:, _FELT_NODES]

    level, steady, runaway = _fixed_points(image, start, np.minimum(inlet, ambient))
    level[~steady] = start[~steady]
    return Warmth(_at(keys, level), nodes, runaway)


def warm_plan(scene: Scene) -> ScenePlan:
    """The plan of a scene with [heat] at its steady temperatures.

    ConvergenceError: There are none, with the speed above which there are none, or at them it can not run: its grooves leave the balls no room.
    """
    simple = _simple(scene)
    warmth = warm(simple, _one(simple), make_plan(simple))
    if warmth.runaway[0]:
        raise ConvergenceError(_runaway_words(simple))
    try:
        return plan_of(_at_row(scene, warmth.columns, 0))
    except SceneError as fault:
        levels = zip(_FELT, warmth.temperatures[0, _FELT_NODES], strict=True)  # nan: nothing was solved at the start
        level = "".join(f", {node} at {degrees:.4g} °C" for node, degrees in levels if np.isfinite(degrees))
        raise ConvergenceError(
            f"the bearing cannot run at its steady temperatures{level}: {fault.mistakes[0].message}. Remedies: more or colder oil (heat.oil_flow, "
            "heat.oil_inlet_c), a wetted inner ring (heat.inner_wetting), a lower speed"
        ) from fault


def band_of_heat(scene: Scene, friction: tuple[float, float]) -> Tables:
    """``heat.band`` of result.json: [low, high] of temperatures, heat, preload, stiffness and life over the bands of friction and conductances.

    friction : ends of the band of its torque, over the torque

    Ends are those of the eight combinations of friction, the inner rings' conductance to the oil and the other conductances at the ends of
    their bands.  Where some of them have no steady temperature, or close the bearing, the upper ends are None, of life the lower one; both ends
    where all do.  Stiffness and life are left out where bodies are simplified for the temperatures (``_simple``).
    """
    assert scene.heat is not None, "callers look"
    simple, wide = _simple(scene), 1.0 + scene.heat.conductance_band
    conductances = (1.0 / wide, wide)
    factors = np.array(list(product(friction, conductances, conductances))).T
    columns = {key: np.repeat(column, factors.shape[1]) for key, column in _one(simple).items()}
    warmth = warm(simple, columns, make_plan(simple), list(factors))
    running, rating = {}, plugins_stating(resolve(simple), _LIFE)
    for corner in np.flatnonzero(~warmth.runaway):
        with suppress(SceneError):
            problem = _at_row(simple, warmth.columns, corner)
            model = model_of(problem, plan_of(problem))
            equilibrium = solve_equilibrium(model)
            preloaded = scene.bearing.preloaded and preload_table(model, equilibrium)
            point = solved_point(model, equilibrium, None)
            network = thermal_network(point, *factors[:, corner])
            life = stated_numbers(point, rating)[_LIFE] if rating else [np.nan]
            running[corner] = [
                preloaded["running_n"] if preloaded else np.nan,
                network.heats.sum(),
                *np.diag(equilibrium.stiffness)[:2],
                life[0],
            ]
    level = warmth.temperatures[list(running)] + ZERO_C
    inner, _, outer = level[:, _FELT_NODES].T

    def ends(values: np.ndarray, falls: bool = False) -> list[float | None]:
        """Corners that ran away are beyond the upper end, or of what falls with the heat beyond the lower one."""
        steady, every = len(values) > 0, len(values) == factors.shape[1]
        return [float(values.min()) if (every if falls else steady) else None,
                float(values.max()) if (steady if falls else every) else None]  # fmt: skip

    table: Tables = {"friction": list(friction), "conductances": list(conductances)}
    table["temperatures_k"] = {node: ends(column) for node, column in zip(NODES, level.T, strict=True)}
    table["inner_less_outer_k"] = ends(inner - outer)
    preload, heat, kxx, kyy, life = np.reshape(list(running.values()), (-1, 5)).T
    table["heat_w"] = ends(heat)
    if simple is scene:
        table |= {"kxx_n_per_m": ends(kxx), "kyy_n_per_m": ends(kyy)}
    if scene.bearing.preloaded:
        table["running_preload_n"] = ends(preload)
    if rating and simple is scene:
        table[_LIFE] = ends(life, falls=True)
    return table


def friction_band(numbers: Mapping[str, float | np.ndarray]) -> tuple[float, float]:
    """Ends of the band of friction's torque over the torque, of the numbers of a result; (1, 1) at rest."""
    low, torque, high = (float(numbers[f"torque_{end}nm"]) for end in ("low_", "", "high_"))
    return (low / torque, high / torque) if torque > 0.0 else (1.0, 1.0)


def _at_row(scene: Scene, columns: Mapping[str, np.ndarray], row: int | np.intp) -> Problem:
    """The problem of a scene with the numbers of one point: what the user said is the scene."""
    numbers = {key: float(column[row]) for key, column in columns.items()}
    return attrs.evolve(resolve(with_columns(scene, numbers)), scene=scene)


def _runaway_words(scene: Scene) -> str:
    """With the least speed [r/min], up to the scene's, at which it has no steady temperatures, and the highest [C] just below it."""
    key = "kinematics.spin_speed_rpm" if scene.kinematics.spin_speed_rpm is not None else "excitation.speed_rpm"
    low, speed, hottest = 0.0, resolve(scene).spin_speed * 30.0 / np.pi, np.nan
    if not speed:
        return (
            f"at the temperatures that oil and surroundings give it at rest the bearing is closed, or beyond {_HOTTEST:g} °C, at which steel softens "
            "and oil burns. Use other heat.oil_inlet_c, heat.ambient_c, a looser fit, or less preload"
        )
    for _ in range(_ROUNDS):
        speeds = np.linspace(low, speed, _SPEEDS + 1)[1:]
        warmth = warm(scene, {key: speeds}, make_plan(scene))
        first = int(np.argmax(warmth.runaway))
        if first:
            low, hottest = speeds[first - 1], warmth.temperatures[first - 1].max()
        speed = speeds[first]
    if np.isnan(hottest):
        words = f"{RUNAWAY}. "
    elif hottest > _AT_LIMIT * _HOTTEST:
        words = f"above {speed:.5g} r/min steady temperatures exceed {_HOTTEST:g} °C, at which steel softens and oil burns. "
    else:
        words = f"no steady temperature above {speed:.5g} r/min, where the bearing reaches {hottest:.4g} °C: beyond, the heat outgrows its removal "
        words += "(thermal runaway, a fold) or closes the bearing. "
    if scene.bearing.preloaded and scene.bearing.preload_kind == "rigid":
        words += "A rigid preload grows as the inner ring warms: reduce it, or use a spring. "
    if scene.lubricant is not None and not scene.lubricant.thins:
        words += f"{NO_THINNING}. "
    return f"{words}Remove more heat (heat.oil_flow, heat.inner_oil), or use a thinner oil"


def _at(keys: tuple[str, ...], level: np.ndarray) -> dict[str, np.ndarray]:
    """Columns of the keys at temperatures (n, 3) [C] of ``_FELT``."""
    return dict(zip(keys[:-1], level.T - _MOUNTED_C, strict=True)) | {keys[-1]: level @ _IN_CONTACTS}


def _one(scene: Scene) -> dict[str, np.ndarray]:
    return {"load.axial": np.array([scene.load.axial])}


def _simple(scene: Scene) -> Scene:
    """The scene whose loads decide its temperatures: with rigid bodies where its own are not computed as columns."""
    problem = resolve(scene)
    if problem.traits.contacts_alone or not why_not(problem, False):
        return scene
    law, find = scene.contact.law, default_registry().find
    law = law if "resultant" in law.discretisations else find("contact_law", "hertz").plugin()
    contact = attrs.evolve(scene.contact, kind=law.name, law=law, discretisation="resultant", friction=0.0)
    supports = attrs.evolve(scene.supports, outer_seat="rigid", inner_seat="rigid")
    return attrs.evolve(scene, bodies=find("bodies", "rigid").plugin(), mesh=None, contact=contact, supports=supports)


def _in_columns(
    cold: ColumnBearing, at: Mapping[str, np.ndarray], rows: np.ndarray, factors: list[np.ndarray]
) -> np.ndarray:
    """(m, 6) temperatures [C] that follow from those at which points (m,) are solved for; nan of what is no bearing in equilibrium."""
    bearing = cold.warmed(rows, column_problem(cold.plan.problem, at))
    states = bearing.equilibria()
    fine = (states.status == 0) & ~bearing.impossible(states.force)
    cold.points.guess[rows[fine]] = states.q[fine]
    with np.errstate(all="ignore"):
        level = thermal_network(solved_columns(bearing, states), *factors).temperatures
    return np.where(fine[:, np.newaxis], level, np.nan)


def _one_by_one(
    scene: Scene, plan: ScenePlan, at: Mapping[str, np.ndarray], rows: np.ndarray, factors: list[np.ndarray]
) -> np.ndarray:
    """The same of scenes that the compiled loops do not take."""
    level = np.full((len(rows), len(NODES)), np.nan)
    for row in range(len(rows)):
        with suppress(RacewayError):
            problem = _at_row(scene, at, row)
            model = model_of(problem, attrs.evolve(plan, problem=problem))
            point = solved_point(model, solve_equilibrium(model), None)
            level[row] = thermal_network(point, *(factor[row] for factor in factors)).temperatures[0]
    return level


def _fixed_points(
    image: Callable[[np.ndarray, np.ndarray], np.ndarray], start: np.ndarray, least: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where x = G(x): x (n, k), (n,) whether it was found, and whether it ran away instead.

    image : of x (m, k) and the rows (m,) that they belong to, G(x), nan where it is not defined;  least : (n,) of all x
    """
    answer = start.copy()
    steady, runaway = np.zeros(len(start), dtype=bool), np.zeros(len(start), dtype=bool)
    for steps, quick in ((_QUICK, True), (_SLOW, False)):
        rows = np.flatnonzero(~steady & ~runaway)
        x, step, before = start[rows], np.zeros((len(rows), start.shape[1])), np.zeros((len(rows), start.shape[1]))
        inverse = np.repeat(np.eye(start.shape[1])[np.newaxis], len(rows), axis=0)
        for count in range(steps):
            if not len(rows):
                break
            excess = image(x, rows) - x
            if quick:
                if count:  # Broyden's good update of H, which makes steps H f of f = G(x) - x
                    back, row = np.einsum("nij,nj->ni", inverse, excess - before), np.einsum("ni,nij->nj", step, inverse)
                    scale = (row * (excess - before)).sum(axis=1)
                    scale = np.where(np.abs(scale) > 1e-12 * (step**2).sum(axis=1), scale, np.inf)
                    inverse = inverse - (step + back)[:, :, None] * row[:, None, :] / scale[:, None, None]
                step = np.einsum("nij,nj->ni", inverse, excess)
                step *= np.minimum(1.0, _LONGEST / np.maximum(np.abs(step).max(axis=1), 1e-300))[:, np.newaxis]
            else:
                step = 0.5 * excess
            nearer = np.maximum(x + step, least[rows, np.newaxis])
            step, is_number = nearer - x, np.isfinite(excess).all(axis=1)
            converges = is_number & (np.abs(excess).max(axis=1) <= _TOLERANCE)
            answer[rows[converges]], steady[rows[converges]] = nearer[converges], True
            leaves = ~is_number | (nearer.max(axis=1) > _HOTTEST)
            if not quick:  # a cold bearing that is none is no runaway
                runaway[rows[leaves & (is_number | (count > 0))]] = True
            left = ~converges & ~leaves
            rows, x, inverse, step, before = rows[left], nearer[left], inverse[left], step[left], excess[left]
        runaway[rows] |= not quick
    return answer, steady, runaway
