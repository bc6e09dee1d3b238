"""Sweeps of points that a compiled loop computes: blocks of columns in the store, the same numbers as runs of their own."""

import json
import os
import signal
import sqlite3
import threading
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import raceway as rw
from checks.validation.command_line import invoke
from checks.validation.scenes import built_in
from raceway.extend import COLUMNS, Lost, open_store, tables_at
from raceway.planning.parts import slowness
from raceway.planning.plan import column_time
from raceway.points import sweep
from raceway.points.axes import grid, listed_points, sampled
from raceway.points.dataset import values_of
from raceway.points.function import BLOCK
from raceway.points.sweep import fill_store, prepare
from raceway.testing import default_registry

Serial = built_in("executor", "serial")

STATIC: dict[str, Any] = {
    "title": "static", "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "supports": {"tilt": "free"},
    "kinematics": {"spin_speed_rpm": 9000.0},
}  # fmt: skip
#: The motion of a tenth of a micrometre about it, contacts with dashpots.
ROTATING: dict[str, Any] = {
    "rotor": {"mass": 2.0, "damping": 50.0}, "kinematics": {}, "contact": {"kind": "hertz", "damping": 0.001},
    "excitation": {"kind": "bidirectional", "speed_rpm": 9000.0, "unbalance": 3e-4},
    "integrator": {"kind": "periodic", "tolerance": 1e-11},
}  # fmt: skip
#: What a run takes of 360 samples, or of another method.
BOUNDS = {"damping": 1e-7, "peak": 1e-6, "min_": 1e-4, "p0": 1e-6, "z_imag": 1e-6, "equivalent_damping": 1e-6}
#: What both methods estimate by themselves, or what rounding leaves.
OWN = ("error_total", "error_time_step", "error_identification", "error_bodies", "residual", "backward_amplitude")


