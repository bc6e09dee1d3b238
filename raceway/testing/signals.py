"""The conformance suites of excitations and identifiers.

Identifiers get records of a mass on a spring and a dashpot, Z = K - m w^2 + j w C, with everything that measured and computed
records are spoilt by; K, m and C must come back.
"""

from __future__ import annotations

from math import radians
from types import SimpleNamespace
from typing import TYPE_CHECKING, cast

import attrs
import numpy as np

from raceway.answers.quantities import C, K
from raceway.core.columns import with_values
from raceway.core.record import Motion, Record, Schedule
from raceway.core.signals import Identification
from raceway.framework.duties import force_params, is_elementwise_force, is_synchronous
from raceway.storage.tables import Tables
from raceway.testing.suite import Suite, check_class, check_kernel, duty, require

if TYPE_CHECKING:
    from raceway.bodies.model import Equilibrium, Model
    from raceway.framework.contracts import Excitation, Identifier

#: Samples of a period, and what sampling may change of an amplitude: a force that is sampled 360 times a turn and joined by
#: straight lines loses 2.5e-5 of its line.
_SAMPLES, _SAMPLED = 4096, 1e-4


def samples(excitation: Excitation, times: np.ndarray, repeats: int = 1) -> np.ndarray:
    """(n, 5) the force at times (n,), into an array that is full of NaN before."""
    from raceway.testing.systems import sample_force

    out = np.full((len(times), 5), np.nan)
    params = np.ascontiguousarray(excitation.parameters(), dtype=float)
    sample_force(repeats, excitation.kernel(), params, np.ascontiguousarray(times, dtype=float), out)
    return out


def _fundamental(excitation: Excitation) -> np.ndarray:
    """(5,) complex line at ``frequency_hz`` over one period: the force is Re(line e^{jwt}) and other lines."""
    times = (excitation.period_s or 0.0) * np.arange(_SAMPLES) / _SAMPLES
    kernel = np.exp(-2j * np.pi * excitation.frequency_hz * times)
    return 2.0 * (kernel[:, None] * samples(excitation, times)).mean(axis=0)


def _not_periodic(excitation: Excitation) -> str:
    return "not periodic" if excitation.period_s is None else ""


