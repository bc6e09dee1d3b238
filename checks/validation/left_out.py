"""What leaving out saves.

A row for each rule of the plan: a scene that does not need a part, run as planned and with the part forced in; the answers'
difference, processor time and memory of both.  Times are the least of some repeats, in this process with warm kernels;
modules and pictures are measured in processes of their own.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import attrs
import numpy as np

SCENE = str(Path(__file__).resolve().parents[2] / "examples" / "b7206.toml")
_REPEATS = 5
#: A rule counts as saving from this share on, and from what is more than a clock's and an allocator's noise.
MARGIN = 0.05
LEAST_S = 1e-4
LEAST_BYTES = 2**16


@attrs.frozen
class Rule:
    """One rule of leaving out, measured.

    Attributes
    ----------
    rule, scene : the part that is left out, and the changes of the example in which it is
    difference : largest relative difference of the answers;  bound : what it may be, with ``why``
    cpu_s, cpu_forced_s, bytes, bytes_forced : as planned and with the part forced in
    spread_s : the larger of both kinds' differences between the median and the least of their times
    must_save : whether it only holds with a saving: its answers hardly can differ, so that a part that is not left out
        at all would not be seen by them
    """

    rule: str
    scene: str
    difference: float
    bound: float
    why: str
    cpu_s: float
    cpu_forced_s: float
    bytes: int
    bytes_forced: int
    spread_s: float = 0.0
    must_save: bool = False

    @property
    def holds(self) -> bool:
        """The answers are equal, and leaving out is no dearer than the noise of the times, or saves where it must."""
        if self.must_save:
            return self.saves
        return self.difference <= self.bound and self.cpu_s <= self.cpu_forced_s + self._noise

    @property
    def saves(self) -> bool:
        """Time by more than a margin, the spread of the times and what a clock tells, or memory by more than a margin."""
        faster = self.cpu_forced_s - self.cpu_s > self._noise
        return self.difference <= self.bound and (faster or self.smaller)

    @property
    def smaller(self) -> bool:
        """Memory by more than a margin and what an allocator tells: other programs on the machine do not change it."""
        return self.bytes_forced - self.bytes > max(MARGIN * self.bytes_forced, LEAST_BYTES)

    @property
    def _noise(self) -> float:
        """Differences of times that tell nothing [s]."""
        return max(MARGIN * self.cpu_forced_s, self.spread_s, LEAST_S)


Answer = np.ndarray


def measured(work: Callable[[], Answer], repeats: int = _REPEATS) -> tuple[Answer, float, int, float]:
    """Answer, least processor time [s], peak of the memory that Python and its arrays take [bytes], spread of the times [s]."""
    answer = work()
    times = []
    for _ in range(repeats):
        begun = time.process_time()
        answer = work()
        times.append(time.process_time() - begun)
    tracemalloc.start()
    work()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return answer, min(times), peak, spread(times)


def spread(times: list[float]) -> float:
    """Median less the least: what the machine adds to half of the repeats."""
    return float(np.median(times)) - min(times)


def compared(
    rule: str, scene: str, planned: Callable[[], Answer], forced: Callable[[], Answer], bound: float = 1e-10,
    why: str = "the same numbers", repeats: int = _REPEATS, must_save: bool = False,
) -> Rule:  # fmt: skip
    a, cpu, peak, noise = measured(planned, repeats)
    b, cpu_forced, peak_forced, noise_forced = measured(forced, repeats)
    difference = float(np.max(np.abs(a - b)) / np.max(np.abs(b)))
    noise = max(noise, noise_forced)
    return Rule(rule, scene, difference, bound, why, cpu, cpu_forced, peak, peak_forced, noise, must_save)


def answers(changes: tuple[str, ...], force: tuple[str, ...] = (), cage: float | None = None) -> Answer:
    """Dynamic stiffness (real, imaginary) of the example, from its scene on, with some parts forced in."""
    from raceway import build_model, load_scene, make_plan
    from raceway.extend import CAGE
    from raceway.testing import simulate, solve_equilibrium

    scene = load_scene(SCENE, changes)
    plan = make_plan(scene, force)
    model = build_model(scene, plan)
    if cage is not None:
        model.system.scalars[CAGE] = cage
    equilibrium = solve_equilibrium(model)
    records = [simulate(model, equilibrium).record] if plan.turns > 0 else []
    found = scene.identifier.method.identify(records, equilibrium, model)
    return np.array([found.dynamic_stiffness.real, found.dynamic_stiffness.imag])


def _forced(
    rule: str, part: str, changes: tuple[str, ...], bound: float = 1e-10, why: str = "the same numbers",
    must_save: bool = False,
) -> Rule:  # fmt: skip
    scene = " ".join(changes)
    return compared(
        rule, scene, lambda: answers(changes), lambda: answers(changes, (part,)), bound, why, must_save=must_save
    )


def tangential() -> Rule:
    return _forced("friction, gyroscopic moments of the balls", "friction", ())


def ball_inertia() -> Rule:
    return _forced("ball inertia", "centrifugal force of the balls", ("kinematics.spin_speed_rpm=0",))


def orbiting() -> Rule:
    def forced() -> Answer:
        return answers((), cage=1e-290)  # azimuths are computed anew each step, and stay

    return compared("orbiting balls", "", lambda: answers(()), forced, repeats=3 * _REPEATS)


def tilts() -> Rule:
    stiff = ("supports.tilt=1e9",)
    why = "1e9 N m/rad lets the ring tilt by a thousandth of what its contacts would"
    return compared("tilts", "supports.tilt=1e9 instead of locked", lambda: answers(()), lambda: answers(stiff), 1e-4, why)


def coupled() -> Rule:
    part = "interaction of balls through the rings"
    why = "stated in the plan: less than 1e-3 of a contact's compliance"
    return _forced(part, part, ("bodies.kind=condensed",), 1e-3, why)


def turns() -> Rule:
    return _forced("11 of 12 turns of a series of equilibria", "other turns", ("integrator.kind=quasi_static",))


def pitch() -> Rule:
    direct = ("integrator.kind=periodic", "load.axial=400", "excitation.amplitude=constant", "excitation.force=1500")
    whole = (*direct, "integrator.symmetry=none")
    why = "both orbits are known to their tolerance of 1e-7"
    return compared(
        "a whole turn where one ball pitch does",
        " ".join(direct),
        lambda: answers(direct),
        lambda: answers(whole),
        1e-6,
        why,
    )


def integration() -> Rule:
    """An identifier that needs the equilibrium only gets a record all the same."""
    part, changes = "time integration (newmark)", ("integrator.kind=newmark", "identifier.kind=tangent")
    return _forced("time integration", part, changes, must_save=True)


def history() -> Rule:
    from raceway import build_model, load_scene, make_plan
    from raceway.extend import Schedule, at_rest, integrate
    from raceway.planning.resolve import recorded_per_turn
    from raceway.testing import solve_equilibrium

    per_turn, many = 2880, 50
    scene = load_scene(SCENE, ("integrator.kind=central_difference",))
    model = build_model(scene, make_plan(scene))
    equilibrium = solve_equilibrium(model)

    def run(stride: int) -> Answer:
        start = at_rest(model.system, equilibrium.displacement, equilibrium.ball, True)
        period = scene.excitation.period_s
        record = integrate(
            scene.integrator.method, model.system, start, Schedule(period / per_turn, per_turn, many, stride, 40.0 * period)
        )
        found = scene.identifier.method.identify([record.last(5)], equilibrium, model)
        return np.array([found.dynamic_stiffness.real, found.dynamic_stiffness.imag])

    stride = per_turn // recorded_per_turn(per_turn, many)
    what = f"integrator.steps_per_turn={per_turn} integrator.turns={many}"
    return compared(
        "history of every step", what, lambda: run(stride), lambda: run(1), 1e-9, "one line of both samplings", 2
    )


def compliances() -> Rule:
    """Compliances made once for all balls and contacts, and once for each ball, nothing kept in memory or on disk."""
    from raceway import load_scene
    from raceway.core.fem import structural
    from raceway.extend import make_basis, resolve
    from raceway.plugins.bodies.condensed_bearing import BODIES_BY_SECTION, elastic_bodies

    problem = resolve(load_scene(SCENE, ("bodies.kind=condensed",)))
    basis, count = make_basis(problem), problem.bearing.ball_count

    def run(times: int) -> Answer:
        kept, structural.kept = structural.kept, _not_kept
        found = []
        try:
            for _ in range(times):
                BODIES_BY_SECTION.clear()
                bodies = elastic_bodies(problem, basis)
                found.append(np.concatenate([bodies.inner.direct, bodies.outer.direct, [bodies.ball_direct]]))
        finally:
            structural.kept = kept
        return np.array(found if times == count else found * count)

    what = "a compliance per ball and contact"
    return compared(what, "bodies.kind=condensed", lambda: run(1), lambda: run(count), repeats=1, must_save=True)


def _not_kept(*words: Any, **more: Any) -> Any:
    """In the place of the cache of arrays: computes anew."""
    return next(word for word in (*words, *more.values()) if callable(word))()


def mirror() -> Rule:
    """Harmonics of a ring: as it is, each is Hermitian; its mirror planes make it real."""
    from scipy.sparse import diags_array

    from raceway import load_scene
    from raceway.core.fem.revolution.body import Revolution, symmetric_factors
    from raceway.core.fem.structural import ring_section
    from raceway.extend import ring_shape

    bearing = load_scene(SCENE).bearing
    profile = ring_section(ring_shape(bearing, inner=False), bearing.ball_diameter)
    body = Revolution(profile, 16 * bearing.ball_count, bearing.rings.young, bearing.rings.poisson, 1.0)
    turn = np.where(body.unknowns % 3 == 1, 1j, 1.0)  # circumferential displacements are counted in units of i
    loads = np.eye(len(turn))[:, np.searchsorted(body.unknowns, 3 * profile.race)]
    real = [body.harmonic(n) for n in range(0, 13, 3)]
    whole = [(diags_array(turn) @ one @ diags_array(turn.conj())).tocsc() for one in real]

    def halves() -> Answer:
        return np.array([symmetric_factors(one, ordered=False).solve(loads) for one in real])

    def both() -> Answer:
        pushed = turn[:, None] * loads
        found = (symmetric_factors(one, ordered=False).solve(pushed) for one in whole)
        return np.array([turn.conj()[:, None] * one for one in found])

    why = "the same systems, solved in complex numbers"
    return compared("other mirror half", "bodies.kind=condensed, five harmonics of a ring", halves, both, 1e-9, why, 2)


def stresses() -> Rule:
    """One sample of the motion of elastic bodies: its nodal forces, or these and the stresses in all elements.

    Both give the same integral of the stress over each body, sum of x f^T: each checks the other.
    """
    from raceway import build_model, load_scene, make_plan
    from raceway.core.fem.hexahedron.shape import mean_gradients

    changes = (
        "bodies.kind=elastic", "contact.discretisation=nodal", "mesh.kind=structured", "mesh.nodes_per_semi_axis=1",
        "mesh.element_size=3.2e-3", "mesh.growth=3.0", "bearing.ball_count=6", "bodies.formulation=one_point",
    )  # fmt: skip
    scene = load_scene(SCENE, changes)
    model = build_model(scene, make_plan(scene))
    bodies = model.system.bodies
    from raceway.extend import surrogate

    place, places, _ = surrogate(model.system).solve_equilibrium(model.guess)
    system, y = bodies.system, bodies.guess(place, places)
    y += 1e-8 * np.random.default_rng(1).standard_normal(len(y))  # the guess moves rigid bodies: nothing to recover
    operators = [body.operator for body in system.assembly.bodies]
    volumes = [mean_gradients(one.points[one.cells])[1] for one in operators]

    def sample(recovers: bool) -> Answer:
        system.locate(y)
        system.static_internal(y)
        bodies.look(y, np.zeros_like(y))
        u = system.assembly.nodal(y)
        parts = [u[system.assembly.part(k)] for k in range(len(operators))]
        forces = [one.internal_force(part).reshape(-1, 3) for one, part in zip(operators, parts, strict=True)]
        if recovers:
            stress = (one.stress(part) for one, part in zip(operators, parts, strict=True))
            return np.array([volume @ sigma for volume, sigma in zip(volumes, stress, strict=True)])
        tensor = (one.points.T @ force for one, force in zip(operators, forces, strict=True))
        return np.array([[t[0, 0], t[1, 1], t[2, 2], t[0, 1], t[1, 2], t[2, 0]] for t in tensor])

    what = "bodies.kind=elastic, one sample of 12 000 elements"
    why = "the integral of the stress over a body is the sum of x f^T over its nodes"
    return compared("stress recovery", what, lambda: sample(False), lambda: sample(True), 1e-9, why, must_save=True)


_PROBE = """
import contextlib, io, json, pathlib, resource, sys, tempfile, time
from raceway.core.time.schemes import integrate
from raceway.cli.main import main
from raceway.framework.registry import default_registry
registry = default_registry()
begun = time.process_time()
{before}
with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
    with contextlib.suppress(SystemExit):  # a failure leaves no result
        main(["run", *sys.argv[1:], "--out", folder])
    z = json.loads((pathlib.Path(folder) / "result.json").read_text())["identification"]["dynamic_stiffness"]
