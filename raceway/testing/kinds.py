"""The conformance suites of formats, meshers, quantities, executors and studies: kinds of few duties each."""

import copy
import json
import re
import tempfile
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import attrs
import numpy as np

from raceway.answers.quantities import plugin_quantities
from raceway.bodies.columns import Builder
from raceway.errors import RacewayError
from raceway.framework.contracts import Batch, Executor, Format, Mesher, Quantities, Refused, SolvedPoints, Study
from raceway.framework.duties import of_results, quantities_at, quantity_report, why_no_quantities
from raceway.framework.loading.registry import default_registry
from raceway.pipeline.quantities import solved_point
from raceway.pipeline.result import Result
from raceway.pipeline.run import run
from raceway.planning.plan import make_plan
from raceway.points.column_quantities import Computed
from raceway.scene.scene import Scene, scene_from_dict
from raceway.storage.tables import Tables
from raceway.testing.suite import Suite, b7206c, check_class, duty, require

#: Relative difference of real numbers that a text of ten figures may make.
_TEN_FIGURES = 1e-10


def _same(a: Any, b: Any, relative: float = 0.0) -> bool:
    """Whether two things read from files are equal, arrays inside them too; attrs objects (meshes) field by field.

    Real numbers may differ by ``relative`` times themselves; integers and words may not differ.
    """
    if isinstance(a, dict) and isinstance(b, dict):
        return set(a) == set(b) and all(_same(a[k], b[k], relative) for k in a)
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(_same(x, y, relative) for x, y in zip(a, b, strict=True))
    if attrs.has(type(a)) and type(a) is type(b):
        return all(_same(getattr(a, field.name), getattr(b, field.name), relative) for field in attrs.fields(type(a)))
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        a, b = np.asarray(a), np.asarray(b)
        if a.dtype.kind == "f" and b.dtype.kind == "f":
            return a.shape == b.shape and bool(np.allclose(a, b, rtol=relative, atol=0.0))
        return np.array_equal(a, b)
    if isinstance(a, float) and isinstance(b, float):
        return a == b or abs(a - b) <= relative * abs(b)
    return bool(a == b)


class FormatSuite(Suite):
    """Duties of ``raceway.framework.contracts.Format``.

    Attributes
    ----------
    what : something that the format can write; a plug-in checked by name offers it as ``example_content()``
    """

    kind = "format"
    what: object = None

    @duty("attributes: suffixes with the dot, options")
    def test_declaration(self, form: Format) -> None:
        check_class("format", form)
        suffixes = form.suffixes
        require(isinstance(suffixes, tuple) and suffixes, "`suffixes` must be a tuple that is not empty")
        bad = [s for s in suffixes if not re.fullmatch(r"(\.[a-z0-9_-]+)+", s)]
        require(not bad, f"suffixes {bad} must be lower case and begin with a dot")
        require(hasattr(form, "read") or of_results(type(form)), "it has neither `read` nor `of_results`")

    @duty(
        "what is written is read back the same, real numbers to ten figures, with every suffix",
        lambda form: "writes results" if of_results(type(form)) else "" if hasattr(form, "write") else "reads only",
    )
    def test_round_trip(self, form: Format) -> None:
        content = self._content(form)
        with tempfile.TemporaryDirectory() as folder:
            for suffix in form.suffixes:
                path = Path(folder) / f"content{suffix}"
                form.write(path, content)
                require(path.is_file() and path.stat().st_size > 0, f"write() leaves no file `{path.name}`")
                equal = _same(form.read(path), content, _TEN_FIGURES)
                require(equal, f"`{path.name}` is read back different from what was written")

    @duty(
        "of results: write(folder, result) returns the paths of its files, a second time too; the result is left untouched",
        lambda form: "" if of_results(type(form)) else "is of no results",
    )
    def test_results(self, form: Format) -> None:
        before = _example_result().to_dict()
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(2):
                paths = [Path(p) for p in form.write(Path(folder), _example_result()) or ()]
                require(paths, "write() returns no path")
                for path in paths:
                    require(path.is_file() and path.stat().st_size > 0, f"`{path.name}` does not exist or is empty")
                    require(path.resolve().is_relative_to(Path(folder).resolve()), f"`{path}` lies outside the folder")
            written = {p.resolve() for p in Path(folder).rglob("*") if p.is_file()}
            extra = sorted(p.name for p in written - {p.resolve() for p in paths})
            require(not extra, f"{', '.join(extra)} is written but not returned")
        require(_example_result().to_dict() == before, "the result was changed")

    @duty(
        "a file that is missing or malformed is refused with a RacewayError that names it",
        lambda form: "" if hasattr(form, "read") else "reads nothing",
    )
    def test_bad_files(self, form: Format) -> None:
        with tempfile.TemporaryDirectory() as folder:
            for suffix in form.suffixes:
                missing, empty, noise = (Path(folder) / f"{word}{suffix}" for word in ("missing", "empty", "noise"))
                empty.write_bytes(b"")
                noise.write_bytes(bytes(range(255, -1, -1)) * 8)
                for path in (missing, empty, noise):
                    try:
                        form.read(path)
                    except RacewayError as error:
                        require(path.name in str(error), f"the error about `{path.name}` does not name it: {error}")
                    else:
                        require(False, f"`{path.name}` is read without an error")

    def _content(self, form: Format) -> object:
        if self.what is not None:
            return self.what
        example = getattr(form, "example_content", None)
        require(example is not None, "give the class `example_content()`, or the suite `what`, to write")
        return example() if example is not None else None