class ExcitationSuite(Suite):
    """Duties of ``raceway.framework.contracts.Excitation``."""

    kind = "excitation"

    @duty("attributes: frequency_hz, period_s, amplitude_n, sense, options")
    def test_declaration(self, excitation: Excitation) -> None:
        check_class("excitation", excitation)
        frequency, period, amplitude = excitation.frequency_hz, excitation.period_s, excitation.amplitude_n
        require(np.isfinite(frequency) and frequency > 0.0, f"`frequency_hz` = {frequency!r} must be finite and above 0")
        good = np.isfinite(amplitude) and amplitude >= 0.0
        require(good, f"`amplitude_n` = {amplitude!r} must be finite and not negative")
        require(excitation.sense in (-1, 0, 1), f"`sense` = {excitation.sense!r} must be +1, -1 or 0")
        if period is not None:
            require(np.isfinite(period) and period > 0.0, f"`period_s` = {period!r} must be above 0, or None")
            turns = period * frequency
            whole_number = abs(turns - round(turns)) < 1e-9 * turns and turns > 0.5
            require(whole_number, f"`period_s` holds {turns:g} cycles of `frequency_hz`; it must be a whole number")

    @duty("parameters() returns (k,) finite numbers, those of each point where options are arrays and it says `elementwise`")
    def test_parameters(self, excitation: Excitation) -> None:
        params = np.asarray(excitation.parameters())
        require(params.ndim == 1 and params.dtype == np.float64, f"parameters() is {params.dtype} of shape {params.shape}")
        require(np.isfinite(params).all(), "parameters() holds values that are not finite")
        if is_elementwise_force(excitation):
            numbers = {name: 0.9 * value for name, value in attrs.asdict(excitation).items() if isinstance(value, float)}
            other = with_values(excitation, **numbers)
            both = with_values(excitation, **{name: np.array([value / 0.9, value]) for name, value in numbers.items()})
            for name, of in (("parameters()", force_params), ("period_s", lambda force: np.array(force.period_s))):
                wanted, rows = np.array([of(excitation), of(other)]), of(both)
                same = rows.shape == wanted.shape and np.allclose(rows, wanted, rtol=1e-14, atol=0.0)
                require(same, f"`elementwise`: {name} of two points is {rows}, of each alone {wanted}")

    @duty("kernel() is compiled with @jit(FORCE)")
    def test_signature(self, excitation: Excitation) -> None:
        from raceway.core.signatures import FORCE

        check_kernel(excitation.kernel(), FORCE, "FORCE")

    @duty("all five components are overwritten, in any order of times, the parameters untouched")
    def test_overwrites(self, excitation: Excitation) -> None:
        times = np.random.default_rng(1).uniform(0.0, 3.0 / excitation.frequency_hz, 200)
        forward, backward = samples(excitation, times), samples(excitation, times[::-1])
        missing = np.flatnonzero(np.isnan(forward).any(axis=0))
        require(not len(missing), f"components {missing.tolist()} are not overwritten")
        require(np.array_equal(forward, backward[::-1]), "the force depends on what was asked before")
        params = np.ascontiguousarray(excitation.parameters(), dtype=float)
        before, out = params.copy(), np.zeros(5)
        excitation.kernel()(0.1 / excitation.frequency_hz, params, out)
        require(np.array_equal(before, params), "the kernel changes its parameters")

    @duty("finite at any time")
    def test_extreme_times(self, excitation: Excitation) -> None:
        times = np.array([0.0, -0.0, 5e-324, 1e-12, 1.0, 1e3, 1e6, -1e-3])
        force = samples(excitation, times)
        require(np.isfinite(force).all(), f"not finite at t = {times[~np.isfinite(force).all(axis=1)]} s")

    @duty("the kernel allocates no memory")
    def test_no_allocation(self, excitation: Excitation) -> None:
        from raceway.testing.systems import require_no_allocation, sample_force

        time, out = np.full(1, 0.1), np.zeros((1, 5))
        params, kernel = np.ascontiguousarray(excitation.parameters(), dtype=float), excitation.kernel()
        require_no_allocation(lambda count: sample_force(count, kernel, params, time, out))

    @duty("the force repeats itself after `period_s`", _not_periodic)
    def test_period(self, excitation: Excitation) -> None:
        period = excitation.period_s or 0.0
        times = np.random.default_rng(2).uniform(0.0, 1.0, 300) * period
        first, later = samples(excitation, times), samples(excitation, times + 7.0 * period)
        # Rounding of the phase after seven periods, with a hundred for fast harmonics.
        wrong = np.abs(later - first).max() / max(np.abs(first).max(), 1e-300)
        require(wrong < 1e-10, f"after seven periods it differs by {wrong:.2g} of its largest value")

    @duty("the line at `frequency_hz` has the amplitude `amplitude_n`", _not_periodic)
    def test_amplitude(self, excitation: Excitation) -> None:
        line = _fundamental(excitation)[:3]
        major = np.linalg.svd(np.array([line.real, line.imag]), compute_uv=False)[0]
        amplitude = excitation.amplitude_n
        words = f"its line at {excitation.frequency_hz:g} Hz has {major:.6g} N"
        require(abs(major - amplitude) <= _SAMPLED * max(major, amplitude), f"`amplitude_n` = {amplitude:.6g} N; {words}")

    @duty("the line at `frequency_hz` turns as `sense` says: forward, backward, or not at all", _not_periodic)
    def test_sense(self, excitation: Excitation) -> None:
        line = _fundamental(excitation)[:3]
        forward, backward = abs(line[1] + 1j * line[2]), abs(line[1] - 1j * line[2])
        size = np.abs(line).max()
        sense = 0 if abs(forward - backward) <= _SAMPLED * size else (1 if forward > backward else -1)
        require(sense == excitation.sense, f"`sense` = {excitation.sense}, but the force turns with sense {sense}")
        if excitation.sense == 0:
            minor = np.linalg.svd(np.array([line.real, line.imag]), compute_uv=False)[1]
            require(minor <= _SAMPLED * size, "`sense` = 0, but the force leaves its direction")

    @duty("direction and phase are those of direction_deg and phase_lag_deg, where these are options", _not_periodic)
    def test_direction_and_phase(self, excitation: Excitation) -> str:
        direction, lag = (getattr(excitation, word, None) for word in ("direction_deg", "phase_lag_deg"))
        if lag is None and direction is None:
            return "neither is an option"
        line, amplitude = _fundamental(excitation)[:3], excitation.amplitude_n
        along = line[1]
        if excitation.sense == 0:
            angle = radians(direction or 0.0)
            along = line[1] * np.cos(angle) + line[2] * np.sin(angle)
            across = np.sqrt(max(np.sum(np.abs(line) ** 2) - abs(along) ** 2, 0.0))
            require(across <= 1e-7 * amplitude, f"{across:.3g} N act across `direction_deg` = {direction}")
        if lag is not None:
            off = np.degrees(np.angle(along / (amplitude * np.exp(-1j * radians(lag))))) if amplitude else 0.0
            require(abs(off) < 1e-6, f"the force lags by {lag - off:.6g} deg, `phase_lag_deg` = {lag:g}")
        return ""


