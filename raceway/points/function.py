"""The bearing as a function of its numbers: arrays of keys in, arrays of quantities out, a compiled loop over the points between."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from enum import IntEnum
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import attrs
import numpy as np
from numpy.typing import ArrayLike

from raceway.answers.quantities import KNOWN, Quantity, plugin_quantities
from raceway.bodies.columns import Builder
from raceway.core.threads import ThreadPool, compile_beside, usable_cores
from raceway.errors import RacewayError, SceneError
from raceway.framework.doors import PATHS, TEXT, TEXTS, Reader, door
from raceway.framework.duties import is_foundation, why_no_quantities
from raceway.framework.loading.registry import default_registry
from raceway.framework.options import at_least, nearest
from raceway.framework.shown import duration
from raceway.pipeline.gradient import other_meshes, refuse_points
from raceway.pipeline.run import run
from raceway.planning.columns import law_keys, why_no_column, why_not
from raceway.planning.plan import make_plan
from raceway.planning.resolve import Problem, resolve
from raceway.plugins.formats import labelled_dataset
from raceway.points.column_quantities import DIMENSIONS, EXTREMES, MOVING, QUANTITIES, Columns, Computed, jacobian, of_result
from raceway.scene.keys import key_of, with_columns, with_numbers
from raceway.scene.scene import Scene, SceneSource, as_scene, scene_from_dict
from raceway.storage.files import available_bytes
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    import xarray

#: Points of a block, of equilibria and of motions: a quarter of a second, so that Ctrl-C is heard, and few enough to stay in the
#: cache of the second level.
BLOCK = (8192, 2048)
#: Dear kernels of the loop: of motions, and of the balls' moments.
_KERNELS = "raceway.core.periodic.orbits:orbits", "raceway.core.ring.kernels.rigid_inertial:rigid_tangential"
#: Time [s] that runs of points which the loop cannot do may take, unless they are forced.
_LIMIT_S = 120.0
_ADVICE = "give fewer points, or force = True. `raceway sweep` distributes such points among processes and resumes"
_POINT = Reader("numbers by their keys", lambda v: {TEXT.read(key): float(number) for key, number in v.items()})
#: Share of the memory that is left which inputs and outputs may take, and bytes for which the system is not asked: that takes as long as
#: a point.
_MEMORY, _ASKED = 0.8, 2.0**24
#: Rows without the reason of a run of their own, which is asked for a few only.
_REASONS, _BY_RULE = 200, "a rule of the scene refuses its numbers"


class PointStatus(IntEnum):
    """How a point was computed.

    Examples
    --------
    >>> import raceway as rw
    >>> rw.PointStatus(0).name
    'COMPUTED'
    """

    COMPUTED = 0  # in the compiled loop
    RUN = 1  # by a run of its own
    REFUSED = 2  # a rule of the scene
    FAILED = 3  # no equilibrium or no motion, or not tried


#: As numbers: looking one up in the class takes a microsecond.
_COMPUTED, _RUN, _REFUSED, _FAILED = map(int, PointStatus)


@attrs.frozen(eq=False, slots=False)
class Function:
    """Quantities of a scene as a function of its keys; see ``raceway.function``.

    Attributes
    ----------
    scene : what is the same at all points;  inputs : keys;  outputs : names of quantities
    tolerance : of steady orbits;  force : whether points that need runs of their own are run however long that takes
    threads : that share the points

    Examples
    --------
    >>> import raceway as rw
    >>> f = rw.function({"bearing": {"preset": "B7206C"}, "load": {"axial": 1.0}}, ["load.axial"], ["x"])
    >>> slope = f.jacobian(1000.0)["x"]["load.axial"]  # [m/N]
    >>> round(1e-6 / float(slope), 1)  # axial stiffness [N/um]
    62.1
    """

    scene: Scene
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    tolerance: float = 1e-8
    force: bool = False
    threads: int = 1
    _builders: dict[bool, Builder] = attrs.field(factory=dict, init=False, repr=False)

    def __getstate__(self) -> dict[str, object]:
        numbers = {field.name: getattr(self, field.name) for field in attrs.fields(Function)}
        return numbers | {"scene": self.scene.to_dict(), "_builders": {}}

    def __setstate__(self, state: Tables) -> None:
        scene = scene_from_dict(state["scene"], default_registry())
        for name, value in {**state, "scene": scene}.items():
            object.__setattr__(self, name, value)

    @cached_property
    def _problem(self) -> Problem:
        """Of the scene without its columns."""
        return resolve(self.scene)

    @property
    def moving(self) -> bool:
        """Whether a motion has to be solved for."""
        with_force = self.scene.excitation is not None
        return any(name in MOVING or with_force and (name in EXTREMES or name in self._of_plugins) for name in self.outputs)

    @property
    def contacts_alone(self) -> bool:
        """Whether runs of these bodies state no error of their own, which the compiled loop does not have: ``Traits``."""
        return self._problem.traits.contacts_alone

    @cached_property
    def _of_plugins(self) -> dict[str, tuple[str, Quantity]]:
        return plugin_quantities(default_registry())

    @cached_property
    def why_slow(self) -> str:
        """Why every point needs a run of its own; empty where a compiled loop computes them."""
        if is_foundation(self.scene.contact.law) and any(n.startswith("p0") or n in self._of_plugins for n in self.outputs):
            return "pressures are those of the contact law"
        whys = (why_no_column(self._problem, key) for key in self.inputs)
        return next(filter(None, whys), "") or why_not(self._problem, self.moving)

    def __call__(self, *columns: ArrayLike, **by_name: ArrayLike) -> Columns | xarray.Dataset:
        """The outputs at points.

        Parameters
        ----------
        columns, by_name : of all inputs, in their order or by their keys: numbers, arrays that broadcast, columns of a table, or
            xarray.DataArrays, which broadcast by the names of their dimensions

        Returns
        -------
        dict of arrays, by the names of the outputs, with ``status`` (``PointStatus``) and ``reason`` beside them, in the shape of the
        inputs; an xarray.Dataset with the dimensions of the inputs where any of these is a DataArray.  What a point has not is nan,
        and its reason says why.

        Raises
        ------
        SceneError
            Inputs that are missing, unknown, of shapes that do not broadcast, or empty.
        RacewayError
            More points than the memory holds, or that need runs of their own for longer than two minutes.
        """
        values = self._by_key(columns, by_name)
        xarray = sys.modules.get("xarray")
        if xarray is not None and any(isinstance(value, xarray.DataArray) for value in values.values()):
            return self._dataset(values)
        shape, flat = self._flat(values)
        return {name: column.reshape((*shape, *column.shape[1:])) for name, column in self.columns(flat).items()}

    def arrays(self, *columns: ArrayLike) -> np.ndarray | tuple[np.ndarray, ...]:
        """The outputs alone, a tuple of arrays, or the array of a single output: for ``scipy`` and ``xarray.apply_ufunc``."""
        answer = self(**{key: _as_floats(key, column) for key, column in self._by_key(columns, {}).items()})
        values = tuple(np.asarray(answer[name]) for name in self.outputs)
        return values[0] if len(values) == 1 else values

    def jacobian(self, *columns: ArrayLike, **by_name: ArrayLike) -> dict[str, Columns]:
        """Derivatives of each output by each input: ``jacobian(...)[output][input]``, in the shape of the inputs.

        Notes
        -----
        Differences of fourth order, central where a key's rule lets them be, all of them columns of one computation: with steps h of a
        thousandth of a number they are off by about h^4, 1e-10 of the value, and by rounding of 1e-12 / h.  Of an input that is 0
        everywhere the steps are 1e-3 of its unit, 1e-9 m of lengths.
        """
        shape, flat = self._flat(self._by_key(columns, by_name))
        return {
            name: {key: slope.reshape((*shape, *slope.shape[1:])) for key, slope in by_key.items()}
            for name, by_key in self.slopes(flat, self.inputs).items()
        }

    def slopes(self, flat: Mapping[str, np.ndarray], keys: Iterable[str]) -> dict[str, Columns]:
        """As ``jacobian``, by some of the inputs, from columns (n,) of all."""
        units, problem = {key: key_of(self.scene, key).unit for key in keys}, self._problem
        refuse_points(problem)
        for key in units:
            if why := other_meshes(problem, resolve(self._scene_with({key: 1.001 * key_of(self.scene, key).value}))):
                raise SceneError.at(key, None, why)
        return jacobian(self.columns, lambda key, number: self._is_allowed([key], [number]), dict(flat), units, self.outputs)

    def columns(self, flat: Mapping[str, np.ndarray]) -> Columns:
        """The outputs, ``status`` and ``reason`` of columns (n,) of all inputs."""
        n = len(next(iter(flat.values())))
        if self.why_slow:
            self.refuse_time(n)
            return self._run_all(flat, np.arange(n), {})
        # Runs of what the loop has left.
        answer = self.with_reasons(flat, self.looped(flat))
        left = np.flatnonzero(answer["status"] == _FAILED)
        left = left[answer["reason"][left] == ""]
        seconds = self._seconds(len(left)) if len(left) and not self.force else 0.0
        if seconds > _LIMIT_S:
            answer["reason"][left] = (
                f"the compiled loop finds no regular solution; runs of these {len(left)} points would take about {duration(seconds)}: force = True runs them"
            )
            return answer
        return self._run_all(flat, left, answer)

    def looped(self, flat: Mapping[str, np.ndarray]) -> Columns:
        """As ``columns``, of the compiled loop alone: what it leaves has the status FAILED or REFUSED, nan, and no reason."""
        n, size = len(next(iter(flat.values()))), BLOCK[self.moving]
        blocks = [slice(k, k + size) for k in range(0, n, size)]
        answer: Columns = {
            "status": np.where(self._refusals(flat), _REFUSED, _FAILED),
            "reason": np.full(n, "", dtype=object),
        }
        compile_beside(*_KERNELS[0 if self.moving else 1 :])
        if n > size:
            # Once so large an array was freed, glibc keeps a block's memory for the next one, which it asks for zeroed pages else.
            np.empty(31 << 17)
        with ThreadPool(min(self.threads, len(blocks))) as pool:
            pool.do(len(blocks), lambda number: self._put_block(flat, blocks[number], answer))
        without = answer["status"] != _COMPUTED
        for name in self.outputs:
            answer.setdefault(name, np.empty(n))[without] = np.nan
        return {name: answer[name] for name in (*self.outputs, "status", "reason")}

    def with_reasons(self, flat: Mapping[str, np.ndarray], answer: Columns) -> Columns:
        """What the loop computed, with the reasons of rows that are refused."""
        refusals = np.flatnonzero(answer["status"] == _REFUSED)
        answer["reason"][refusals] = _BY_RULE
        for row in refusals[:_REASONS]:
            try:
                make_plan(self._scene_of(flat, int(row)))
            except RacewayError as why:
                answer["reason"][row] = str(why)
        return answer

    @door
    def scene_at(self, point: Annotated[Mapping[str, float], _POINT]) -> Scene:
        """The scene at one point, every rule looked at.

        Raises
        ------
        SceneError
            A number that is refused.
        """
        for key in point:
            key_of(self.scene, key)
        return scene_from_dict(self._scene_with(point).to_dict(), default_registry())

    def _scene_with(self, point: Mapping[str, float]) -> Scene:
        """The scene with other numbers, which no rule looks at."""
        return with_columns(self.scene, {key: float(number) for key, number in point.items()})

    def _by_key(self, columns: Sequence[ArrayLike], by_name: Mapping[str, ArrayLike]) -> dict[str, ArrayLike]:
        if len(columns) > len(self.inputs):
            why = f"are more columns than the {len(self.inputs)} inputs of this function"
            raise SceneError.at("inputs", len(columns), why)
        values = dict(zip(self.inputs, columns, strict=False))
        for key, value in by_name.items():
            if key not in self.inputs:
                raise SceneError.at(key, None, f"is no input of this function{nearest(key, self.inputs)}")
            if key in values:
                raise SceneError.at(key, None, "is given twice")
            values[key] = value
        if missing := [key for key in self.inputs if key not in values]:
            raise SceneError.at(missing[0], None, "is an input of this function and is missing")
        return {key: values[key] for key in self.inputs}

    def _flat(self, values: Mapping[str, ArrayLike]) -> tuple[tuple[int, ...], Columns]:
        """Common shape of arrays, and their columns (n,), refused before they are made."""
        arrays = {key: _as_floats(key, value) for key, value in values.items()}
        try:
            shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
        except ValueError:
            sizes = ", ".join(f"{key} {array.shape}" for key, array in arrays.items())
            raise SceneError.at("inputs", None, f"do not broadcast: {sizes}") from None
        if 0 in shape:
            raise SceneError.at("inputs", None, f"are empty: their common shape is {shape}")
        z = self.scene.bearing.balls_in_all
        many = {"displacement": 5, "stiffness": 25, "ball_load": 2 * z, "contact_angle": 2 * z}
        entries = len(self.inputs) + 2 + sum(many.get(name, 1) for name in self.outputs)
        advice = "compute them block by block, for instance by xarray.apply_ufunc over dask arrays"
        refuse_bytes(math.prod(shape), entries, advice)
        return shape, {key: np.ascontiguousarray(np.broadcast_to(array, shape)).ravel() for key, array in arrays.items()}

    def _dataset(self, values: Mapping[str, ArrayLike]) -> xarray.Dataset:
        import xarray

        arrays = [
            value if isinstance(value, xarray.DataArray) else xarray.DataArray(_as_floats(key, value))
            for key, value in values.items()
        ]
        same = xarray.broadcast(*arrays)
        shape, flat = self._flat({key: array.values for key, array in zip(values, same, strict=True)})
        answer, dims = self.columns(flat), same[0].dims
        quantities = KNOWN | {name: quantity for name, (_, quantity) in self._of_plugins.items()}
        variables: Tables = {}
        for name, column in answer.items():
            further, labels = ((), {}) if name not in quantities else (quantities[name].dims, quantities[name].labels)
            variables[name] = ((*dims, *further), column.reshape((*shape, *column.shape[1:])), labels)
        flags, meanings = [int(s) for s in PointStatus], " ".join(s.name.lower() for s in PointStatus)
        variables["status"] = (*variables["status"][:2], {"flag_values": flags, "flag_meanings": meanings})
        further_dims = {k: v for k, v in DIMENSIONS.items() if any(k in part[0] for part in variables.values())}
        return labelled_dataset(variables, dict(same[0].coords) | further_dims, {"title": self.scene.title})

    def _put_block(self, flat: Mapping[str, np.ndarray], block: slice, answer: Columns) -> None:
        """Compute one block of points in the compiled loop; rows that it cannot do keep the status FAILED and get no values."""
        columns = {key: column[block] for key, column in flat.items()}
        status, reason = answer["status"][block], answer["reason"][block]
        fit = np.flatnonzero(status != _REFUSED)
        # A plan decides alike about rows whose balls turn, and about those whose balls stand.
        turns = np.full(len(fit), self._problem.spin_speed > 0.0)
        for key in ("excitation.speed_rpm", "kinematics.spin_speed_rpm"):
            if key in columns and (key.startswith("kin") or self.scene.kinematics.spin_speed_rpm is None):
                turns = columns[key][fit] > 0.0
        for turning, rows in ((True, fit[turns]), (False, fit[~turns])):
            # The first row that no rule refuses decides about parts, once for either.
            for row in rows[:5] if turning not in self._builders else ():
                with suppress(RacewayError):
                    self._builders[turning] = Builder(make_plan(self._scene_of(columns, row)))
                    break
            builder = self._builders.get(turning)
            if builder is None or not len(rows):
                continue
            inputs = columns if len(rows) == len(status) else {key: column[rows] for key, column in columns.items()}
            try:
                if self.scene.heat is not None:
                    from raceway.pipeline.warm import RUNAWAY, warm

                    warmth = warm(self.scene, inputs, builder.plan)
                    reason[rows[warmth.runaway]] = RUNAWAY
                    inputs = {**inputs, **warmth.columns}
                bearing = builder.at(inputs)
            except RacewayError:  # of elastic bodies that no point has
                continue
            numbers = Computed.of(bearing, self.moving, self.tolerance, self.outputs)
            fine = ~bearing.conspicuous & numbers.fine & (reason[rows] == "")
            status[rows[fine]] = _COMPUTED
            oil = self.scene.lubricant
            if self.scene.heat is not None and oil is not None and oil.thins:
                from raceway.plugins.quantities.heat import beyond_oil

                reason[rows[fine]] = [beyond_oil(float(level)) for level in inputs["lubricant.temperature_c"][fine]]
            for name in self.outputs:
                known = QUANTITIES.get(name)
                part = known(numbers) if known else numbers.of_plugin(self._of_plugins[name][0], name)
                # All points' memory is asked for at once, and taken when a block is written to it.
                values = answer.setdefault(name, np.empty((len(answer["status"]), *part.shape[1:])))[block]
                if fine.all() and len(rows) == len(status):
                    values[:] = part
                else:
                    values[rows[fine]] = part[fine]

    def _refusals(self, columns: Mapping[str, np.ndarray]) -> np.ndarray:
        """(n,) whether a number is none, or a rule of its key alone refuses it."""
        refusals = ~np.all([np.isfinite(column) for column in columns.values()], axis=0)
        of_law = [key for key in columns if key in law_keys(self.scene)]
        for keys in filter(None, [of_law, *([key] for key in columns if key not in of_law)]):
            numbers = np.stack([columns[key] for key in keys], axis=1)
            fit = numbers[~refusals]
            if len(fit) and not all(
                self._is_allowed(keys, ends) for ends in product(*map(set, zip(fit.min(0), fit.max(0), strict=True)))
            ):
                # Rules are intervals, or compare two options of a law: numbers beyond them are looked at one by one, where their block is.
                if (half := len(numbers) // 2) >= BLOCK[self.moving]:
                    first, second = ({key: c[k] for key, c in columns.items()} for k in (slice(half), slice(half, None)))
                    return np.concatenate([self._refusals(first), self._refusals(second)])
                several, place = np.unique(numbers, axis=0, return_inverse=True)
                fitness = [bool(np.isfinite(row).all()) and self._is_allowed(keys, row) for row in several]
                refusals |= ~np.array(fitness)[place.ravel()]
        return refusals

    def _is_allowed(self, keys: Sequence[str], numbers: Sequence[float] | np.ndarray) -> bool:
        try:
            with_numbers(self.scene, dict(zip(keys, map(float, numbers), strict=True)))
        except (ValueError, RacewayError):
            # Another input may make room for it: what contradicts is seen where all are known.
            return len(self.inputs) > 1 and keys[0].startswith("bearing.") and numbers[0] > 0.0
        return True

    def _scene_of(self, flat: Mapping[str, np.ndarray], row: int) -> Scene:
        """The scene of one row; ``SceneError`` of what is no number, too."""
        point = {key: float(column[row]) for key, column in flat.items()}
        for key, number in point.items():
            if not np.isfinite(number):
                raise SceneError.at(key, number, "is no number")
        return self.scene_at(point)

    def _run_all(self, flat: Mapping[str, np.ndarray], rows: np.ndarray, answer: Columns) -> Columns:
        n = len(next(iter(flat.values())))
        answer.setdefault("status", np.full(n, _FAILED))
        answer.setdefault("reason", np.full(n, "", dtype=object))
        for row in rows:
            try:
                result = run(self._scene_of(flat, row))
            except RacewayError as why:
                answer["status"][row] = _REFUSED if isinstance(why, SceneError) else _FAILED
                answer["reason"][row] = str(why)
                continue
            answer["status"][row] = _RUN
            for name in self.outputs:
                value = of_result(name, result)
                if name not in answer:
                    answer[name] = np.full((n, *np.asarray(value).shape), np.nan)
                answer[name][row] = np.nan if value is None else value
                if value is None:
                    answer["reason"][row] = f"this scene has no {name}"
        for name in self.outputs:
            answer.setdefault(name, np.full(n, np.nan))
        return {name: answer[name] for name in (*self.outputs, "status", "reason")}

    def _seconds(self, count: int) -> float:
        return count * max(make_plan(self.scene).predicted_wall_s, 2e-3)

    def refuse_time(self, n: int, advice: str = _ADVICE) -> None:
        """Raise a RacewayError where runs of all points would take longer than two minutes."""
        seconds = self._seconds(n)
        if seconds > _LIMIT_S and not self.force:
            time = f"{n} points would take about {duration(seconds)}, one run after another"
            raise RacewayError(f"{time}, because {self.why_slow}: {advice}")


def refuse_bytes(n: int, entries: int, advice: str) -> None:
    """Refuse points with so many numbers each that they do not fit into the memory that is available.

    RacewayError: With both numbers of bytes.
    """
    need = 8.0 * n * entries
    if need > _ASKED and need > _MEMORY * (left := available_bytes()):
        raise RacewayError(f"{n} points need {need:.4g} bytes for their numbers, of {left:.4g} available: {advice}")


def _as_floats(key: str, value: ArrayLike) -> np.ndarray:
    try:
        array = np.asarray(value)
        if array.dtype.kind in "c":
            raise TypeError("a complex number is no point")
        return np.asarray(array, dtype=float)
    except Exception:  # whatever a foreign object makes of being asked
        raise SceneError.at(key, None, "must be numbers") from None


@door
def function(
    scene: SceneSource,
    inputs: Annotated[Iterable[str], TEXTS],
    outputs: Annotated[Iterable[str], TEXTS],
    *,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
    tolerance: float = 1e-8,
    force: bool = False,
    threads: Annotated[int | None, at_least(1)] = None,
) -> Function:
    """The bearing as a function of its numbers, for millions of points.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables: what is the same at all points, with a number at every input
    inputs : continuous keys, such as "load.axial", "excitation.speed_rpm", "bearing.contact_angle_deg"
    outputs : quantities by their names, such as "kyy", "stiffness", "contact_angle", or symbols, "K", "C"
    plugins : files of one-off plug-ins that the scene uses
    tolerance : of the synchronous (1x) component of steady orbits, relative
    force : also run, one after another, points that a compiled loop cannot do, however long that takes
    threads : that share the points; None: as many as there are cores

    Returns
    -------
    Function : called with arrays of the inputs, which broadcast

    Raises
    ------
    SceneError
        An input that is no continuous key of the scene, an output that is not known.

    Notes
    -----
    Rigid bodies with laws without memory, oil films too, are computed in compiled loops: equilibria, and steady orbits where
    ``integrator.kind`` is "auto" or "periodic".  That an orbit is stable and the only one is not looked at there, as ``raceway.run`` does.  Points
    at which the loop finds no regular solution are run one by one: ``status`` says which.

    Examples
    --------
    >>> import raceway as rw
    >>> f = rw.function({"bearing": {"preset": "B7206C"}, "load": {"axial": 1.0}}, ["load.axial"], ["kyy"])
    >>> (f([400.0, 1000.0])["kyy"] * 1e-6).round(1)  # [N/um]
    array([183.4, 238.2])
    """
    read = as_scene(scene, plugins=plugins)
    keys, names = tuple(inputs), tuple(_name(output) for output in outputs)
    if not keys:
        raise SceneError.at("inputs", None, "are empty: a function has at least one, such as 'load.axial'")
    if repeats := [key for key in keys if keys.count(key) > 1]:
        raise SceneError.at(repeats[0], None, "is an input twice")
    for key in keys:
        key_of(read, key)
        if read.heat is not None and key.endswith(("_temperature", ".temperature_c")):
            raise SceneError.at(key, None, "is computed by [heat] and cannot be an input")
    of_plugins, problem = plugin_quantities(default_registry()), resolve(read)
    for name in (name for name in names if name in of_plugins):
        if why := why_no_quantities(getattr(read.quantities, of_plugins[name][0]), problem):
            raise SceneError.at("outputs", name, f"is not a number of this scene: {why}")
    result = Function(read, keys, names, tolerance, force, threads or usable_cores())
    if result.moving and read.excitation is None:
        raise SceneError.at("excitation", None, f"is missing: {next(n for n in names if n in MOVING)} is of a motion")
    if "kyy_tilts_follow" in names and read.supports.tilt == "locked":
        raise SceneError.at("supports.tilt", "locked", "kyy_tilts_follow needs tilts that follow")
    return result


def _name(output: str) -> str:
    names = {name: name for name in (*QUANTITIES, *plugin_quantities(default_registry()))}
    symbols = {quantity.symbol: name for name, quantity in KNOWN.items() if name in QUANTITIES}
    name = {**symbols, **names}.get(output)
    if name is None:
        why = f"is no quantity of a function{nearest(output, [*names, *symbols])}: {', '.join(names)}"
        raise SceneError.at("outputs", output, why)
    return name
