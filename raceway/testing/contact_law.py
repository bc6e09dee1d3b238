"""The conformance suite of contact laws."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.framework.contracts import ContactPairs
from raceway.framework.duties import law_report, reach_of
from raceway.testing.suite import Suite, check_class, check_kernel, duty, require
from raceway.testing.units import scale_of

if TYPE_CHECKING:
    from raceway.core.jit import Kernel
    from raceway.framework.contracts import ContactLaw

#: Contacts of a small ball bearing: curvatures 1/m, contact modulus Pa, Hertz factor N/m^1.5, load N, area of a point m2.
_CURVATURE_A, _CURVATURE_B, _MODULUS, _FACTOR, _LOAD, _AREA = 5.0, 130.0, 1.16e11, 1.3e10, 300.0, 1e-9
#: Entraining speed m/s, Young's modulus Pa, Poisson's ratio.
_SPEED, _YOUNG, _POISSON = 8.0, 2.1e11, 0.29
#: Units of all arrays that a law may get.
_PAIR_UNITS = {
    "curvature_a": "1/m", "curvature_b": "1/m", "contact_modulus": "Pa", "hertz_factor": "N/m^1.5", "reference_load": "N",
    "area": "m2", "length": "m", "ring_young": "Pa", "ring_poisson": "", "ball_young": "Pa", "ball_poisson": "",
    "running_angle": "rad", "entraining_speed": "m/s", "load": "N",
}  # fmt: skip


def example_pairs(n: int, seed: int = 1, nodal: bool = True) -> ContactPairs:
    """n running contacts, each within a factor two of those of a bearing of 30 mm bore; resultants have no ``area``."""
    rng = np.random.default_rng(seed)
    spread = rng.uniform(0.7, 1.4, (6, n))
    values = (_CURVATURE_A, _CURVATURE_B, _MODULUS, _FACTOR, _LOAD, _AREA)
    pairs = ContactPairs(*(value * row for value, row in zip(values, spread, strict=True)))
    speed, load = _SPEED * rng.uniform(0.7, 1.4, n), _LOAD * rng.uniform(0.7, 1.4, n)
    young, poisson = np.full(n, _YOUNG), np.full(n, _POISSON)
    return attrs.evolve(
        pairs, area=pairs.area if nodal else None, ring_young=young, ring_poisson=poisson, ball_young=young,
        ball_poisson=poisson, running_angle=np.zeros(n), entraining_speed=speed, load=load,
    )  # fmt: skip


def at_standstill(pairs: ContactPairs) -> ContactPairs:
    """The contacts of the mounted bearing."""
    return attrs.evolve(pairs, entraining_speed=None, load=None)


def _given(pairs: ContactPairs) -> list[str]:
    """Names of the arrays that a law gets."""
    return [name for name in _PAIR_UNITS if getattr(pairs, name) is not None]


def discretisation_of(law: ContactLaw) -> str:
    """What the suite drives a law as: resultants where it knows them."""
    return "resultant" if "resultant" in law.discretisations else "nodal"


@attrs.define(eq=False)
class Driven:
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


def drive(law: ContactLaw, n: int, discretisation: str = "") -> Driven:
    """A law built for n example contacts."""
    pairs = example_pairs(n, nodal=(discretisation or discretisation_of(law)) == "nodal")
    return Driven(law, law.kernel(), np.ascontiguousarray(law.build(pairs), dtype=float))


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
        known = {"resultant", "nodal"}
        chosen = law.discretisations
        require(isinstance(chosen, frozenset) and chosen, "`discretisations` must be a frozenset that is not empty")
        require(chosen <= known, f"`discretisations` = {sorted(chosen)}: only {sorted(known)} exist")
        require(type(law.state_size) is int and law.state_size >= 0, f"`state_size` = {law.state_size!r} must be 0 or more")
        require(type(law.dissipative) is bool, f"`dissipative` = {law.dissipative!r} must be True or False")

    @duty("build(pairs) returns (n, k) finite parameters, a row for each contact")
    def test_parameters(self, law: ContactLaw) -> None:
        pairs = example_pairs(7, nodal=discretisation_of(law) == "nodal")
        params = np.asarray(law.build(pairs))
        require(params.ndim == 2 and len(params) == 7, f"build() of 7 contacts returns shape {params.shape}, not (7, k)")
        require(params.dtype == np.float64, f"build() returns {params.dtype}, not float64")
        require(np.isfinite(params).all(), "build() returns values that are not finite")
        one = attrs.evolve(pairs, **{name: getattr(pairs, name)[2:3] for name in _given(pairs)})
        require(np.array_equal(np.asarray(law.build(one))[0], params[2]), "a contact's row depends on the other contacts")

    @duty("only a `renewed` law follows speed and load; its reach is 0 or more and vanishes with the entraining speed")
    def test_running(self, law: ContactLaw) -> str:
        """At standstill and as good as there a law is the same; 1e-15 of a speed leaves 1e-9 of any power above 0.6."""
        told = getattr(law, "renewed", False)
        require(type(told) is bool, f"`renewed` = {told!r} must be True or False")
        for name in ("reach", "report"):
            require(told or not hasattr(law, name), f"{name}() is called for laws with `renewed` = True only")
        pairs = example_pairs(9, nodal=discretisation_of(law) == "nodal")
        assert pairs.entraining_speed is not None and pairs.load is not None, "as made above"
        resting, running = np.asarray(law.build(at_standstill(pairs))), np.asarray(law.build(pairs))
        require(resting.shape == running.shape, "build() returns another number of columns at standstill")
        require(np.isfinite(resting).all(), "build() returns values that are not finite at standstill")
        if not told:
            require(np.array_equal(resting, running), "parameters follow speed or load: say renewed = True")
            return "neither speed nor load"
        slow = attrs.evolve(pairs, entraining_speed=1e-15 * pairs.entraining_speed)
        approach = np.cbrt(pairs.load / pairs.hertz_factor) ** 2
        left = float((reach_of(law, slow) / approach).max())
        require(left < 1e-9, f"a reach of {left:.2g} of Hertz's approach stays at 1e-15 of the speed: it must vanish")
        off = float(np.abs(np.asarray(law.build(slow)) - resting).max() / np.abs(resting).max())
        require(off < 1e-9, f"parameters differ by {off:.2g} from those of standstill at 1e-15 of the speed")
        one = attrs.evolve(pairs, **{name: getattr(pairs, name)[2:3] for name in _given(pairs)})
        require(reach_of(law, one)[0] == reach_of(law, pairs)[2], "a contact's reach depends on the other contacts")
        report = law_report(law, pairs)
        for name, values in {} if report is None else report.columns.items():
            require(np.shape(values) == (9,), f"report(): column '{name}' has shape {np.shape(values)}, not (9,)")
        return f"reach up to {1e6 * reach_of(law, pairs).max():.3g} µm"

    @duty("kernel() is compiled with @jit(LAW)")
    def test_signature(self, law: ContactLaw) -> None:
        from raceway.core.signatures import LAW

        check_kernel(law.kernel(), LAW, "LAW")

    @duty("zero force and derivatives for gap > 0, zero force at gap = 0")
    def test_zero_outside(self, law: ContactLaw) -> None:
        driven = drive(law, 64)
        for state in (driven.rest(), self._reached(driven)):
            for rate in (-self.speed, 0.0, self.speed):
                for gap in (0.0, 1e-300, 1e-9, self.depth, 1.0):
                    force, d_gap, d_rate, _ = driven(gap, rate, state)
                    require(not force.any(), f"force {np.abs(force).max():.3g} at gap {gap:g} m, rate {rate:g} m/s")
                    if gap > 0.0:
                        require(not d_gap.any() and not d_rate.any(), f"derivatives are not zero at gap {gap:g} m")

    @duty("the force is never negative")
    def test_never_negative(self, law: ContactLaw) -> None:
        driven, rng = drive(law, 4096), np.random.default_rng(2)
        for speed in (self.speed, 100.0 * self.speed):
            gap, rate = rng.uniform(-self.depth, 0.2 * self.depth, 4096), rng.uniform(-speed, speed, 4096)
            force = driven(gap, rate, self._reached(driven))[0]
            worst = int(np.argmin(force))
            require(force[worst] >= 0.0, f"force {force[worst]:.4g} at gap {gap[worst]:.3g} m, rate {rate[worst]:.3g} m/s")

    @duty("the force never falls as the approach grows, at any rate and memory")
    def test_monotonic(self, law: ContactLaw) -> None:
        driven = drive(law, 16)
        approaches = np.concatenate([np.geomspace(1e-12, 1e-8, 40), np.linspace(1e-8, self.depth, 400)])
        for state in (driven.rest(), self._reached(driven)):
            for rate in (-self.speed, 0.0, self.speed):
                forces = np.array([driven(-a, rate, state)[0] for a in approaches])
                fall = np.diff(forces, axis=0)
                step, contact = np.unravel_index(np.argmin(fall), fall.shape)
                require(
                    fall[step, contact] >= -1e-12 * forces.max(),
                    f"from an approach of {approaches[step]:.4g} to {approaches[step + 1]:.4g} m the force falls by "
                    f"{-fall[step, contact]:.3g} at rate {rate:g} m/s",
                )
        require(driven(-self.depth)[0].min() > 0.0, f"no force at an approach of {self.depth:g} m")

    @duty("d_gap and d_rate are the derivatives of the force, memory and time step held")
    def test_derivatives(self, law: ContactLaw) -> str:
        """Central differences; a point whose two sides disagree straddles a kink, which few may."""
        driven, rng = drive(law, 2000), np.random.default_rng(3)
        kinks = 0
        for state in (driven.rest(), self._reached(driven)):
            for dt in (1e-5, 1e-3):
                gap = -rng.uniform(0.002, 1.0, 2000) * self.depth
                rate = rng.uniform(-1.0, 1.0, 2000) * self.speed
                force, d_gap, d_rate, _ = driven(gap, rate, state, dt)
                for word, given, size, which in (("d_gap", d_gap, self.depth, 0), ("d_rate", d_rate, self.speed, 1)):
                    h = 1e-6 * size
                    up = driven(gap + h * (which == 0), rate + h * (which == 1), state, dt)[0]
                    down = driven(gap - h * (which == 0), rate - h * (which == 1), state, dt)[0]
                    slope = (up - down) / (2.0 * h)
                    scale = np.abs(given) + 1e-3 * np.abs(force).max() / size
                    bent = np.abs(up - 2.0 * force + down) / h > 1e-3 * scale
                    # Truncation: (h / approach)^2 / 24, at most 1e-8 here; rounding: 1e-16 / 1e-6 of the largest force.
                    wrong = (np.abs(slope - given) > 1e-5 * scale) & ~bent
                    at = int(np.argmax(wrong))
                    require(
                        not wrong.any(),
                        f"{word} = {given[at]:.6g} but differences give {slope[at]:.6g} at gap {gap[at]:.3g} m, rate "
                        f"{rate[at]:.3g} m/s, dt {dt:g} s",
                    )
                    kinks += int(bent.sum())
                    require(bent.mean() < 0.1, f"{word}: the force has a kink at {100.0 * bent.mean():.0f} % of all points")
        return f"{kinks} of 16000 differences straddle a kink" if kinks else ""

    @duty("a closed cycle never gains energy, and loses none unless `dissipative`")
    def test_closed_cycle(self, law: ContactLaw) -> str:
        """Cycles that leave contact and cycles that do not, slow and fast, some with a second harmonic."""
        n, steps, turns = 6, 400, 3
        driven = drive(law, n)
        phase = 2.0 * np.pi * np.arange(steps * turns + 1) / steps
        mean = np.array([0.5, 0.0, 0.8, 0.3, 0.6, -0.2])[None, :] * self.depth
        first = np.array([0.4, 0.9, 0.1, 0.6, 0.2, 0.7])[None, :] * self.depth
        second = np.array([0.0, 0.0, 0.1, 0.1, 0.3, 0.2])[None, :] * self.depth
        approach = mean - first * np.cos(phase)[:, None] + second * np.cos(2.0 * phase)[:, None]
        slope = first * np.sin(phase)[:, None] - 2.0 * second * np.sin(2.0 * phase)[:, None]
        largest = 0.0
        for frequency in (1.0, 100.0, 400.0):
            w = 2.0 * np.pi * frequency
            forces = self._along(driven, -approach, -slope * w, 1.0 / (frequency * steps))
            # Trapezoids in the approach: for a law without rate or memory the way back cancels the way in exactly.
            work = 0.5 * (forces[1:] + forces[:-1]) * np.diff(approach, axis=0)
            size = np.abs(work).sum(axis=0) / turns + 1e-300
            lost = work.reshape(turns, steps, n).sum(axis=1) / size
            worst = lost[1:].min()
            # Quadrature of 400 steps: a dissipating law's loss is known to about 1e-4 of the energy that passes.
            allowed = 1e-4 if law.dissipative else 1e-10
            require(worst >= -allowed, f"a cycle of {frequency:g} Hz gains {-worst:.3g} of the energy that passes through")
            if not law.dissipative:
                gone = lost.max()
                require(
                    gone <= 1e-10,
                    f"a cycle of {frequency:g} Hz loses {gone:.3g} of the energy that passes: say dissipative = True",
                )
            largest = max(largest, float(lost.max()))
        return f"loses up to {100.0 * largest:.3g} % a cycle" if law.dissipative else ""

    @duty("a law of both discretisations is a pressure where it gets an area: zero outside, growing, derivative exact")
    def test_pressures(self, law: ContactLaw) -> str:
        if law.discretisations != {"resultant", "nodal"}:
            return "one discretisation"
        driven, h = drive(law, 64, "nodal"), 1e-6 * self.depth
        approaches = np.linspace(0.01, 1.0, 100) * self.depth
        outside = driven(1e-9)
        require(not outside[0].any() and not outside[1].any(), "a pressure or a derivative outside contact")
        pressures = np.array([driven(-a)[0] for a in approaches])
        require((pressures >= 0.0).all() and (np.diff(pressures, axis=0) >= 0.0).all(), "the pressure falls or is negative")
        require(pressures[-1].min() > 0.0, f"no pressure at an approach of {self.depth:g} m")
        for a in approaches[::10]:
            slope = (driven(-a + h)[0] - driven(-a - h)[0]) / (2.0 * h)
            given = driven(-a)[1]
            # Truncation of the differences: (h / approach)^2, at most 1e-8.
            worst = np.abs(slope - given).max() / max(np.abs(given).max(), 1e-300)
            require(worst < 1e-5, f"d_gap is off by {worst:.2g} at an approach of {a:.3g} m")
        return ""

    @duty("empty and long arrays; a contact does not depend on its neighbours")
    def test_array_lengths(self, law: ContactLaw) -> None:
        for n in (0, 1, 100_000):
            driven = drive(law, n)
            rng = np.random.default_rng(4)
            gap, rate = rng.uniform(-self.depth, 0.2 * self.depth, n), rng.uniform(-self.speed, self.speed, n)
            results = driven(gap, rate)
            require(all(np.isfinite(r).all() for r in results), f"results of {n} contacts are not all finite")
            if n > 1:
                turned = Driven(law, driven.kernel, np.ascontiguousarray(driven.params[::-1]))
                back = turned(gap[::-1], rate[::-1])
                same = all(np.array_equal(a, b[::-1]) for a, b in zip(results, back, strict=True))
                require(same, "the order of the contacts changes their results")

    @duty("the kernel allocates no memory")
    def test_no_allocation(self, law: ContactLaw) -> None:
        from raceway.testing.allocation import counted
        from raceway.testing.compiled import repeat_law

        driven = drive(law, 256)
        gap, rate = np.linspace(-self.depth, 0.1 * self.depth, 256), np.zeros(256)
        state, out = driven.rest(), np.zeros((3, 256))
        blocks = []
        for count in (1, 1001):
            with counted() as block:
                repeat_law(count, driven.kernel, gap, rate, driven.params, state, state.copy(), 1e-5, *out)
            blocks.append(block.blocks)
        each = (blocks[1] - blocks[0]) / 1000.0
        require(each == 0.0, f"a call allocates {each:g} blocks of memory")

    @duty("finite for extreme input")
    def test_extreme_input(self, law: ContactLaw) -> None:
        driven = drive(law, 8)
        for state in (driven.rest(), self._reached(driven)):
            for gap in (-1.0, -1e-3, -1e-15, -5e-324, -0.0, 0.0, 1e300):
                for rate in (-1e4, -1e-300, 0.0, 1e4):
                    for dt in (0.0, 1e-15, 1.0):
                        finite = all(np.isfinite(r).all() for r in driven(gap, rate, state, dt))
                        require(finite, f"not finite at gap {gap:g} m, rate {rate:g} m/s, dt {dt:g} s")

    @duty("every entry of every output is overwritten, and twice the same input gives the same output")
    def test_overwrites(self, law: ContactLaw) -> None:
        driven, rng = drive(law, 512), np.random.default_rng(5)
        gap, rate = rng.uniform(-self.depth, self.depth, 512), rng.uniform(-self.speed, self.speed, 512)
        state = self._reached(driven)
        first, second = driven(gap, rate, state), driven(gap, rate, state)
        for word, a, b in zip(("force", "d_gap", "d_rate", "state_new"), first, second, strict=True):
            require(not np.isnan(a).any(), f"`{word}` is not overwritten whole")
            require(np.array_equal(a, b), f"`{word}` differs between two calls with the same input")

    @duty("gap, gap_rate, params and state_old are left untouched")
    def test_input_untouched(self, law: ContactLaw) -> None:
        driven, rng = drive(law, 512), np.random.default_rng(6)
        gap, rate = rng.uniform(-self.depth, self.depth, 512), rng.uniform(-self.speed, self.speed, 512)
        given = {"gap": gap, "gap_rate": rate, "params": driven.params, "state_old": self._reached(driven)}
        before = {word: array.copy() for word, array in given.items()}
        driven(gap, rate, given["state_old"])
        changed = [word for word in given if not np.array_equal(given[word], before[word])]
        require(not changed, f"{', '.join(changed)} changed")

    @duty("no unit is built in: other units of length, force and time, in pairs and options, give the same physics")
    def test_unit_invariance(self, law: ContactLaw) -> str:
        length, force, time = 1.7, 0.6, 1.3
        options = {}
        for field in attrs.fields(type(law)):
            value = getattr(law, field.name)
            if isinstance(value, float):
                options[field.name] = value * scale_of(field.metadata.get("unit", ""), length, force, time)
        try:
            given: Any = law  # a contract is no attrs class to mypy
            other = attrs.evolve(given, **options)
        except ValueError as why:
            return f"not checked: the options' own rules refuse other units ({why})"
        pairs = example_pairs(64, nodal=discretisation_of(law) == "nodal")
        scaled = ContactPairs(
            **{name: getattr(pairs, name) * scale_of(_PAIR_UNITS[name], length, force, time) for name in _given(pairs)}
        )
        a = Driven(law, law.kernel(), np.ascontiguousarray(law.build(pairs), dtype=float))
        b = Driven(other, other.kernel(), np.ascontiguousarray(other.build(scaled), dtype=float))
        gap, rate = self._random_path(64)
        forces = self._along(a, gap, rate, 1e-5)
        others = self._along(b, gap * length, rate * length / time, 1e-5 * time)
        area = 1.0 if "resultant" in law.discretisations else length**2
        wrong = np.abs(others * area / force - forces).max() / forces.max()
        require(
            wrong < 1e-9, f"forces differ by {wrong:.2g} in other units: a dimensional number hides in build() or the kernel"
        )
        reached, other_reach = reach_of(law, pairs), reach_of(other, scaled) / length
        wrong = np.abs(other_reach - reached).max() / max(reached.max(), 1e-300)
        require(wrong < 1e-9, f"reach() differs by {wrong:.2g} in other units: a dimensional number hides in it")
        return ""

    def _along(self, driven: Driven, gaps: np.ndarray, rates: np.ndarray, dt: float) -> np.ndarray:
        """Forces (steps, n) along paths, from memory at rest."""
        from raceway.testing.compiled import along_path

        state, forces = driven.rest(), np.zeros_like(gaps)
        gaps, rates = np.ascontiguousarray(gaps), np.ascontiguousarray(rates)
        along_path(driven.kernel, gaps, rates, driven.params, dt, state, state.copy(), np.zeros((2, driven.n)), forces)
        return forces

    def _random_path(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        rng = np.random.default_rng(7)
        return rng.uniform(-self.depth, 0.3 * self.depth, (20, n)), rng.uniform(-self.speed, self.speed, (20, n))

    def _reached(self, driven: Driven) -> np.ndarray:
        """Memory (n, m) after a random history of contact and separation."""
        from raceway.testing.compiled import along_path

        state = driven.rest()
        if state.size:
            gaps, rates = self._random_path(driven.n)
            along_path(
                driven.kernel, gaps, rates, driven.params, 1e-5, state, state.copy(), np.zeros((2, driven.n)), gaps * 0.0
            )
        return state