#: Stiffness [N/m], mass [kg], damping [N s/m], frequency [Hz], force [N] of the synthetic records.
STIFFNESS, MASS, DAMPING, FREQUENCY, FORCE = 2.0e8, 2.0, 4000.0, 200.0, 300.0
_PER_TURN = 360


def _dynamic_stiffness(frequency: float = FREQUENCY) -> complex:
    """Z = K - m w^2 + j w C of the records."""
    w = 2.0 * np.pi * frequency
    return complex(STIFFNESS - MASS * w**2, DAMPING * w)


def _synthetic_record(
    turns: float = 8.0, sense: int = 1, direction: float = 0.0, frequency: float = FREQUENCY, mean: float = 0.0,
    drift: float = 0.0, harmonics: float = 0.0, noise: float = 0.0, seed: int = 1,
) -> Record:  # fmt: skip
    """Response to a harmonic force, in shares of its 1x amplitude.

    turns : length of the window, whole or not
    sense : +1 forward, -1 backward, 0 along ``direction`` [rad]
    mean, drift, harmonics, noise : a constant, a ramp over the window, 2x and 3x lines, white noise, of the displacement
    """
    dt = 1.0 / (frequency * _PER_TURN)
    n = round(turns * _PER_TURN)
    time = dt * np.arange(1, n + 1)
    across = (1.0, -1j * sense) if sense else (np.cos(direction), np.sin(direction))
    shape = np.array([0.0, *across, 0.0, 0.0], dtype=complex)
    wave = np.exp(2j * np.pi * frequency * time)[:, None]
    force = FORCE * np.exp(-0.4j) * shape
    line = force / _dynamic_stiffness(frequency)
    size = float(np.abs(line).max())
    displacement = (wave * line).real
    radial = np.array([0.0, 1.0, 1.0, 0.0, 0.0])
    displacement += size * mean * radial + size * drift * ((time - time[0]) / (time[-1] - time[0]))[:, None] * radial
    displacement += size * harmonics * ((wave**2 * (0.6 - 0.8j)).real + (0.5 * wave**3).real) * radial
    displacement += size * noise * np.random.default_rng(seed).standard_normal((n, 5)) * radial
    still = Motion(displacement[-1], np.zeros(5), np.zeros(5), np.zeros((1, 2)), np.zeros((1, 2)))
    return Record(
        time=time, displacement=displacement, velocity=np.gradient(displacement, dt, axis=0), force=(wave * force).real,
        gap=np.full((n, 2), 1.0), contact_force=np.zeros((n, 2)), ball=np.zeros((n, 1, 2)), final=still,
        schedule=Schedule(dt, _PER_TURN, max(int(turns), 1)),
        counts={"steps": n, "evaluations": n, "max_penetration_m": 0.0, "peak_contact_force_n": 0.0},
    )  # fmt: skip


