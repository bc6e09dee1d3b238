"""The conformance suite of contact laws, driven at contacts like those of a small ball bearing.

Units that options declare are read, so that a law can be tried in other units of length, force and time.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.framework.contracts import ContactPairs, said
from raceway.framework.duties import is_hertzian, law_report, reach_of
from raceway.testing.suite import ConformityError, Suite, check_class, check_kernel, check_shape, duty, require

if TYPE_CHECKING:
    from raceway.core.jit import Kernel
    from raceway.framework.contracts import ContactLaw

#: Exponents of length, force and time.
_UNITS: dict[str, tuple[float, float, float]] = {
    "m": (1, 0, 0), "N": (0, 1, 0), "s": (0, 0, 1), "kg": (-1, 1, 2), "Pa": (-2, 1, 0), "J": (1, 1, 0), "Hz": (0, 0, -1),
    "W": (1, 1, -1), "K": (0, 0, 0), "rad": (0, 0, 0), "deg": (0, 0, 0), "r": (0, 0, 0), "min": (0, 0, 1), "1": (0, 0, 0), "%": (0, 0, 0),
}  # fmt: skip
_UNIT_AND_POWER = re.compile(r"^([A-Za-z%]+|1)(?:\^?(-?\d+(?:\.\d+)?))?$")


def exponents(unit: str) -> tuple[float, ...]:
    """Exponents of length, force and time in a unit such as "N/m3", "kg m", "N/m^1.5", "" or "r/min".

    ConformityError: A unit that is not made of SI units.
    """
    total = np.zeros(3)
    above, *below = unit.split("/")
    for sign, words in ((1.0, above), *((-1.0, part) for part in below)):
        for word in words.split():
            match = _UNIT_AND_POWER.match(word)
            if match is None or match[1] not in _UNITS:
                example = "write SI units such as 'N s/m' or 'N/m3'"
                raise ConformityError(f"the unit '{unit}' of an option cannot be read; {example}")
            total += sign * float(match[2] or 1.0) * np.array(_UNITS[match[1]])
    return tuple(total.tolist())


def _scale_of(unit: str, length: float, force: float, time: float) -> float:
    """The factor by which a value in this unit changes when lengths, forces and times are multiplied."""
    return float(np.prod(np.power((length, force, time), exponents(unit))))


#: Contacts of a small ball bearing: curvatures 1/m, contact modulus Pa, Hertz factor N/m^1.5, load N, area of a point m2.
_CONTACT = (5.0, 130.0, 1.16e11, 1.3e10, 300.0, 1e-9)
#: Entraining speed m/s, load N, Young's modulus Pa, Poisson's ratio.
_SPEED, _LOAD, _YOUNG, _POISSON = 8.0, 300.0, 2.1e11, 0.29
#: One contact of several, by its index.
_THIRD = np.array([2])
#: Units of all arrays that a law may get.
_PAIR_UNITS = {
    "curvature_a": "1/m", "curvature_b": "1/m", "contact_modulus": "Pa", "hertz_factor": "N/m^1.5", "reference_load": "N",
    "area": "m2", "length": "m", "ring_young": "Pa", "ring_poisson": "", "ball_young": "Pa", "ball_poisson": "",
    "running_angle": "rad", "entraining_speed": "m/s", "load": "N",
}  # fmt: skip


def example_pairs(n: int, seed: int = 1, nodal: bool = True) -> ContactPairs:
    """n running contacts, each within a factor two of those of a bearing of 30 mm bore; resultants have no ``area``."""
    rng = np.random.default_rng(seed)
    pairs = ContactPairs(*(np.array(_CONTACT)[:, None] * rng.uniform(0.7, 1.4, (6, n))))
    speed, load = _SPEED * rng.uniform(0.7, 1.4, n), _LOAD * rng.uniform(0.7, 1.4, n)
    young, poisson = np.full(n, _YOUNG), np.full(n, _POISSON)
    return attrs.evolve(
        pairs, area=pairs.area if nodal else None, ring_young=young, ring_poisson=poisson, ball_young=young,
        ball_poisson=poisson, running_angle=np.zeros(n), entraining_speed=speed, load=load,
    )  # fmt: skip


def _pairs_of(law: ContactLaw, n: int, nodal: bool = False) -> ContactPairs:
    """What the suite drives a law at: resultants where it knows them."""
    return example_pairs(n, nodal=nodal or "resultant" not in law.discretisations)


@attrs.define(eq=False)
class _Driven:
    """A law with its parameters for n contacts, called with fresh outputs."""

    law: ContactLaw
    kernel: Kernel
    params: np.ndarray

    @property
    def n(self) -> int:
        return len(self.params)

    def rest(self) -> np.ndarray:
        """(n, m) memory of contacts that have never touched."""
        return np.zeros((self.n, self.law.state_size))

    def __call__(
        self, gap: np.ndarray | float, rate: np.ndarray | float = 0.0, state: np.ndarray | None = None, dt: float = 1e-5
    ) -> tuple[np.ndarray, ...]:
        """force, d_gap, d_rate (n,) and state_new (n, m); outputs are full of NaN before the call."""
        state = self.rest() if state is None else state
        gap, rate = (np.ascontiguousarray(v) if np.ndim(v) else np.full(self.n, float(v)) for v in (gap, rate))
        force, d_gap, d_rate = np.full((3, self.n), np.nan)
        new = np.full_like(state, np.nan)
        self.kernel(gap, rate, self.params, state, new, dt, force, d_gap, d_rate)
        return force, d_gap, d_rate, new


def drive(law: ContactLaw, n: int, nodal: bool = False, pairs: ContactPairs | None = None) -> _Driven:
    """A law built for n example contacts, or for others."""
    params = law.build(_pairs_of(law, n, nodal) if pairs is None else pairs)
    return _Driven(law, law.kernel(), np.ascontiguousarray(params, dtype=float))


def _along(kernel_run: _Driven, gaps: np.ndarray, rates: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Forces (steps, n) along paths, from memory at rest, and the memory (n, m) at their end."""
    from raceway.testing.systems import along_path

    state, forces = kernel_run.rest(), np.zeros_like(gaps)
    paths = (np.ascontiguousarray(gaps), np.ascontiguousarray(rates))
    along_path(kernel_run.kernel, *paths, kernel_run.params, dt, state, state.copy(), np.zeros((2, kernel_run.n)), forces)
    return forces, state