#: Neighbours of each corner of a cell along its three axes.
AROUND = ((1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3))


def _in_range(numbers: np.ndarray, limits: int | tuple[int, int]) -> bool:
    """Whether there are some, all from 0 to below the limits."""
    return bool(len(numbers) and (numbers >= 0).all() and (numbers < limits).all())


@cache
def _example_scene() -> Scene:
    """A bearing of 30 mm bore under axial load and a turning force, two turns."""
    turning = {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3.2e-4}
    method = {"kind": "newmark", "turns": 2, "steps_per_turn": 90}
    still = {"ball_inertia": False}
    return scene_from_dict(b7206c(title="conformance", excitation=turning, integrator=method, kinematics=still))


@cache
def _example_result() -> Result:
    """The scene's ``Result``."""
    return run(_example_scene())


class MesherSuite(Suite):
    """Duties of ``raceway.framework.contracts.Mesher``."""

    kind = "mesher"

    @duty("mesh(bearing) returns meshes by name, each with points (n, 3) [m] and cells (m, 8)")
    def test_meshes(self, mesher: Mesher) -> None:
        meshes = mesher.mesh(_example_scene().bearing)
        require(isinstance(meshes, Mapping) and meshes, f"mesh() returns {type(meshes).__name__}, not meshes by name")
        for name, mesh in meshes.items():
            points, cells = np.asarray(mesh.points), np.asarray(mesh.cells)
            require(points.ndim == 2 and points.shape[1] == 3, f"'{name}': points of shape {points.shape}, not (n, 3)")
            require(cells.ndim == 2 and cells.shape[1] == 8, f"'{name}': cells of shape {cells.shape}, not (m, 8)")
            require(np.issubdtype(cells.dtype, np.integer), f"'{name}': cells are {cells.dtype}, not integers")
            require(np.isfinite(points).all() and len(points), f"'{name}': points must be finite, and there must be some")
            require(_in_range(cells, len(points)), f"'{name}': cells name points that do not exist")

    @duty("no cell is flat or inside out")
    def test_volumes(self, mesher: Mesher) -> None:
        for name, mesh in mesher.mesh(_example_scene().bearing).items():
            corner = np.asarray(mesh.points)[np.asarray(mesh.cells)]
            # Nodes 0 to 3 around the bottom, 4 to 7 above them: the edges at each corner, right-handed.
            for at, ends in enumerate(AROUND):
                bad = (np.linalg.det(corner[:, ends] - corner[:, [at]]) <= 0.0).sum()
                require(not bad, f"'{name}': {bad} of {len(corner)} cells are inside out or flat")

    @duty("sets, where there are some, name nodes (k,) and facets (k, 2) that exist")
    def test_sets(self, mesher: Mesher) -> None:
        for name, mesh in mesher.mesh(_example_scene().bearing).items():
            for word, members in getattr(mesh, "node_sets", {}).items():
                nodes = np.asarray(members)
                good = nodes.ndim == 1 and _in_range(nodes, len(mesh.points))
                require(good, f"'{name}': node set '{word}' is empty or names points that do not exist")
            for word, members in getattr(mesh, "facet_sets", {}).items():
                facets = np.asarray(members)
                good = facets.ndim == 2 and facets.shape[1] == 2 and _in_range(facets, (len(mesh.cells), 6))
                require(good, f"'{name}': facet set '{word}' is empty or names faces that do not exist")

    @duty("twice the same bearing gives the same mesh")
    def test_repeats(self, mesher: Mesher) -> None:
        first, second = (mesher.mesh(_example_scene().bearing) for _ in range(2))
        require(set(first) == set(second), "the bodies differ")
        for name in first:
            equal = all(_same(getattr(first[name], word), getattr(second[name], word)) for word in ("points", "cells"))
            require(equal, f"'{name}' differs")


