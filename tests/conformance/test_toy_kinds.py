"""Suites of kinds without many built-ins, on small plug-ins that work and on ones that do not."""

import json
from pathlib import Path
from types import SimpleNamespace

import attrs
import click
import numpy as np
import pytest

from checks.validation.scenes import built_in
from raceway import Quantity, RacewayError
from raceway.testing import ExecutorSuite, FormatSuite, MesherSuite, QuantitySuite, StudySuite

Serial = built_in("executor", "serial")

BOX = np.array([[x, y, z] for z in (0.0, 1.0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], dtype=float)


@attrs.frozen
class Box:
    """One hexahedron for each ring."""

    name = "box"

    def mesh(self, bearing):
        cells = np.arange(8)[None]
        return {ring: SimpleNamespace(points=bearing.pitch_diameter * BOX, cells=cells) for ring in ("inner", "outer")}


class InsideOut(Box):
    name = "inside_out"

    def mesh(self, bearing):
        return {"inner": SimpleNamespace(points=BOX[::-1].copy(), cells=np.array([[1, 0, 2, 3, 4, 5, 6, 7]]))}


class Dangling(Box):
    name = "dangling"

    def mesh(self, bearing):
        return {"inner": SimpleNamespace(points=BOX, cells=np.arange(1, 9)[None])}


class Misplaced(Box):
    """Sets of nodes and facets that it does not have."""

    name = "misplaced"

    def mesh(self, bearing):
        cells = np.arange(8)[None]
        return {"inner": SimpleNamespace(points=BOX, cells=cells, node_sets={"seat": np.array([7, 8])})}


class Restless(Box):
    """Another mesh each time."""

    name = "restless"

    def mesh(self, bearing):
        points = BOX + 1e-3 * np.random.default_rng().random(BOX.shape)
        return {"inner": SimpleNamespace(points=points, cells=np.arange(8)[None])}


@attrs.frozen
class Json:
    """Plain tables as JSON."""

    name = "json"
    suffixes = (".json",)

    def read(self, path):
        try:
            return json.loads(Path(path).read_text(encoding="utf-8"))
        except (OSError, ValueError) as why:
            raise RacewayError(f"`{path}` cannot be read: {why}") from why

    def write(self, path, what):
        Path(path).write_text(json.dumps(what), encoding="utf-8")

    def example_content(self):
        return {"points": [[0.0, 1.0]], "name": "box"}


class Careless(Json):
    name = "careless"
    suffixes = ("JSON",)

    def read(self, path):
        return json.loads(Path(path).read_text(encoding="latin-1") or "{}")


class Rounding(Json):
    """Numbers with nine figures."""

    name = "rounding"

    def write(self, path, what):
        super().write(path, what | {"points": [[float(f"{x:.9g}") for x in point] for point in what["points"]]})

    def example_content(self):
        return {"points": [[0.0, 1.0 / 3.0]], "name": "box"}


@attrs.frozen
class Text:
    """One line of text."""

    name = "text"
    suffixes = (".txt",)
    of_results = True

    def write(self, folder, result):
        path = Path(folder) / "result.txt"
        path.write_text(f"{result.identification.equivalent_stiffness:.4g} N/m")
        return [path]


class Forgetful(Text):
    name = "forgetful"

    def write(self, folder, result):
        super().write(folder, result)
        return []


@attrs.frozen
class Share:
    """Share of the load that the most loaded ball carries."""

    name = "share"
    numbers = (Quantity("largest_share", "1", "load of the most loaded ball over that of all", "share.largest"),)

    def why_not(self, problem):
        return ""

    def compute(self, points):
        inner = points.load[:, 0]
        return {"largest_share": inner.max(axis=1) / inner.sum(axis=1)}


class OfOnePoint(Share):
    name = "of_one_point"
    numbers = (Quantity("largest_share", "1", "load of the most loaded ball over that of all", "share.largest"),)

    def compute(self, points):
        inner = points.load[0, 0]
        return {"largest_share": np.full(len(points.load), inner.max() / inner.sum())}


class OfColumns(Share):
    """Twice the number where loads are columns."""

    name = "of_columns"
    numbers = (Quantity("column_share", "1", "load of the most loaded ball over that of all", "of_columns.largest"),)

    def compute(self, points):
        factor = 2.0 if np.ndim(points.problem.load.axial) else 1.0
        return {"column_share": factor * super().compute(points)["largest_share"]}


class Twice(Serial):
    """Answers each batch twice."""

    name = "twice"

    def compute(self, work, batches):
        for answer in super().compute(work, batches):
            yield from (answer, answer)


class Greedy(Serial):
    name = "greedy"

    def compute(self, work, batches):
        yield from super().compute(work, list(batches))


class Swallowing(Serial):
    name = "swallowing"

    def compute(self, work, batches):
        for number, points in batches:
            try:
                yield number, work(points)
            except ArithmeticError:
                continue


@attrs.frozen
class Loads:
    """A command that does nothing."""

    name = "loads"
    help = "Nothing at some loads."

    def command(self):
        return click.Command("loads", params=[click.Option(["--json"], is_flag=True)], help="Do nothing.")


class Misnamed(Loads):
    name = "misnamed"
    help = "One line,\nand another."


def failed(suite, plugin):
    return {row.name for row in suite.conformity(plugin).rows if not row.good}


@pytest.mark.parametrize(("suite", "plugin"), [
    (MesherSuite, Box()), (FormatSuite, Json()), (FormatSuite, Text()), (QuantitySuite, Share()),
    (ExecutorSuite, Serial()), (StudySuite, Loads()),
])  # fmt: skip
def test_sound_ones_conform(suite, plugin):
    assert suite.conformity(plugin).conforms


BROKEN = [
    (MesherSuite, InsideOut(), {"volumes"}), (MesherSuite, Dangling(), {"meshes"}),
    (FormatSuite, Careless(), {"declaration", "bad_files"}), (FormatSuite, Forgetful(), {"results"}),
    (QuantitySuite, OfOnePoint(), {"declaration", "columns"}), (ExecutorSuite, Greedy(), {"answers", "ends"}),
    (ExecutorSuite, Swallowing(), {"ends"}), (StudySuite, Misnamed(), {"help", "command"}),
    (MesherSuite, Misplaced(), {"sets"}), (MesherSuite, Restless(), {"repeats"}),
    (FormatSuite, Rounding(), {"round_trip"}), (QuantitySuite, OfColumns(), {"run"}),
    (ExecutorSuite, Twice(), {"answers"}),
]  # fmt: skip


def test_every_duty_can_fail():
    for suite in {suite for suite, *_ in BROKEN}:
        assert {"declaration"}.union(*(checks for of, _, checks in BROKEN if of is suite)) == set(suite.checks())


@pytest.mark.parametrize(("suite", "plugin", "checks"), BROKEN)
def test_broken_ones_do_not(suite, plugin, checks):
    assert checks <= failed(suite, plugin)
