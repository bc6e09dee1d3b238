"""The conformance suite of integrators, on small systems whose motion is known.

Methods that solve for the steady motion (``steady``) are compared with its closed form and with another integration, and must state
an error that holds; all others are tried on transients.
"""

import attrs
import numpy as np

from raceway.core.record import Motion, Record, Schedule
from raceway.core.ring.system import System
from raceway.core.time.schemes import Drivers, integrate
from raceway.errors import ConvergenceError, RacewayError, StabilityError
from raceway.framework.contracts import Integrator
from raceway.framework.duties import finds_orbit
from raceway.points.column_quantities import SteadyLines
from raceway.scene.scene import scene_from_dict
from raceway.testing.suite import Suite, b7206c, check_class, duty, require, settled
from raceway.testing.systems import (
    NATURAL,
    PERIOD,
    PRELOAD,
    SPEED,
    along_x,
    contact_energy,
    contact_system,
    counting_system,
    exact,
    linear_system,
    motion,
)

#: An error that a record states may be short of the true one by this factor; below the floor, rounding decides.
_SHORTFALL, _FLOOR = 3.0, 1e-9
_TURN = 2.0 * np.pi / SPEED
_X = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
_Y = np.array([0.0, 1.0, -0.4, 0.0, 0.0])


@attrs.frozen
class FromPython:
    """An integrator without its compiled driver: the same steps from Python."""

    method: Integrator

    @property
    def scheme(self) -> Drivers:
        return Drivers(stepped=self.method.scheme.stepped)


def has_both(method: Integrator) -> bool:
    """Whether a scheme has a compiled and a stepped driver."""
    return method.scheme.compiled is not None and method.scheme.stepped is not None


class _Stop(Exception):
    """What a user's progress function may raise."""


def _no_transient(method: Integrator) -> str:
    if not method.inertial:
        return "no inertia: see equilibria"
    return "solves for the steady motion: no transient" if method.steady else ""


def _resting(system: System) -> np.ndarray:
    """(5,) where the system would rest."""
    return (PRELOAD / float(system.law_params[0, 0])) ** (2.0 / 3.0) * _X if system.free[0] > 0.0 else np.zeros(5)


def _start(method: Integrator, system: System) -> Motion:
    """Away from rest, along y and z or along x around the static approach; without inertia, the equilibrium at time zero."""
    if not method.inertial:
        q, ball, _ = attrs.evolve(system, load=system.load + system.outer_force(0.0)).solve_equilibrium(np.zeros(5))
        return Motion(q, np.zeros(5), np.zeros(5), ball, ball.copy())
    if system.free[0] > 0.0:
        return motion(system, 1.3 * _resting(system), np.zeros(5))
    return motion(system, 1e-6 * _Y, 0.2e-6 * NATURAL * _Y[::-1].copy() * system.free)


def _coordinates(method: Integrator) -> tuple[str, ...]:
    """Arrays of a record that a method computes."""
    return ("displacement", "velocity") if method.inertial else ("displacement",)


def _apart(a: np.ndarray, b: np.ndarray) -> float:
    """Largest difference over the largest of a."""
    return float(np.abs(a - b).max() / max(np.abs(a).max(), 1e-300))