class QuantitySuite(Suite):
    """Duties of ``raceway.framework.contracts.Quantities``.

    Attributes
    ----------
    scene : tables of a scene that has the quantities; a plug-in that needs more than a bearing under load offers ``example_scene()``
    """

    kind = "quantity"
    scene: Tables | None = None

    @duty("attributes: numbers with name, unit and words, in result.json at the plug-in's name; options with defaults")
    def test_declaration(self, plugin: Quantities) -> None:
        check_class("quantity", plugin)
        type(plugin)()  # every option has a default
        require(isinstance(plugin.numbers, tuple) and plugin.numbers, "`numbers` must be a tuple that is not empty")
        for number in plugin.numbers:
            require(re.fullmatch("[a-z][a-z0-9_]*", number.name), f"'{number.name}' must be letters, digits and underscores")
            require(number.unit and number.words, f"'{number.name}' must have a unit, \"1\" of ratios, and words")
            path = f"{plugin.name}."
            require(number.path.startswith(path), f"the path of '{number.name}' must begin with '{path}'")
        plugin_quantities(default_registry())

    @duty("numbers of columns are those of each point alone; points are not changed")
    def test_columns(self, plugin: Quantities) -> None:
        tables = self._tables(plugin)
        plugin = _of_scene(plugin, tables)
        loads = [0.8 * tables["load"]["axial"], tables["load"]["axial"]]
        points = _column_points(tables, loads)
        before = {k: copy.deepcopy(getattr(points, k)) for k in ("load", "contact_angle", "displacement", "stiffness")}
        values = quantities_at(plugin, points)
        for name, was in before.items():
            require(np.array_equal(getattr(points, name), was, equal_nan=True), f"`{name}` of the points is changed")
        for k, load in enumerate(loads):
            alone = quantities_at(plugin, _column_points(tables, [load]))
            for name, value in values.items():
                same = np.allclose(value[k], alone[name][0], rtol=1e-9, atol=0.0, equal_nan=True)
                require(same, f"'{name}' of point {k} is {value[k]} in columns and {alone[name][0]} alone")

    @duty("a run states the numbers of columns, tables of plain values, and warnings that are sentences")
    def test_run(self, plugin: Quantities) -> None:
        tables = self._tables(plugin)
        plugin, result = _of_scene(plugin, tables), run(scene_from_dict(tables))
        point, columns = (
            solved_point(result.model, result.equilibrium, None), _column_points(tables, [tables["load"]["axial"]], result)
        )  # fmt: skip
        require(not (why := why_no_quantities(plugin, point.problem)), f"the scene lacks {why}: give `example_scene()`")
        values = quantities_at(plugin, point)
        for name, value in quantities_at(plugin, columns).items():
            same = np.allclose(value, values[name], rtol=1e-6, atol=0.0, equal_nan=True)
            require(same, f"'{name}' is {value[0]} in columns and {values[name][0]} of a run")
        table, warnings = quantity_report(plugin, point, values)
        require(json.loads(json.dumps(table)) == table, "what result.json would have is no plain table")
        require(all(isinstance(text, str) for text in warnings), "warnings are no sentences")

    def _tables(self, plugin: Quantities) -> Tables:
        example = getattr(plugin, "example_scene", None)
        tables = self.scene or (example() if example is not None else b7206c(load={"axial": 1000.0, "radial": [200.0, 0.0]}))
        return {"kinematics": {"spin_speed_rpm": 6000.0}, **tables}


def _of_scene(plugin: Quantities, tables: Tables) -> Quantities:
    """The plug-in with the options that the scene gives it."""
    options = tables.get("quantities", {}).get(plugin.name, {})
    return attrs.evolve(plugin, **options)  # type: ignore[misc]