def _model_of(sense: int = 1, direction: float = 0.0) -> Model:
    """A model as identifiers see it, for the same spring, mass and dashpot."""
    from raceway.plugins.excitations.harmonic import harmonic
    from raceway.testing.systems import linear_system

    radial = np.diag([0.0, 1.0, 1.0, 0.0, 0.0])
    system = linear_system(damped=False)
    system.mass, system.damping, system.stiffness = MASS * np.eye(5), DAMPING * radial, STIFFNESS * radial
    w = 2.0 * np.pi * FREQUENCY
    shape = [1.0, 0.0, 0.0, float(sense)] if sense else [np.cos(direction), 0.0, np.sin(direction), 0.0]
    system.force, system.force_params = harmonic(), np.array([FORCE, w, 0.4, *shape])
    excitation = SimpleNamespace(
        frequency_hz=FREQUENCY, period_s=1.0 / FREQUENCY, amplitude_n=FORCE, sense=sense, speed_rpm=60.0 * FREQUENCY,
        phase=lambda time: w * time - 0.4,
    )  # fmt: skip
    scene = SimpleNamespace(excitation=excitation)
    return cast("Model", SimpleNamespace(system=system, excitation=excitation, mass_used=MASS, scene=scene))


def _equilibrium_at_rest() -> Equilibrium:
    """An equilibrium without displacement."""
    matrices = ("stiffness", "stiffness_rows_held", "damping", "damping_rows_held")
    parts = {name: np.zeros((5, 5)) for name in matrices}
    return cast("Equilibrium", SimpleNamespace(displacement=np.zeros(5), ball=np.zeros((1, 2)), **parts))


#: (sense, direction [rad]) of the forces that are tried.
_FORCES = ((1, 0.0), (-1, 0.0), (0, 0.0), (0, 1.1))
#: Speeds of identifiers that need several, as multiples of ``FREQUENCY``.
_SPEEDS = (0.6, 0.8, 1.0, 1.2, 1.4)