class IntegratorSuite(Suite):
    """Duties of ``raceway.framework.contracts.Integrator``."""

    kind = "integrator"

    @duty("attributes: order, implicit, inertial, dissipative, options; steady, scheme")
    def test_declaration(self, method: Integrator) -> None:
        check_class("integrator", method)
        require(type(method.order) is int and method.order >= 1, f"`order` = {method.order!r} must be 1 or more")
        for word in ("implicit", "inertial", "dissipative", "steady"):
            require(type(getattr(method, word)) is bool, f"`{word}` must be True or False")
        drivers = (getattr(method.scheme, word, None) for word in ("compiled", "stepped"))
        require(any(map(callable, drivers)), "`scheme` has no driver: give it `compiled`, `stepped` or both")

    @duty("a Record of every stride-th step with time, force, motion and counts; start and system untouched")
    def test_record(self, method: Integrator) -> None:
        system = linear_system()
        start, schedule = _start(method, system), Schedule(dt=_TURN / 60, steps_per_turn=60, turns=3, stride=3)
        inputs = (start.q, start.v, start.a, system.load, system.law_state, system.mass)
        before = [array.copy() for array in inputs]
        record = integrate(method, system, start, schedule)
        require(isinstance(record, Record), f"the scheme returns {type(record).__name__}, not a Record")
        times = schedule.dt * 3.0 * np.arange(1, 61)
        require(record.time.shape == (60,), f"{len(record.time)} samples of 180 steps with stride 3; there must be 60")
        require(np.allclose(record.time, times, rtol=1e-12), "`time` is not stride * dt * (1, 2, ...)")
        force = np.array([system.outer_force(t) for t in times])
        require(np.allclose(record.force, force, rtol=0, atol=1e-9 * np.abs(force).max()), "`force` is not the excitation's")
        for word in ("displacement", "velocity"):
            values = getattr(record, word)
            require(values.shape == (60, 5) and np.isfinite(values).all(), f"`{word}` must be finite, (60, 5)")
            require(not values[:, [0, 3, 4]].any(), f"`{word}` moves coordinates that are held")
        require(record.contact_force.shape == (60, 2), "`contact_force` must be (samples, contacts)")
        require(np.allclose(record.final.q, record.displacement[-1]), "`final` is not the last sample")
        missing = {"steps", "evaluations", "max_penetration_m"} - set(record.counts)
        require(not missing, f"`counts` has no {', '.join(sorted(missing))}")
        if method.steady:
            _stated_error(record)
        else:
            require(record.counts["steps"] == 180, f"counts['steps'] = {record.counts['steps']}, not 180")
        require(all(map(np.array_equal, before, inputs)), "start or system were changed")

    @duty("converges with its `order` on a damped, forced, gyroscopic linear system", _no_transient)
    def test_order_linear(self, method: Integrator) -> str:
        return self._order(method, linear_system(), 2.0 * PERIOD, (48, 96, 192))

    @duty("converges with its `order` on a vibrating contact that stays closed", _no_transient)
    def test_order_contact(self, method: Integrator) -> str:
        return self._order(method, contact_system(), 4.0 * PERIOD, (96, 192, 384))

    @duty(
        "`steady`: the closed form of a linear system and the motion of a forced contact, within counts['error']",
        lambda method: "" if method.steady else "not steady",
    )
    def test_steady_motion(self, method: Integrator) -> str:
        system = linear_system()
        record = integrate(method, system, motion(system, np.zeros(5), np.zeros(5)), Schedule(_TURN / 36, 36, 1))
        free, force = np.flatnonzero(system.free > 0.0), system.outer_force(0.0) - 1j * system.outer_force(0.25 * _TURN)
        dynamic = system.stiffness - SPEED**2 * system.mass + 1j * SPEED * system.damping
        amplitudes = np.zeros(5, dtype=complex)  # of the displacement Re(x e^(j w t))
        amplitudes[free] = np.linalg.solve(dynamic[np.ix_(free, free)], force[free])
        off = record.displacement - (np.exp(1j * SPEED * record.time)[:, None] * amplitudes).real
        linear = _shortfall_words(np.abs(off).max() / np.abs(amplitudes).max(), _stated_error(record), "the closed form")
        # A mass pushed to and fro on a Hertzian contact, against an integration that begins at the record's end.
        resting = _resting(contact_system())
        speed = 0.4 * np.sqrt(1.5 * PRELOAD / resting[0] / float(contact_system().mass[0, 0]))
        system = attrs.evolve(contact_system(), force=along_x, force_params=np.array([0.5 * PRELOAD, speed]))
        record = integrate(method, system, motion(system, resting, np.zeros(5)), Schedule(2.0 * np.pi / speed / 36, 36, 1))
        q, _ = exact(system, record.final, record.time)
        # A turn passes the error on, once: twice the stated error lies between the two.
        apart = np.abs(q - record.displacement).max() / np.ptp(q[:, 0])
        return f"{linear}; {_shortfall_words(apart, _stated_error(record), 'an integration to 1e-11')}"

    @duty(
        "each sample is an equilibrium, where the method has no inertia",
        lambda method: "inertial" if method.inertial else "",
    )
    def test_equilibria(self, method: Integrator) -> None:
        system = linear_system()
        record = integrate(method, system, _start(method, system), Schedule(_TURN / 24, 24, 2))
        residual = record.displacement @ system.stiffness - record.force
        # The method's own tolerance is on the sum of forces; the springs alone carry the force here.
        worst = np.abs(residual).max() / np.abs(record.force).max()
        require(worst < 1e-6, f"the forces do not balance: {worst:.2g} of the excitation is left")

    @duty("an impact gives back the speed that the law gives back: all of it, for Hertz", _no_transient)
    def test_impact(self, method: Integrator) -> str:
        """A free mass at 0.1 m/s; the error falls as the step falls, to below 1 % at 800 steps a contact."""
        system = contact_system(load=0.0, clearance=1e-6)
        speed = 0.1
        k, m = float(system.law_params[0, 0]), float(system.mass[0, 0])
        # Duration of a Hertzian impact (Johnson, Contact Mechanics, 1985, section 11.4): 2.94 times depth over speed.
        depth = (1.25 * m * speed**2 / k) ** 0.4
        time = 2.94 * depth / speed + 4e-6 / speed
        errors = []
        for steps in (200, 800):
            record = integrate(method, system, motion(system, np.zeros(5), speed * _X), Schedule(time / steps, steps, 1))
            require(record.contact_force[-1, 0] == 0.0, "the mass has not left the contact when it should have")
            errors.append(abs(-record.velocity[-1, 0] / speed - 1.0))
        require(errors[1] < 0.01, f"at 800 steps a contact the rebound is wrong by {100 * errors[1]:.3g} %")
        falls = errors[1] <= max(errors[0], 1e-6)
        require(falls, f"the rebound's error grows as the step falls: {errors[0]:.2g}, {errors[1]:.2g}")
        return f"rebound wrong by {100 * errors[0]:.2g} % at 200 steps, {100 * errors[1]:.2g} % at 800"

    @duty("never gains energy in the long run; loses none unless `dissipative`", _no_transient)
    def test_energy(self, method: Integrator) -> str:
        notes = []
        for word, system in (("linear", linear_system(damped=False, forced=False)), ("contact", contact_system())):
            start = _start(method, system)
            at_rest = float(contact_energy(system, _resting(system)[None], np.zeros((1, 5)))[0])
            record = integrate(method, system, start, Schedule(PERIOD / 60, 60, 100))
            energy = contact_energy(system, record.displacement, record.velocity) - at_rest
            begin = float(contact_energy(system, start.q[None], start.v[None])[0]) - at_rest
            turns = energy.reshape(100, 60).mean(axis=1) / begin
            drift = turns[-10:].mean() - turns[:10].mean()
            # Energy swings by (w dt)^2 / 4 = 0.3 % within a turn at 60 steps; its mean must stay.
            require(drift < 2e-3, f"{word}: the energy grows by {100 * drift:.3g} % in 100 turns of 60 steps")
            excess = energy.max() / begin - 1.0
            require(excess < 0.02, f"{word}: the energy exceeds the start's by {100 * excess:.3g} %")
            if not method.dissipative:
                require(drift > -2e-3, f"{word}: {-100 * drift:.3g} % of the energy is lost: say dissipative = True")
            notes.append(f"{word} {100 * drift:+.2g} %")
        return "energy in 100 turns: " + ", ".join(notes)

    @duty(
        "the stable limit: explicit ones hold up to System.critical_time_step and say so above, implicit ones have none",
        _no_transient,
    )
    def test_stability(self, method: Integrator) -> None:
        system = linear_system(damped=False, forced=False)
        critical = system.critical_time_step(np.zeros((5, 5)))
        factor = 20.0 if method.implicit else 0.95
        record = integrate(method, system, _start(method, system), Schedule(factor * critical, 100, 5))
        largest, first = np.abs(record.displacement).max(), 2e-6
        # A velocity of 0.2 um times w may swing to a few times the first displacement near the limit.
        require(largest < 20.0 * first, f"at {factor:g} of the critical step the motion grows to {largest:.3g} m")
        if method.implicit:
            return
        try:
            coarse = Schedule(1.1 * critical, 1000, 2)
            growth = np.abs(integrate(method, system, _start(method, system), coarse).displacement)
        except StabilityError:
            return
        require(False, f"at 1.1 critical steps it reaches {growth.max():.3g} m without a StabilityError")

    @duty("2 N steps equal N steps and N more from Record.final; `steady`: the same motion from any start")
    def test_restart(self, method: Integrator) -> str:
        if method.steady:
            system = linear_system()
            moved = motion(system, np.array([0.0, 1e-6, -2e-6, 0.0, 0.0]), np.array([0.0, 3e-3, 1e-3, 0.0, 0.0]))
            first = integrate(method, system, motion(system, np.zeros(5), np.zeros(5)), Schedule(_TURN / 36, 36, 1))
            second = integrate(method, system, moved, Schedule(_TURN / 36, 36, 2))
            off = _apart(np.tile(first.displacement, (2, 1)), second.displacement)
            return _shortfall_words(off, _stated_error(first) + _stated_error(second), "the motion from another start")
        for system in (linear_system(), contact_system()):
            start = _start(method, system)
            half, full = (Schedule(_TURN / 90, 90, turns) for turns in (1, 2))
            once = integrate(method, system, start, full)
            second = integrate(method, system, integrate(method, system, start, half).final, half)
            for word in _coordinates(method):
                # The second half begins at time zero again: the force's phase differs by rounding, 1e-13 of a turn; an
                # iteration that ends at 1e-9 of the forces may leave 1e-9 of the motion.
                off = _apart(getattr(once, word)[90:], getattr(second, word))
                require(off < 1e-8, f"`{word}` differs by {off:.2g} of the motion after a restart")
        return ""

    @duty("a law's memory is committed once with every accepted step, never with a trial; `steady`: or refused")
    def test_memory(self, method: Integrator) -> str:
        if method.steady:
            start = motion(contact_system(), 1e-6 * _X, np.zeros(5))
            try:
                record = integrate(method, counting_system(), start, Schedule(_TURN / 36, 36, 1))
            except RacewayError as why:
                return f"refused: {why}"
            committed = bool(np.all(np.diff(record.contact_force[:, 1]) > 0.0))
            require(committed, "the law's memory is ignored: refuse it or commit it")
            return ""
        system = counting_system()
        record = integrate(method, system, _start(method, contact_system()), Schedule(PERIOD / 60, 60, 2))
        commits = record.contact_force[:, 1]
        wrong = np.flatnonzero(commits != np.arange(1, 121))[:1]
        require(not len(wrong), f"in step {wrong + 1} the memory has been committed {commits[wrong] - 1} times before")
        require(not system.law_state.any(), "the system's own memory was changed")
        return ""

    @duty(
        "`orbit`: `steady`, and its motion of a bearing is the orbit of the compiled loops, to its stated error",
        lambda method: "" if finds_orbit(method) else "not `orbit`",
    )
    def test_orbit(self, method: Integrator) -> str:
        require(method.steady and method.inertial, "`orbit` is said of steady methods with inertia forces")
        force = {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3e-5}
        scene = scene_from_dict(b7206c(rotor={"mass": 1.0}, excitation=force))
        scene = attrs.evolve(scene, integrator=attrs.evolve(scene.integrator, kind=method.name, method=method))
        (model, still), speed = settled(scene), 12000.0 * np.pi / 30.0
        loop = SteadyLines().line(scene, speed)
        assert loop is not None, "a mild orbit"
        start = model.bearing.at_rest(model.system, still.displacement, still.ball, False)
        record = integrate(method, model.system, start, Schedule(2.0 * np.pi / speed / 90, 90, 1))
        line = 2.0 * (np.exp(-1j * speed * record.time)[:, None] * record.displacement).mean(axis=0)
        return _shortfall_words(_apart(loop[1:3], line[1:3]), _stated_error(record), "the loops' orbit")

    @duty(
        "compiled and stepped drivers, where a scheme has both, take the same steps",
        lambda method: "" if has_both(method) else "one driver",
    )
    def test_drivers(self, method: Integrator) -> str:
        worst = 0.0
        for system in (linear_system(), contact_system()):
            start, schedule = _start(method, system), Schedule(PERIOD / 60, 60, 2)
            in_loop, from_python = (integrate(each, system, start, schedule) for each in (method, FromPython(method)))
            worst = max(worst, *(_apart(getattr(in_loop, w), getattr(from_python, w)) for w in _coordinates(method)))
        # Iterations that end at 1e-9 of the forces may leave as much in each of 120 steps, resonance or not.
        require(worst < 1e-6, f"the drivers differ by {worst:.2g} of the motion")
        return f"they differ by {worst:.1e} of the motion"

    @duty("on_chunk(done, total) is called up to the end, and what it raises passes through")
    def test_progress(self, method: Integrator) -> None:
        system, schedule = linear_system(), Schedule(_TURN / 40, 40, 3)
        start, calls = _start(method, system), list[tuple[int, int]]()
        integrate(method, system, start, schedule, lambda *steps: calls.append(steps))
        require(calls, "on_chunk is never called")
        steps = [call[0] for call in calls]
        require(steps == sorted(steps) and calls[-1] == (120, 120), f"on_chunk ends with {calls[-1]}, not (120, 120)")

        def stop(_done: int, _total: int) -> None:
            raise _Stop

        try:
            integrate(method, system, start, schedule, stop)
        except _Stop:
            return
        require(False, "an exception of on_chunk does not stop the integration")

    @duty("a motion that cannot go on raises ConvergenceError or StabilityError with the last good state")
    def test_failure(self, method: Integrator) -> None:
        system = contact_system(load=-1e9)  # pulls the mass away with nothing to hold it
        start = Motion(np.zeros(5), np.zeros(5), np.zeros(5), np.zeros((1, 2)), np.zeros((1, 2)))
        try:
            record = integrate(method, system, start, Schedule(1e-3, 1000, 1))
        except ConvergenceError as error:
            q = error.state.get("q")
            require(q is not None, "the error has no `q` in its state")
            require(np.isfinite(np.asarray(q)).all(), "the last state is not finite")
            return
        require(False, f"no error, though the mass flies off to {record.displacement[-1, 0]:.3g} m")

    def _order(self, method: Integrator, system: System, time: float, counts: tuple[int, ...]) -> str:
        start = _start(method, system)
        q, v = exact(system, start, np.array([0.5 * time, time]))
        errors = []
        for count in counts:
            record = integrate(method, system, start, Schedule(time / count, count, 1))
            at = [count // 2 - 1, count - 1]
            errors.append(np.abs([(record.displacement[at] - q) * NATURAL, record.velocity[at] - v]).max())
        rates = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
        # The next order's share of the error at the coarser of two steps is below a tenth.
        orders = ", ".join(f"{rate:.2f}" for rate in rates)
        require(rates[-1] > method.order - 0.2, f"order {method.order} declared, {orders} observed")
        return f"observed {rates[-1]:.2f}"


def _stated_error(record: Record) -> float:
    """The error that a record states of itself, over the motion's amplitude."""
    error = record.counts.get("error")
    require(isinstance(error, float) and np.isfinite(error) and error >= 0.0, f"counts['error'] = {error!r} is no error")
    return float(error)  # type: ignore[arg-type]


def _shortfall_words(off: float, tolerance: float, word: str) -> str:
    require(off <= _SHORTFALL * tolerance + _FLOOR, f"off {word} by {off:.2g} of the motion; it states {tolerance:.2g}")
    return f"off {word} by {off:.1g}, states {tolerance:.1g}"
