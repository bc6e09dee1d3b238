"""Hypotheses, warnings and small forces."""

import time
from itertools import product

import numpy as np
import pytest

import raceway as rw
from checks.validation.command_line import python
from checks.validation.scenes import small_force

pytestmark = pytest.mark.night

BEARINGS = ("7000C", "7003A5", "B7206C", "7206A", "7008C", "7010A", "7014C", "7014A", "7020A5", "7910C", "7210A5", "7920A5")
#: Speed times pitch diameter [mm r/min], and axial load over the square of the ball's diameter [Pa], a ball.
SPEEDS, LOADS = (0.3e6, 0.6e6, 0.9e6, 1.2e6), (0.4e6, 2.0e6)


def bearing_of(name):
    return rw.scene_from_dict({"bearing": {"preset": name}, "load": {"axial": 1.0}}).bearing


def scene_of(bearing: int, speed: int):
    """Loads light and heavy, tilts locked and free, forces turning and along one direction; K passes resonances of the tilts."""
    b = bearing_of(BEARINGS[bearing])
    axial, size = LOADS[(bearing + speed) % 2] * b.ball_count * b.ball_diameter**2, b.pitch_diameter / 46e-3
    return rw.scene_from_dict(
        {
            "bearing": {"preset": BEARINGS[bearing]}, "load": {"axial": axial},
            "supports": {"tilt": ("locked", "free")[(bearing + speed) // 2 % 2]},
            "rotor": {"mass": 2.0 * size**2, "transverse_inertia": 1e-3 * size**4},
            "excitation": {"kind": ("bidirectional", "unidirectional")[bearing // 2 % 2],
                "speed_rpm": 1e-3 * SPEEDS[speed] / b.pitch_diameter, "amplitude": "constant",
                "force": (0.4 if (bearing + 2 * speed) % 3 else 0.1) * axial},
            "contact": {"damping": 0.001},
        }
    )  # fmt: skip


def spread_and_runs(one):
    """Distance of ``error.model`` from complete runs over their spread, of K and of kyy, and change of kyy over its bound."""

    def answers(result):
        return np.array([result.equivalent_stiffness, result.stiffness[1, 1]])

    own = rw.run(one)
    stated, base = own.model_spread[0], answers(own)
    others = [pair for pair in product(("none", "outer_race", "shared"), (False, True)) if pair != ("none", False)]
    runs = (rw.run(one.with_(kinematics={"gyroscopic": moments, "ring_growth": growth})) for moments, growth in others)
    change = np.array([(answers(each) - base) / np.abs(base) for each in runs])
    ends = np.array([np.minimum(change.min(axis=0), 0.0), np.maximum(change.max(axis=0), 0.0)])
    parts = np.array([stated["equivalent_stiffness"] or [np.nan, np.nan], stated["kyy"]])
    off = np.abs(parts.T - ends).max(axis=0) / (ends[1] - ends[0])
    return *off, max(map(abs, stated["kyy"])) / stated["bound"]


def test_hypotheses_left_at_their_defaults(claim):
    found = np.array([spread_and_runs(scene_of(*place)) for place in product(range(len(BEARINGS)), range(len(SPEEDS)))])
    where = f"error.model of {len(found)} scenes, 12 bearings at 4 speeds"
    source = "no steady orbit under a hypothesis where balls lift off at every turn: one in ten"
    lost = int(np.isnan(found[:, 0]).sum())
    claim(f"{where}: those without a range of K", lost, at_most=0.1 * len(found), basis="regression", source=source)
    off = np.nanmax(found[:, :2])
    quantity, source = (
        f"{where}: distance of K and kyy from complete runs over their spread, largest", "runs under each hypothesis",
    )  # fmt: skip
    claim(quantity, off, at_most=0.01, basis="own other method", source=source)
    quantity, source = f"{where}: change of kyy over its closed bound, largest", "a bound"
    claim(quantity, found[:, 2].max(), at_most=1.0, basis="closed form", source=source)


def least(*works, count=40):
    """Processor time of each by turns, after one that warms what is kept [s]: a busy machine slows all alike."""
    times = [[] for _ in works]
    for _ in range(count + 1):
        for work, spent in zip(works, times, strict=True):
            begun = time.process_time()
            work()
            spent.append(time.process_time() - begun)
    return [min(spent[1:]) for spent in times]


def test_cost_of_hypotheses(claim):
    base = rw.load_scene("examples/b7206.toml")
    ratios, spent = [], []
    for changes in ({}, {"excitation": {"kind": "unidirectional"}}, {"supports": {"tilt": "free"}}):
        one = base.with_(**changes)
        alone, both = least(lambda one=one: rw.run(one), lambda one=one: rw.run(one).model_spread)
        ratios.append(both / alone)
    for changes in ({"integrator": {"kind": "periodic"}}, {"excitation": None, "kinematics": {"spin_speed_rpm": 12e3}}):
        one = base.with_(**changes)
        alone, both = least(lambda one=one: rw.run(one), lambda one=one: rw.run(one).model_spread)
        spent.append(both - alone)
    source = "computed when asked for, not in sweeps"
    quantity = "processor time of a transient run with error.model over one without, three scenes: largest"
    claim(quantity, max(ratios), at_most=1.2, basis="regression", source=source)
    quantity = "processor time of error.model beside a steady orbit and at rest: larger"
    claim(quantity, 1e3 * max(spent), at_most=50.0, unit="ms", basis="regression", source=source)


def test_no_warnings_of_usual_scenes(claim):
    """Loads over Z D^2 12 MPa, about the static rating, axial and radial, and speeds n d_m; preload of sets 2 %."""
    words = (
        "loose on its shaft", "lifts off", "loses axial contact", "contact pressure", "is more than", "not resolved", "error of Z is", "deviates from Hertz's"
    )  # fmt: skip
    count, alarms = 0, []
    for name in ("7001C", "7005A", "7008C", "7014A", "7020C", "7206A", "7216A", "7230C", "B7206C"):
        own = bearing_of(name)
        rating = 12e6 * own.ball_count * own.ball_diameter**2
        for arrangement in ("single", "DB", "TBT"):
            bearing = {"preset": name, "arrangement": arrangement}
            bearing |= {} if arrangement == "single" else {"preload": 0.02 * rating}
            for axial, radial, ndm in ((0.03, 0.0, 3e5), (0.03, 0.02, 1e5), (0.1, 0.1, 1e5), (0.02, 0.05, 0.0)):
                load = {"axial": axial * rating, "radial": [radial * rating, 0.0]}
                spin = {"spin_speed_rpm": ndm / (1e3 * own.pitch_diameter)}
                said = rw.run({"bearing": bearing, "load": load, "kinematics": spin}).warnings
                alarms += [text for text in said if any(word in text for word in words)]
                count += 1
    assert not alarms, alarms[:3]
    quantity = (
        f"warnings of lift-off, pressure, fits, units and errors on {count} scenes with usual loads, speeds and preloads"
    )
    claim(quantity, len(alarms), at_most=0, basis="closed form", source="nothing is wrong with them")


def test_small_forces(claim):
    """Of what a motion is off the tangent for its own size, the square of the force is taken off."""
    ratios, last = [], []
    for changes in (
        {}, {"kinematics": {"ball_inertia": False}}, {"kinematics": {"gyroscopic": "outer_race"}}, {"load": {"radial": [300.0, 0.0]}},
        {"supports": {"tilt": "free"}}, {"contact": {"time_constant": 1e-5}},
    ):  # fmt: skip
        tangent = small_force("tangent", "periodic", 1e-4, changes).identification.dynamic_stiffness
        for share in (1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3):
            result = small_force("fft_1x", "periodic", share, changes)
            off = abs(result.identification.dynamic_stiffness / tangent - 1.0)
            ratios.append(max(off - share**2, 0.0) / result.error["total"])
        last.append(off)
    where, source = "steady orbits under 1e-8 to 1e-3 of the preload, six kinds of scenes", "tangent"
    quantity = f"{where}: distance of Z over the stated error, largest"
    claim(quantity, max(ratios), at_most=1.0, basis="own other method", source=source)
    quantity = f"{where}: relative distance of Z at 1e-3"
    claim(
        quantity, max(last), at_most=1e-6, basis="own other method",
        source=f"{source}; it falls with the square of the force",
    )  # fmt: skip
    ratios, last = [], []
    for integrator in ("newmark", "generalized_alpha"):
        tangent = small_force("tangent", integrator, 1e-4).identification.dynamic_stiffness
        for share in (1e-6, 1e-5, 1e-4):
            result = small_force("fft_1x", integrator, share)
            off = abs(result.identification.dynamic_stiffness / tangent - 1.0)
            ratios.append(off / result.error["total"])
        last.append(off)
    where = "newmark and generalized_alpha under 1e-6 to 1e-4 of the preload"
    quantity = f"{where}: distance of Z over the stated error, largest"
    claim(quantity, max(ratios), at_most=3.0, basis="own other method", source=source)
    claim(f"{where}: relative distance of Z at 1e-4", max(last), at_most=1e-6, basis="own other method", source=source)


#: A process for each; ``ru_maxrss`` of a child begins with its parent's peak, VmHWM with its own program.
MEMORY = """
import re, sys
from pathlib import Path
import raceway as rw
scene = rw.evolve("examples/b7206_elastic_coarse.toml", *sys.argv[1:])
try:
    rw.run(scene)
except rw.ConvergenceError:
    pass
peak = 1024 * int(re.search(r"VmHWM:\\s+(\\d+) kB", Path("/proc/self/status").read_text())[1])
print(peak / rw.make_plan(scene).predicted_bytes)
"""


def test_memory_of_elastic_bodies(claim):
    """Contacts ten times as large as the mesh is made for; some 90 iterations with friction; friction that does not converge."""
    base = ("contact.discretisation=nodal", "mesh.nodes_per_semi_axis=1", "load.axial=6000", "contact.kind=penalty")
    friction, ratios = ("contact.friction=0.5", "load.radial=[50000,0]"), []
    for changes in (
        ("contact.stiffness=1e12",),
        ("contact.stiffness=1e11", *friction),
        ("contact.stiffness=1e19", *friction),
    ):
        done = python("-c", MEMORY, *base, *changes)
        assert done.returncode == 0, done.stderr
        ratios.append(float(done.stdout))
    quantity = (
        "elastic bodies whose contacts are far larger than their mesh is made for: peak of memory over the plan's, largest"
    )
    claim(quantity, max(ratios), at_most=2.0, basis="regression", source="a plan is good for a factor of 2")