class IdentifierSuite(Suite):
    """Duties of ``raceway.framework.contracts.Identifier``.

    Notes
    -----
    ``records`` is empty for identifiers that need the equilibrium only, one record for "record", and five records at
    different speeds, the schedule's turn being one period, for "speeds".  The excitation knows its phase.
    """

    kind = "identifier"

    @duty("attributes: needs, definition, options")
    def test_declaration(self, identifier: Identifier) -> None:
        check_class("identifier", identifier)
        names = {"record", "speeds", "equilibrium", "period", "phase"}
        needs, words = identifier.needs, identifier.definition
        good = isinstance(needs, frozenset) and needs and needs <= names
        require(good, f"`needs` = {needs!r}: a frozenset out of {sorted(names)}")
        require(isinstance(words, str) and len(words) > 20, "`definition` must be a sentence")

    @duty("an Identification with frequency, mass and force amplitude")
    def test_answer(self, identifier: Identifier) -> None:
        answer = self._identify(identifier)
        require(isinstance(answer, Identification), f"identify() returns {type(answer).__name__}, not an Identification")
        for word, target, relative in (
            ("frequency_hz", FREQUENCY, 1e-9), ("mass_used", MASS, 1e-3), ("force_amplitude", FORCE, 1e-3),
        ):  # fmt: skip
            value = getattr(answer, word)
            require(abs(value - target) < relative * target, f"{word} = {value:g}, not {target:g}")
        values = (answer.forward_amplitude, answer.backward_amplitude, answer.orbit_major, answer.orbit_minor)
        require(np.isfinite(values).all() and min(values) >= 0.0, "orbit amplitudes must be finite and not negative")

    @duty("recovers K, m and C from a clean record, for forces that turn forward, backward, or not")
    def test_clean(self, identifier: Identifier) -> str:
        return self._recovers(identifier, 1e-8)

    @duty("... with a mean and a drift of ten times the 1x amplitude")
    def test_drift(self, identifier: Identifier) -> str:
        # A Fourier line loses a ramp only as far as its slope is known from the turns' means.
        return self._recovers(identifier, 1e-3, mean=50.0, drift=10.0)

    @duty("... with 2x and 3x lines as large as the 1x")
    def test_harmonics(self, identifier: Identifier) -> str:
        # Short tracking windows that fit 1x and 2x only let some of 3x leak in at their ends.
        return self._recovers(identifier, 1e-3, harmonics=1.0)

    @duty("... with noise of a tenth of the 1x amplitude")
    def test_noise(self, identifier: Identifier) -> str:
        # 2160 samples at least: 0.1 sqrt(2 / 2160) = 0.3 %, three times that for safety.
        return self._recovers(identifier, 1e-2, noise=0.1)

    @duty("... with a window that is not whole turns")
    def test_window(self, identifier: Identifier) -> str:
        return self._recovers(identifier, 1e-3, turns=9.37, mean=3.0, harmonics=0.3)

    @duty(
        "`synchronous`: Z = F^H F / F^H x of the 1x components, as compiled loops state it, also where directions differ",
        lambda identifier: "" if is_synchronous(identifier) else "not `synchronous`",
    )
    def test_synchronous(self, identifier: Identifier) -> None:
        record = _synthetic_record()
        wave = np.exp(2j * np.pi * FREQUENCY * record.time)[:, None]
        displacement = record.displacement + (wave * (3.0 - 2.0j) * 1e-7 * np.eye(5)[1]).real
        force, line = (2.0 * (wave.conj() * part[:, :3]).mean(axis=0) for part in (record.force, displacement))
        answer = identifier.identify([attrs.evolve(record, displacement=displacement)], _equilibrium_at_rest(), _model_of())
        off = abs(answer.dynamic_stiffness / (np.vdot(force, force) / np.vdot(force, line)) - 1.0)
        require(off < 1e-8, f"Z differs by {off:.2g} from F^H F / F^H x: compiled loops would state another definition")

    @duty("records and equilibrium are left untouched")
    def test_input_untouched(self, identifier: Identifier) -> None:
        records = self._records(identifier, {})
        before = [(r.displacement.copy(), r.force.copy()) for r in records]
        identifier.identify(records, _equilibrium_at_rest(), _model_of())
        for record, (x, f) in zip(records, before, strict=True):
            require(np.array_equal(record.displacement, x) and np.array_equal(record.force, f), "a record was changed")

    def _records(self, identifier: Identifier, spoilt: Tables) -> list[Record]:
        if "speeds" in identifier.needs:
            return [_synthetic_record(frequency=r * FREQUENCY, seed=k, **spoilt) for k, r in enumerate(_SPEEDS)]
        return [_synthetic_record(**spoilt)] if "record" in identifier.needs else []

    def _identify(self, identifier: Identifier, sense: int = 1, direction: float = 0.0, **spoilt: float) -> Identification:
        records = self._records(identifier, {"sense": sense, "direction": direction, **spoilt})
        return identifier.identify(records, _equilibrium_at_rest(), _model_of(sense, direction))

    def _recovers(self, identifier: Identifier, tolerance: float, **spoilt: float) -> str:
        if spoilt and not identifier.needs & {"record", "speeds"}:
            return "no record is used"
        w, Z = 2.0 * np.pi * FREQUENCY, _dynamic_stiffness()
        for sense, direction in _FORCES:
            answer = self._identify(identifier, sense, direction, **spoilt)
            where = f"force of sense {sense}" + (f" along {np.degrees(direction):.0f} deg" if sense == 0 else "")
            # K and C are asked for to the same share of |Z|: the phase is what a record resolves.
            for word, off in (
                ("Z", answer.dynamic_stiffness - Z),
                ("K = Re Z + m w^2", K.of(answer) - STIFFNESS),
                ("w C = Im Z", (C.of(answer) - DAMPING) * w),
            ):
                part = abs(off) / abs(Z)
                require(part < tolerance, f"{where}: {word} off by {100 * part:.3g} % of |Z|, {100 * tolerance:g} % allowed")
        return ""