def _column_points(tables: Tables, loads: list[float], result: Result | None = None) -> SolvedPoints:
    """The scene at axial loads, as columns; at the temperatures of a result."""
    scene, columns = scene_from_dict(tables), {"load.axial": np.array(loads)}
    if scene.heat is not None:
        problem = run(scene).model.problem if result is None else result.model.problem
        warm = {
            f"mounting.{node}_temperature": getattr(problem.mounting, f"{node}_temperature")
            for node in ("inner", "outer", "ball")
        }
        assert problem.lubricant is not None, "rules of [heat] ask for it"
        warm["lubricant.temperature_c"] = problem.lubricant.temperature_c
        columns |= {key: np.full(len(loads), value) for key, value in warm.items()}
    return Computed.of(Builder(make_plan(scene)).at(columns), False, 1e-10, ()).points


#: Batches of a trial, and how many may be taken before the first is answered.
_BATCHES, _AHEAD = 400, 100


@attrs.frozen
class _Doubling:
    """Work that doubles numbers; it refuses the batch that holds ``refused`` and breaks at the one that holds ``broken``."""

    refused: int | None = None
    broken: int | None = None

    def fault(self) -> str | None:
        return None

    def __call__(self, points: list[int]) -> Refused | list[int]:
        if self.broken in points:
            raise ArithmeticError("a fault of the work itself")
        return Refused("here", "a trial") if self.refused in points else [2 * point for point in points]


class _Source:
    """Batches of two numbers, counted as they are taken."""

    def __init__(self, total: int) -> None:
        self.count, self.total = 0, total

    def __iter__(self) -> Iterator[Batch]:
        for number in range(self.total):
            self.count += 1
            yield number, [2 * number, 2 * number + 1]


class ExecutorSuite(Suite):
    """Duties of ``raceway.framework.contracts.Executor``.  Its work is in processes of its own, and clusters do not survive a fork."""

    kind = "executor"
    apart = False

    @duty("every batch is answered once, by what the work returned; batches are taken as they are needed")
    def test_answers(self, executor: Executor) -> None:
        source, answers, ahead = _Source(_BATCHES), dict[int, Any](), None
        for number, answer in executor.compute(_Doubling(refused=11), source):
            ahead = source.count if ahead is None else ahead
            require(number not in answers, f"batch {number} is answered twice")
            answers[number] = answer
        require(sorted(answers) == list(range(_BATCHES)), f"{len(answers)} of {_BATCHES} batches are answered")
        wrong = [n for n in answers if n != 5 and list(answers[n]) != [4 * n, 4 * n + 2]]
        require(not wrong, f"the answer of batch {wrong[:1]} is not what the work returned")
        require(isinstance(answers[5], Refused), f"`Refused` is not passed on, but {answers[5]!r}")
        require((ahead or 0) <= _AHEAD, f"{ahead} of {_BATCHES} batches are taken before the first is answered")

    @duty("no batches, no answers; what the work raises passes through; closing stops it")
    def test_ends(self, executor: Executor) -> None:
        require(not list(executor.compute(_Doubling(), _Source(0))), "answers without a batch")
        try:
            list(executor.compute(_Doubling(broken=6), _Source(8)))
        except ArithmeticError as why:
            require("work itself" in str(why), f"another exception passes through: {why}")
        else:
            require(False, "an exception of the work is swallowed")
        source = _Source(_BATCHES)
        answers = executor.compute(_Doubling(), source)
        next(answers)
        getattr(answers, "close", lambda: None)()
        require(source.count <= _AHEAD, f"closing takes all {source.count} batches")


class StudySuite(Suite):
    """Duties of ``raceway.framework.contracts.Study``."""

    kind = "study"

    @duty("help is one line for the list of studies")
    def test_help(self, study: Study) -> None:
        require(isinstance(study.help, str) and study.help.strip(), "help is no text")
        require(len(study.help.splitlines()) == 1, "help has several lines")

    @duty("command() gives a click command of the study's name that takes --json and explains itself")
    def test_command(self, study: Study) -> None:
        import click
        from click.testing import CliRunner

        command = study.command()
        require(isinstance(command, click.Command), f"command() gives {type(command).__name__}, not a click.Command")
        require(command.name == study.name, f"the command is called '{command.name}', the study '{study.name}'")
        require(any("--json" in option.opts for option in command.params), "the command has no --json")
        answer = CliRunner().invoke(command, ["--help"], standalone_mode=True)
        require(answer.exit_code == 0 and command.help, "--help fails or says nothing")