class ContactLawSuite(Suite):
    """Duties of ``raceway.framework.contracts.ContactLaw``.

    Attributes
    ----------
    depth : greatest approach that the checks use [m];  speed : greatest rate of the gap [m/s]
    """

    kind = "contact_law"
    depth = 2e-5
    speed = 0.05

    @duty("attributes: discretisations, state_size, dissipative, options")
    def test_declaration(self, law: ContactLaw) -> None:
        check_class("contact_law", law)
        kinds = {"resultant", "nodal"}
        names = law.discretisations
        require(isinstance(names, frozenset) and names, "`discretisations` must be a frozenset that is not empty")
        require(names <= kinds, f"`discretisations` = {sorted(names)}: only {sorted(kinds)} exist")
        require(type(law.state_size) is int and law.state_size >= 0, f"`state_size` = {law.state_size!r} must be 0 or more")
        require(type(law.dissipative) is bool, f"`dissipative` = {law.dissipative!r} must be True or False")

    @duty("build(pairs) returns (n, k) finite parameters, a row for each contact")
    def test_parameters(self, law: ContactLaw) -> None:
        pairs = _pairs_of(law, 7)
        params = np.asarray(law.build(pairs))
        require(params.ndim == 2 and len(params) == 7, f"build() of 7 contacts returns shape {params.shape}, not (7, k)")
        require(params.dtype == np.float64, f"build() returns {params.dtype}, not float64")
        require(np.isfinite(params).all(), "build() returns values that are not finite")
        alone = np.asarray(law.build(pairs.at(_THIRD)))
        require(np.array_equal(alone[0], params[2]), "a contact's row depends on the other contacts")

    @duty("only a `renewed` law follows speed and load; its reach is 0 or more and vanishes with the entraining speed")
    def test_running(self, law: ContactLaw) -> str:
        """At standstill and as good as there a law is the same; 1e-15 of a speed leaves 1e-9 of any power above 0.6."""
        renewal = said(law, "renewed")
        require(type(renewal) is bool, f"`renewed` = {renewal!r} must be True or False")
        for name in ("reach", "report"):
            require(renewal or not hasattr(law, name), f"{name}() is called for laws with `renewed` = True only")
        pairs = _pairs_of(law, 9)
        assert pairs.entraining_speed is not None and pairs.load is not None, "as made above"
        standstill = attrs.evolve(pairs, entraining_speed=None, load=None)
        resting, running = np.asarray(law.build(standstill)), np.asarray(law.build(pairs))
        require(resting.shape == running.shape, "build() returns another number of columns at standstill")
        require(np.isfinite(resting).all(), "build() returns values that are not finite at standstill")
        if not renewal:
            require(np.array_equal(resting, running), "parameters follow speed or load: say renewed = True")
            return "neither speed nor load"
        slow = attrs.evolve(pairs, entraining_speed=1e-15 * pairs.entraining_speed)
        approach = np.cbrt(pairs.load / pairs.hertz_factor) ** 2
        reach = float((reach_of(law, slow) / approach).max())
        require(reach < 1e-9, f"a reach of {reach:.2g} of Hertz's approach stays at 1e-15 of the speed: it must vanish")
        off = float(np.abs(np.asarray(law.build(slow)) - resting).max() / np.abs(resting).max())
        require(off < 1e-9, f"parameters differ by {off:.2g} from those of standstill at 1e-15 of the speed")
        alone = reach_of(law, pairs.at(_THIRD))
        require(alone[0] == reach_of(law, pairs)[2], "a contact's reach depends on the other contacts")
        report = law_report(law, pairs)
        for name, values in {} if report is None else report.columns.items():
            check_shape(f"report(): column '{name}'", values, (9,))
        return f"reach up to {1e6 * reach_of(law, pairs).max():.3g} µm"

    @duty("kernel() is compiled with @jit(LAW)")
    def test_signature(self, law: ContactLaw) -> None:
        from raceway.core.signatures import LAW

        check_kernel(law.kernel(), LAW, "LAW")

    @duty("zero force and derivatives for gap > 0, zero force at gap = 0")
    def test_zero_outside(self, law: ContactLaw) -> None:
        kernel_run = drive(law, 64)
        for state in (kernel_run.rest(), self._reached(kernel_run)):
            for rate in (-self.speed, 0.0, self.speed):
                for gap in (0.0, 1e-300, 1e-9, self.depth, 1.0):
                    force, d_gap, d_rate, _ = kernel_run(gap, rate, state)
                    require(not force.any(), f"force {np.abs(force).max():.3g} at gap {gap:g} m, rate {rate:g} m/s")
                    if gap > 0.0:
                        require(not d_gap.any() and not d_rate.any(), f"derivatives are not zero at gap {gap:g} m")

    @duty("the force is never negative")
    def test_never_negative(self, law: ContactLaw) -> None:
        kernel_run = drive(law, 4096)
        for speed in (1.0, 100.0):
            gap, rate = self._random(2, 4096)
            rate *= speed
            force = kernel_run(gap, rate, self._reached(kernel_run))[0]
            worst = int(np.argmin(force))
            require(force[worst] >= 0.0, f"force {force[worst]:.4g} at gap {gap[worst]:.3g} m, rate {rate[worst]:.3g} m/s")

    @duty("the force never falls as the approach grows, at any rate and memory")
    def test_monotonic(self, law: ContactLaw) -> None:
        kernel_run = drive(law, 16)
        approaches = np.concatenate([np.geomspace(1e-12, 1e-8, 40), np.linspace(1e-8, self.depth, 400)])
        for state in (kernel_run.rest(), self._reached(kernel_run)):
            for rate in (-self.speed, 0.0, self.speed):
                forces = np.array([kernel_run(-a, rate, state)[0] for a in approaches])
                fall = np.diff(forces, axis=0)
                step, least = int(np.argmin(fall.min(axis=1))), fall.min()
                where = f"from an approach of {approaches[step]:.4g} to {approaches[step + 1]:.4g} m"
                require(least >= -1e-12 * forces.max(), f"{where} the force falls by {-least:.3g} at rate {rate:g} m/s")
        require(kernel_run(-self.depth)[0].min() > 0.0, f"no force at an approach of {self.depth:g} m")

    @duty("d_gap and d_rate are the derivatives of the force, memory and time step held")
    def test_derivatives(self, law: ContactLaw) -> str:
        """Central differences; a point whose two sides disagree straddles a kink, which few may."""
        kernel_run, rng = drive(law, 2000), np.random.default_rng(3)
        kinks = 0
        for state in (kernel_run.rest(), self._reached(kernel_run)):
            for dt in (1e-5, 1e-3):
                gap = -rng.uniform(0.002, 1.0, 2000) * self.depth
                rate = rng.uniform(-1.0, 1.0, 2000) * self.speed
                force, d_gap, d_rate, _ = kernel_run(gap, rate, state, dt)
                for word, derivative, size in (("d_gap", d_gap, self.depth), ("d_rate", d_rate, self.speed)):
                    h = 1e-6 * size
                    by_gap, by_rate = (h, 0.0) if word == "d_gap" else (0.0, h)
                    up = kernel_run(gap + by_gap, rate + by_rate, state, dt)[0]
                    down = kernel_run(gap - by_gap, rate - by_rate, state, dt)[0]
                    slope = (up - down) / (2.0 * h)
                    scale = np.abs(derivative) + 1e-3 * np.abs(force).max() / size
                    bent = np.abs(up - 2.0 * force + down) / h > 1e-3 * scale
                    # Truncation: (h / approach)^2 / 24, at most 1e-8 here; rounding: 1e-16 / 1e-6 of the largest force.
                    wrong = (np.abs(slope - derivative) > 1e-5 * scale) & ~bent
                    at = int(np.argmax(wrong))
                    where = f"at gap {gap[at]:.3g} m, rate {rate[at]:.3g} m/s, dt {dt:g} s"
                    words = f"{word} = {derivative[at]:.6g} but differences give {slope[at]:.6g} {where}"
                    require(not wrong.any(), words)
                    kinks += int(bent.sum())
                    require(bent.mean() < 0.1, f"{word}: the force has a kink at {100.0 * bent.mean():.0f} % of all points")
        return f"{kinks} of 16000 differences straddle a kink" if kinks else ""

    @duty("a closed cycle never gains energy, and loses none unless `dissipative`")
    def test_closed_cycle(self, law: ContactLaw) -> str:
        """Cycles that leave contact and cycles that do not, slow and fast, some with a second harmonic."""
        n, steps, turns = 6, 400, 3
        kernel_run = drive(law, n)
        phase = 2.0 * np.pi * np.arange(steps * turns + 1) / steps
        shares = [[0.5, 0.0, 0.8, 0.3, 0.6, -0.2], [0.4, 0.9, 0.1, 0.6, 0.2, 0.7], [0.0, 0.0, 0.1, 0.1, 0.3, 0.2]]
        mean, first, second = self.depth * np.array(shares)[:, None, :]
        approach = mean - first * np.cos(phase)[:, None] + second * np.cos(2.0 * phase)[:, None]
        slope = first * np.sin(phase)[:, None] - 2.0 * second * np.sin(2.0 * phase)[:, None]
        largest = 0.0
        for frequency in (1.0, 100.0, 400.0):
            w = 2.0 * np.pi * frequency
            forces, _ = _along(kernel_run, -approach, -slope * w, 1.0 / (frequency * steps))
            # Trapezoids in the approach: for a law without rate or memory the way back cancels the way in exactly.
            work = 0.5 * (forces[1:] + forces[:-1]) * np.diff(approach, axis=0)
            size = np.abs(work).sum(axis=0) / turns + 1e-300
            losses = work.reshape(turns, steps, n).sum(axis=1) / size
            worst = losses[1:].min()
            # Quadrature of 400 steps: a dissipating law's loss is known to about 1e-4 of the energy that passes.
            tolerance = 1e-4 if law.dissipative else 1e-10
            require(worst >= -tolerance, f"a cycle of {frequency:g} Hz gains {-worst:.3g} of the energy that passes through")
            most = float(losses.max())
            words = f"a cycle of {frequency:g} Hz loses {most:.3g} of the energy that passes: say dissipative = True"
            require(law.dissipative or most <= 1e-10, words)
            largest = max(largest, most)
        return f"loses up to {100.0 * largest:.3g} % a cycle" if law.dissipative else ""

    @duty("`hertzian`: the force of a resultant is K delta^1.5", lambda law: "" if is_hertzian(law) else "not `hertzian`")
    def test_hertzian(self, law: ContactLaw) -> None:
        pairs = _pairs_of(law, 64)
        resting = attrs.evolve(pairs, entraining_speed=None, load=None)
        for share in (0.01, 0.3, 1.0):
            hertz = pairs.hertz_factor * (share * self.depth) ** 1.5
            off = np.abs(drive(law, 64, pairs=resting)(-share * self.depth)[0] / hertz - 1.0).max()
            require(off < 1e-9, f"the force differs by {off:.2g} from Hertz's at {share * self.depth:.2g} m")

    @duty(
        "a law of both discretisations is a pressure where it gets an area: zero outside, growing, derivative exact",
        lambda law: "" if law.discretisations == {"resultant", "nodal"} else "one discretisation",
    )
    def test_pressures(self, law: ContactLaw) -> None:
        kernel_run, h = drive(law, 64, nodal=True), 1e-6 * self.depth
        approaches = np.linspace(0.01, 1.0, 100) * self.depth
        outside = kernel_run(1e-9)
        require(not outside[0].any() and not outside[1].any(), "a pressure or a derivative outside contact")
        pressures = np.array([kernel_run(-a)[0] for a in approaches])
        require((pressures >= 0.0).all() and (np.diff(pressures, axis=0) >= 0.0).all(), "the pressure falls or is negative")
        require(pressures[-1].min() > 0.0, f"no pressure at an approach of {self.depth:g} m")
        for a in approaches[::10]:
            slope = (kernel_run(-a + h)[0] - kernel_run(-a - h)[0]) / (2.0 * h)
            d_gap = kernel_run(-a)[1]
            # Truncation of the differences: (h / approach)^2, at most 1e-8.
            worst = np.abs(slope - d_gap).max() / max(np.abs(d_gap).max(), 1e-300)
            require(worst < 1e-5, f"d_gap is off by {worst:.2g} at an approach of {a:.3g} m")

    @duty("empty and long arrays; a contact does not depend on its neighbours")
    def test_array_lengths(self, law: ContactLaw) -> None:
        for n in (0, 1, 100_000):
            kernel_run = drive(law, n)
            gap, rate = self._random(4, n)
            results = kernel_run(gap, rate)
            require(all(np.isfinite(r).all() for r in results), f"results of {n} contacts are not all finite")
            if n > 1:
                backwards = _Driven(law, kernel_run.kernel, np.ascontiguousarray(kernel_run.params[::-1]))
                back = backwards(gap[::-1], rate[::-1])
                same = all(np.array_equal(a, b[::-1]) for a, b in zip(results, back, strict=True))
                require(same, "the order of the contacts changes their results")

    @duty("the kernel allocates no memory")
    def test_no_allocation(self, law: ContactLaw) -> None:
        from raceway.testing.systems import repeat_law, require_no_allocation

        kernel_run = drive(law, 256)
        state = kernel_run.rest()
        arrays = (np.linspace(-self.depth, 0.1 * self.depth, 256), np.zeros(256), kernel_run.params, state, state.copy())
        require_no_allocation(lambda count: repeat_law(count, kernel_run.kernel, *arrays, 1e-5, *np.zeros((3, 256))))

    @duty("finite for extreme input")
    def test_extreme_input(self, law: ContactLaw) -> None:
        kernel_run = drive(law, 8)
        for state in (kernel_run.rest(), self._reached(kernel_run)):
            for gap in (-1.0, -1e-3, -1e-15, -5e-324, -0.0, 0.0, 1e300):
                for rate in (-1e4, -1e-300, 0.0, 1e4):
                    for dt in (0.0, 1e-15, 1.0):
                        finite = all(np.isfinite(r).all() for r in kernel_run(gap, rate, state, dt))
                        require(finite, f"not finite at gap {gap:g} m, rate {rate:g} m/s, dt {dt:g} s")

    @duty("every entry of every output is overwritten, and twice the same input gives the same output")
    def test_overwrites(self, law: ContactLaw) -> None:
        kernel_run = drive(law, 512)
        (gap, rate), state = self._random(5, 512), self._reached(kernel_run)
        first, second = kernel_run(gap, rate, state), kernel_run(gap, rate, state)
        for word, a, b in zip(("force", "d_gap", "d_rate", "state_new"), first, second, strict=True):
            require(not np.isnan(a).any(), f"`{word}` is not overwritten whole")
            require(np.array_equal(a, b), f"`{word}` differs between two calls with the same input")

    @duty("gap, gap_rate, params and state_old are left untouched")
    def test_input_untouched(self, law: ContactLaw) -> None:
        kernel_run = drive(law, 512)
        (gap, rate), state = self._random(6, 512), self._reached(kernel_run)
        inputs = {"gap": gap, "gap_rate": rate, "params": kernel_run.params, "state_old": state}
        before = {word: array.copy() for word, array in inputs.items()}
        kernel_run(gap, rate, state)
        differences = [word for word, array in inputs.items() if not np.array_equal(array, before[word])]
        require(not differences, f"{', '.join(differences)} changed")

    @duty("no unit is built in: other units of length, force and time, in pairs and options, give the same physics")
    def test_unit_invariance(self, law: ContactLaw) -> str:
        length, force, time = 1.7, 0.6, 1.3
        options = {}
        for field in attrs.fields(type(law)):
            value = getattr(law, field.name)
            if isinstance(value, float):
                options[field.name] = value * _scale_of(field.metadata.get("unit", ""), length, force, time)
        try:
            instance: Any = law  # a contract is no attrs class to mypy
            scaled_law = attrs.evolve(instance, **options)
        except ValueError as why:
            return f"not checked: the options' own rules refuse other units ({why})"
        pairs = _pairs_of(law, 64)
        factors = {name: _scale_of(unit, length, force, time) for name, unit in _PAIR_UNITS.items()}
        arrays = {name: array for name in _PAIR_UNITS if (array := getattr(pairs, name)) is not None}
        in_other_units = ContactPairs(**{name: array * factors[name] for name, array in arrays.items()})
        gap, rate = self._random(7, (20, 64), 0.3)
        forces, _ = _along(drive(law, 64, pairs=pairs), gap, rate, 1e-5)
        scaled = drive(scaled_law, 64, pairs=in_other_units)
        scaled_forces, _ = _along(scaled, gap * length, rate * length / time, 1e-5 * time)
        area = 1.0 if "resultant" in law.discretisations else length**2
        off = np.abs(scaled_forces * area / force - forces).max() / forces.max()
        words = "in other units: a dimensional number hides in"
        require(off < 1e-9, f"forces differ by {off:.2g} {words} build() or the kernel")
        reach, other_reach = reach_of(law, pairs), reach_of(scaled_law, in_other_units) / length
        off = np.abs(other_reach - reach).max() / max(reach.max(), 1e-300)
        require(off < 1e-9, f"reach() differs by {off:.2g} {words} it")
        return ""

    def _random(self, seed: int, size: int | tuple[int, int], outside: float = 0.2) -> tuple[np.ndarray, np.ndarray]:
        """Gaps and rates within depth and speed; ``outside`` : largest gap over depth."""
        rng = np.random.default_rng(seed)
        return rng.uniform(-self.depth, outside * self.depth, size), rng.uniform(-self.speed, self.speed, size)

    def _reached(self, kernel_run: _Driven) -> np.ndarray:
        """Memory (n, m) after a random history of contact and separation."""
        return _along(kernel_run, *self._random(7, (20, kernel_run.n), 0.3), 1e-5)[1]
