"""Third parties' bodies, integrators and identifiers take the compiled loops over points where they declare what these need."""

import sys

import attrs
import numpy as np
import pytest

import raceway as rw
from checks.validation.scenes import built_in
from raceway.extend import K, blamed
from raceway.testing import default_registry

Periodic = built_in("integrator", "periodic")
Rigid = built_in("bodies", "rigid")
Fft1x = built_in("identifier", "fft_1x")

SCENE = {
    "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "rotor": {"mass": 1.0},
    "excitation": {"kind": "bidirectional", "speed_rpm": 9000.0, "unbalance": 1e-5}, "integrator": {"kind": "periodic"},
}  # fmt: skip


@attrs.frozen
class Own:
    """Bodies of no built-in class, which say nothing of columns."""

    name = "own"
    faults, traits, stable_step, decide, cost, build = (
        getattr(Rigid, duty) for duty in ("faults", "traits", "stable_step", "decide", "cost", "build")
    )


@attrs.frozen
class OwnColumns(Own):
    name = "own_columns"
    columns = Rigid.columns

    def why_no_columns(self, problem, key):
        return "diamond does not shrink" if key == "bearing.balls.young" else ""


@attrs.frozen
class Rebuilt(Rigid):
    """Other bodies, of which the inherited columns know nothing."""

    name = "rebuilt"

    def build(self, problem, plan):
        return super().build(problem, plan)


Again, Transient = (
    attrs.frozen(type("Again", (Periodic,), {"name": f"again_{yes}", "orbit": yes})) for yes in (True, False)
)
Lines, Secants = (
    attrs.frozen(type("Lines", (Fft1x,), {"name": f"lines_{yes}", "synchronous": yes})) for yes in (True, False)
)


@pytest.fixture(autouse=True)
def theirs():
    kinds = {"bodies": [Own, OwnColumns, Rebuilt], "integrators": [Again, Transient], "identifiers": [Lines, Secants]}
    hooks = {f"raceway_{kind}": rw.hookimpl(lambda self, found=found: found) for kind, found in kinds.items()}
    default_registry().add(type("Theirs", (), hooks)(), "theirs")


def test_what_declares_it_takes_the_compiled_loop_with_the_numbers_of_runs():
    scene = SCENE | {k: {"kind": p.name} for k, p in (("bodies", OwnColumns), ("integrator", Again), ("identifier", Lines))}
    f = rw.function(scene, ["load.axial"], [K.name])
    answer = f([600.0, 1000.0])
    assert not f.why_slow and (answer["status"] == rw.PointStatus.COMPUTED).all()
    # Orbits to 1e-7 of the motion in the run, to 1e-8 of its 1x component in the loop.
    assert answer[K.name][1] == pytest.approx(K.of(rw.run(scene)), rel=1e-6)
    assert np.array_equal(answer[K.name], rw.function(SCENE, ["load.axial"], [K.name])([600.0, 1000.0])[K.name])
    assert rw.function(scene, ["bearing.balls.young"], [K.name]).why_slow == "diamond does not shrink"


@pytest.mark.parametrize(("table", "plugin", "why"), [
    ("bodies", Own, "in full"), ("bodies", Rebuilt, "in full"), ("integrator", Transient, "over time"),
    ("identifier", Secants, "not of synchronous"),
])  # fmt: skip
def test_what_declares_nothing_is_run(table, plugin, why):
    f = rw.function(SCENE | {table: {"kind": plugin.name}}, ["load.axial"], [K.name])
    assert why in f.why_slow and f(1000.0)["status"] == rw.PointStatus.RUN


def test_laws_and_sweeps_ask_for_traits_and_not_for_names(monkeypatch):
    monkeypatch.setattr("raceway.points.engine._OWN", {(): default_registry()})
    scene = {"bearing": SCENE["bearing"], "load": SCENE["load"], "bodies": {"kind": "own_columns"}}
    assert rw.law("hertz", scene).rows == rw.law("hertz", {**scene, "bodies": {"kind": "rigid"}}).rows
    assert set(rw.sweep(scene, {"load.axial": [400.0, 900.0]})["status"].values.tolist()) == {"computed"}


def test_standard_output_is_itself_again_whichever_thread_leaves_last():
    out, first, second = sys.stdout, blamed("one", "build()"), blamed("another", "build()")
    first.__enter__()
    second.__enter__()
    first.__exit__(None, None, None)
    assert sys.stdout is sys.stderr
    second.__exit__(None, None, None)
    assert sys.stdout is out