cpu = time.process_time() - begun
try:  # of this program alone: ru_maxrss hands on what its parent took
    lines = open("/proc/self/status").read().splitlines()
    peak = 1024 * int(next(line for line in lines if line.startswith("VmHWM")).split()[1])
except OSError:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
print(json.dumps([z["real"], z["imag"], cpu, peak]))
"""
_MODULES = """
for entry in registry.all():
    plugin = entry.plugin
    if hasattr(plugin, "kernel"):
        try:
            (plugin.examples()[0] if hasattr(plugin, "examples") else plugin()).kernel()
        except TypeError:
            pass  # needs options
from raceway.core.ring.kernels import condensed, rigid_inertial, rigid_tangential, rigid_weightless
import raceway.core.time.compiled, raceway.core.time.compiled, raceway.core.time.compiled
from raceway.core.periodic import steady
from raceway.core.fem.hexahedron import operator
import gmsh, matplotlib.figure, meshio, pyvista
"""


def _in_processes(rule: str, before: str = "", words: tuple[str, ...] = ()) -> Rule:
    """``raceway run`` as it is, and after some work in the same process or with more words."""

    def run(forced: bool) -> list[float]:
        program = _PROBE.format(before=before if forced else "")
        command = [sys.executable, "-c", program, SCENE, *(words if forced else ())]
        return list(json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout))

    run(True)  # kernels are compiled and libraries read once
    plain, forced = ([run(kind) for _ in range(3)] for kind in (False, True))
    a, b = np.array(plain[0][:2]), np.array(forced[0][:2])
    cpu, cpu_forced = (min(one[2] for one in found) for found in (plain, forced))
    size, size_forced = (int(min(one[3] for one in found)) for found in (plain, forced))
    noise = max(spread([one[2] for one in found]) for found in (plain, forced))
    apart = float(np.abs(a - b).max() / np.abs(b).max())
    return Rule(rule, " ".join(words), apart, 1e-10, "the same numbers", cpu, cpu_forced, size, size_forced, noise, True)


def pictures() -> Rule:
    return _in_processes("pictures", words=("--pictures",))


def modules() -> Rule:
    return _in_processes("modules of plug-ins and kernels that the scene does not name", _MODULES)


RULES: dict[str, Callable[[], Rule]] = {
    one.__name__: one
    for one in (
        tangential, ball_inertia, orbiting, tilts, coupled, turns, pitch, integration, history, compliances,
        mirror, stresses, pictures, modules,
    )
}  # fmt: skip


def planning() -> float:
    """Processor time of a plan [s], of the kind of bodies that takes longest."""
    from raceway import load_scene, make_plan

    worst = 0.0
    coarse = ("mesh.nodes_per_semi_axis=1", "mesh.element_size=3.2e-3", "mesh.growth=3.0")
    nodal = ("contact.discretisation=nodal", "mesh.kind=structured")
    for changes in (
        (),
        ("bodies.kind=condensed",),
        ("bodies.kind=condensed", *nodal),
        ("bodies.kind=elastic", *nodal, *coarse),
    ):
        scene = load_scene(SCENE, changes)
        times = []
        for _ in range(_REPEATS):
            begun = time.process_time()
            make_plan(scene)
            times.append(time.process_time() - begun)
        worst = max(worst, min(times))
    return worst