def filled(folder: Path, design: Any, executor: Any = None, resume: bool = False) -> Any:
    fill_store(prepare(STATIC, design, folder, resume=resume), executor or Serial()).close()
    with open_store(folder) as store:
        return store.to_xarray()


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks of ten points."""
    monkeypatch.setattr("raceway.points.sweep._SHARED", 1)
    monkeypatch.setattr("raceway.points.sweep.BLOCK", (10, 10))


TURNING = {"load.axial": [300.0, 2000.0], "kinematics.spin_speed_rpm": [0.0, 1000.0, 24000.0], "load.radial[1]": [0.0, 30.0]}


@pytest.mark.parametrize("changes, axes", [
    ({}, TURNING),
    ({"supports": {"tilt": "locked"}, "contact": {"kind": "hertz", "damping": 0.01}}, {"load.axial": [300.0, 800.0]}),
    (
        {"bearing": {"preset": "B7206C", "arrangement": "DB", "preload": 300.0, "row_distance": 0.016}},
        {"bearing.preload": [200.0, 600.0], "bearing.contact_angle_deg": [14.0, 16.0]},
    ),
    (ROTATING, {"excitation.speed_rpm": [10_980.0, 15_000.0], "load.axial": [600.0, 2000.0]}),
    (
        {**ROTATING, "excitation": {"kind": "unidirectional", "speed_rpm": 9000.0, "unbalance": 1e-4}},
        {"load.axial": [1500.0, 2000.0]},
    ),
], ids=["speeds", "damped", "pair", "rotating", "to and fro"])  # fmt: skip
def test_computed_points_are_what_runs_give(changes: dict[str, Any], axes: dict[str, Any]) -> None:
    """1e-9 of every number that a run has, and no number more."""
    tables = {**STATIC, **changes}
    swept = rw.sweep(tables, axes)
    assert (swept.status == "computed").all()
    flat = swept.stack(point=list(axes))
    for number, point in enumerate(flat.point.values.tolist()):
        at = dict(zip(axes, point, strict=True))
        values = values_of(rw.run(rw.Scene.from_dict(tables_at(tables, at, default_registry()))))
        one = flat.isel(point=number)
        for name, value in values.items():
            if name in OWN or (name == "error_model_bound" and "bearing.preload" in axes):
                continue  # rings grow by their own sections
            bounds = BOUNDS if "excitation" in tables else {"damping": 1e-7}
            relative = next((bound for word, bound in bounds.items() if name.startswith(word)), 1e-9)
            bound = relative * (np.abs(value).max() or 1.0)
            assert np.abs(one[name].values - value).max() <= bound, (name, at)
        more = [name for name in COLUMNS if name in one and name not in values and np.isfinite(one[name].values).any()]
        assert not more


def test_what_the_loop_leaves_is_run_and_what_a_rule_refuses_says_so(tmp_path: Path, small: None) -> None:
    design = listed_points([{"load.axial": load, "rotor.mass": 1.0} for load in [*np.linspace(300.0, 2000.0, 11), 0.0]])
    swept = filled(tmp_path / "s", design)
    assert swept.status.values.tolist() == [*["computed"] * 11, "failed"]
    with open_store(tmp_path / "s") as store:
        assert store.status() == {"waiting": 0, "done": 11, "failed": 1, "computed": 11, "total": 12}
        rows = list(store.rows())
    assert "no load acts" in rows[11]["reason"] and rows[11]["point"]["load.axial"] == 0.0
    assert rows[3]["values"]["p0"] == float(swept.p0[3]) and not rows[11]["values"]
    with pytest.raises(rw.SceneError, match=r"load\.axial"):
        prepare(STATIC, grid(["load.axial=300,inf"]), tmp_path / "t")


def test_kinds_and_words_are_run_point_by_point(tmp_path: Path) -> None:
    for axis in ("supports.tilt=free,locked", "contact.kind=hertz,penalty", "bearing.ball_count=12,14"):
        assert prepare(STATIC, grid([axis, "load.axial=300,400"]), tmp_path / "s").function is None
    assert prepare(STATIC, grid(["load.axial=300,400"]), tmp_path / "s").function is not None
    slow = {**STATIC, "bodies": {"kind": "condensed"}}
    assert prepare(slow, grid(["load.axial=300,400"]), tmp_path / "s").function is None


class _Stopping(Serial):
    """Ctrl-C after one block."""

    def compute(self, work: Any, batches: Any) -> Any:
        for count, answer in enumerate(super().compute(work, batches)):
            if count == 1:
                raise KeyboardInterrupt
            yield answer


class _Losing(Serial):
    """The first block takes its worker down."""

    def compute(self, work: Any, batches: Any) -> Any:
        for number, answer in super().compute(work, batches):
            yield number, Lost("it died") if number == 0 and hasattr(work.function, "outputs") else answer


def test_blocks_are_resumed_shared_and_repaired(tmp_path: Path, small: None) -> None:
    design = grid(["load.axial=300:2000:24"])
    whole = filled(tmp_path / "whole", design)
    with pytest.raises(KeyboardInterrupt):
        filled(tmp_path / "s", design, _Stopping())
    with open_store(tmp_path / "s") as store:
        assert store.status()["waiting"] == 14
        assert [row["status"] for row in store.rows()] == ["computed"] * 10 + ["waiting"] * 14
    assert filled(tmp_path / "s", design, resume=True).equals(whole)
    assert filled(tmp_path / "p", design, built_in("executor", "processes")(workers=1)).equals(whole)
    with closing(sqlite3.connect(tmp_path / "s" / "points.sqlite")) as file, file:
        file.execute("UPDATE points SET content = zeroblob(length(content)) WHERE key = '10:20'")
    with pytest.warns(UserWarning, match="10 of 24 rows are damaged"), open_store(tmp_path / "s") as store:
        assert int(np.isnan(store.to_xarray().p0).sum()) == 10
    with pytest.warns(UserWarning, match="1 rows of the store are damaged"):
        assert filled(tmp_path / "s", design, resume=True).equals(whole)


def test_a_block_whose_worker_dies_is_run_point_by_point(tmp_path: Path, small: None) -> None:
    design = grid(["load.axial=300:2000:12"])
    swept, whole = filled(tmp_path / "s", design, _Losing()), filled(tmp_path / "whole", design)
    assert swept.status.values.tolist() == ["run"] * 10 + ["computed"] * 2
    np.testing.assert_allclose(swept.p0, whole.p0, rtol=1e-9)
    assert filled(tmp_path / "s", design, resume=True).equals(swept)  # runs beside blocks stay


def test_ctrl_c_is_answered_by_the_end_of_a_block(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Less than a second on the machine that the plan's constants are of: how fast this one is decides no test.
    each = column_time(rw.make_plan(rw.Scene.from_dict(STATIC)), moving=False) / slowness()
    assert sweep._SHARED * BLOCK[False] * each < 1.0
    monkeypatch.setattr(sweep, "BLOCK", (500, 500))
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
    design = grid(["load.axial=300:2000:400", "kinematics.spin_speed_rpm=1000:24000:50"])
    events: list[str] = []

    def press() -> None:
        events.append("pressed")
        os.kill(os.getpid(), signal.SIGINT)

    def after_a_block(_what: str, _done: int, _total: int) -> None:
        if not events:
            threading.Timer(0.05, press).start()
        events.append("block")

    with pytest.raises(KeyboardInterrupt):
        fill_store(prepare(STATIC, design, tmp_path / "s"), Serial(), on_progress=after_a_block)
    assert events[events.index("pressed") :].count("block") <= 2  # the one under way, and one that ended as the signal came
    signal.signal(signal.SIGINT, before)
    with open_store(tmp_path / "s") as store:
        assert store.status()["waiting"] > 0


def test_the_answer_says_how_points_were_computed(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text('[bearing]\npreset = "B7206C"\n[load]\naxial = 1.0\n')
    words = ["sweep", tmp_path / "s.toml", "--grid", "load.axial=0,500,900", "--out", tmp_path / "s"]
    shown = " ".join(invoke(*words, "--csv").output.split())
    assert "3 points: 2 done, 1 failed" in shown and "2 computed in a compiled loop" in shown
    assert "Not checked at computed points: stability of orbits, further orbits, warnings" in shown
    lines = (tmp_path / "s" / "results.csv").read_text().splitlines()
    assert [line.split(",")[1] for line in lines] == ["status", "failed", "computed", "computed"]
    content = json.loads(invoke(*words, "--resume", "--json").stdout)
    assert content["states"]["computed"] == 2
    assert [row["status"] for row in content["rows"]] == ["failed", "computed", "computed"]


def test_designs_fill_their_ranges() -> None:
    """Sobol's points halve each range exactly, a Latin hypercube has one point in each of N slices."""
    ranges = {"load.axial": (300.0, 2000.0), "kinematics.spin_speed_rpm": "1000:24000"}
    for kind, slices in (("sobol:16", 2), ("lhs:12", 12)):
        design = sampled(ranges, kind, seed=3)
        assert design.listed and design == sampled(ranges, kind, seed=3) != sampled(ranges, kind, seed=4)
        for axis, (low, high) in zip(design.axes, ((300.0, 2000.0), (1000.0, 24000.0)), strict=True):
            counts = np.bincount(((axis.column - low) / (high - low) * slices).astype(int), minlength=slices)
            assert (counts == design.size // slices).all()
    swept = rw.sweep(STATIC, ranges, design="sobol:8", seed=3)
    assert swept.sizes["point"] == 8 and (swept.status == "computed").all()
    with pytest.raises(rw.SceneError, match="must be ranges"):
        rw.sweep(STATIC, [{"load.axial": 300.0}], design="sobol:8")


@pytest.mark.parametrize("words, message", [
    (["--design", "sobol:9", "--range", "load.axial=1:2"], "N a power of 2 such as 1024"),
    (["--design", "halton:8", "--range", "load.axial=1:2"], "must be sobol:N"),
    (["--range", "load.axial=1:2"], "must be sobol:N"), (["--design", "lhs:8"], "are missing: lhs:8 fills ranges"),
    (["--design", "lhs:8", "--range", "load.axial=2:1"], "must be a range low:high of numbers"),
    (["--grid", "load.axial=1:2:2", "--plot", "kyy", "--kind", "map"], "takes two axes with numbers"),
    (["--grid", "load.axial=1:2:2", "--plot", "kxz"], "is not a quantity of this sweep"),
])  # fmt: skip
def test_what_cannot_be_given_is_refused_before_anything_is_computed(words: list[str], message: str, tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text('[bearing]\npreset = "B7206C"\n[load]\naxial = 1.0\n')
    refused = invoke("sweep", tmp_path / "s.toml", *words, "--out", tmp_path / "s")
    assert refused.exit_code == 2 and message in " ".join(refused.stderr.split())
    assert not (tmp_path / "s").exists()


def test_symbols_of_the_table_can_be_drawn(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text('[bearing]\npreset = "B7206C"\n[load]\naxial = 1.0\n')
    shown = invoke("sweep", tmp_path / "s.toml", "--grid", "load.axial=300,400", "--plot", "kyy", "--out", tmp_path / "s")
    assert shown.exit_code == 0 and (tmp_path / "s" / "stiffness-y-y-curves.png").stat().st_size > 0


def test_too_many_points_are_refused_with_bytes_or_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    axes = {"load.axial": np.linspace(300.0, 2000.0, 1000), "rotor.mass": np.linspace(1.0, 2.0, 1000)}
    with pytest.raises(rw.RacewayError, match=r"1000000 runs would take about \d+ [dh]"):
        rw.sweep({**STATIC, **ROTATING, "integrator": {"kind": "newmark", "turns": 1000}}, axes)
    monkeypatch.setattr("raceway.points.function.available_bytes", lambda: 1e8)
    with pytest.raises(rw.RacewayError, match=r"1000000 points need 6\.64e\+08 bytes .*, of 1e\+08 available"):
        rw.sweep(STATIC, axes)
