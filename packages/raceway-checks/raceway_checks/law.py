"""One contact of a bearing in the laboratory, ``raceway.law``: what its law does with an approach and the approach's rate, beside Hertz'.

A cycle moves the contact harmonically about its equilibrium.  With the approach d = d_0 + x cos(w t), a = (2/T) int F cos(w t) dt and
b = -(2/T) int F sin(w t) dt over one period: K = a / x, C = b / (w x), and the energy per cycle is W = int F dd = pi b x = pi C w x^2.
The loss factor is w C / K, the tangent of the phase.  Means over equal samples of a period are exact for the smooth forces of closed
contacts.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import attrs
import numpy as np

from raceway import Answer, RacewayError, Scene, SceneError, at_least, build_model, door, positive
from raceway.extend import (
    PATHS, TIME_CONSTANTS, Change, Fact, Increment, Part, SceneSource, System, Tables, Words, as_given, compiled,
    damping_origin, registry_with, resolve, sections, single_contact, solve_equilibrium,
)  # fmt: skip

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: The bearing of the article under its load, where no scene is given, and the frequency of its cycle [Hz].
BASE: Tables = {"title": "B7206C, 1 kN axial", "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
_FREQUENCY = 200.0
RACES = ("inner", "outer")
#: Ends and points of the curves, over the elastic approach of the equilibrium: from an open contact to some three times Hertz' load.
_FIRST, _LAST, _POINTS = -0.2, 2.0, 111
#: Approaches of the table over that of the equilibrium.
_SHARES = (0.25, 0.5, 1.0, 1.5, 2.0)
#: Samples per period, and periods of a law with memory, of which the last is taken: by then it has forgotten the start of the motion.
SAMPLES, _PERIODS = 720, 4
#: Of a mean of so many samples, over the largest force.
_ROUNDING = 1e-13


@attrs.frozen(eq=False)
class LawContact:
    """One ball-race contact in its equilibrium, alone."""

    race: str  # "inner" or "outer"
    ball: int  # its number, from 0
    load: float  # normal force [N]
    approach: float  # minus the gap between the undeformed surfaces [m]
    reach: float  # gap at which the contact begins to carry [m]: 0, or what a film puts between the surfaces
    hertz_factor: float  # K of Hertz' force K delta^1.5 [N/m^1.5]
    system: System  # a mass against the contact alone, whose x is approach + reach

    def at(
        self, approach: float, rate: float = 0.0, step: Increment | None = None
    ) -> tuple[float, float, float, np.ndarray]:
        """Force [N], its derivatives by approach [N/m] and by the approach's rate [N s/m], and the law's memory (2, m).

        approach, rate : [m, m/s];  step : since the memory was committed; None: at rest, without a history
        """
        q, v = np.zeros(5), np.zeros(5)
        q[0], v[0] = approach + self.reach, rate
        now = self.system.evaluate(q, v, ball=np.zeros((1, 2)), step=step or Increment())
        return float(now.force[0]), float(now.stiffness[0, 0]), float(now.damping[0, 0]) + 0.0, now.memory  # no -0

    def curves(self, approach: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """(3, m, n) force, stiffness and damping over rates (m,) [m/s] and approaches (n,) [m], each without a history."""
        return np.moveaxis(np.array([[self.at(float(x), float(rate))[:3] for x in approach] for rate in rates]), -1, 0)

    def hertz(self, approach: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Force and stiffness (n,) by Hertz' law over approaches (n,) [m]."""
        deep = np.maximum(approach, 0.0)
        return self.hertz_factor * deep**1.5, 1.5 * self.hertz_factor * np.sqrt(deep)

    def row(self, elastic: float) -> Tables:
        """The law at rest at an elastic approach [m], and over Hertz'; None where Hertz' contact is open."""
        approach = elastic - self.reach
        force, stiffness, damping, _ = self.at(approach)
        ((hertz_force,), (hertz_stiffness,)) = self.hertz(np.array([approach]))
        contact = approach > 0.0
        return {
            "approach": approach,
            "force": force,
            "force_ratio": force / float(hertz_force) if contact else None,
            "stiffness": stiffness,
            "stiffness_ratio": stiffness / float(hertz_stiffness) if contact else None,
            "damping": damping,
        }


@attrs.frozen(eq=False)
class _Cycle:
    """One period of the approach."""

    frequency: float  # [Hz]
    amplitude: float  # x [m]
    #: approach, rate, force : (n,) over one period [m, m/s, N]
    approach: np.ndarray
    rate: np.ndarray
    force: np.ndarray
    stiffness: float  # K [N/m]
    damping: float  # C [N s/m]
    energy: float  # lost [J]
    loss_factor: float | None  # w C / K; None without K
    opens: bool  # whether the contact opens on the way


@attrs.frozen(eq=False, repr=False)
class LawCurves(Answer):
    """What a contact law does with one contact of a bearing, beside Hertz' law.

    Attributes
    ----------
    law : its name;  title : of the scene;  damping_origin : what damps it, in words
    contact : the contact in its equilibrium
    approach : (n,) minus the gap between the undeformed surfaces [m];  rate : (3,) 0 and the cycle's largest, closing and opening [m/s]
    force, stiffness, damping : (3, n) at these rates, each without a history [N, N/m, N s/m]
    hertz_force, hertz_stiffness : (n,) [N, N/m]
    cycle : a harmonic motion about the equilibrium
    rows : of the table: the law at rest and its ratio to Hertz'

    Examples
    --------
    >>> import raceway as rw
    >>> curves = rw.law("hertz", None, "contact.damping=300")
    >>> [round(1e-6 * curves.cycle.stiffness, 1), round(curves.cycle.damping, 1)]  # N/um, N s/m
    [86.7, 300.0]
    """

    stem: ClassVar[str] = "law"

    law: str
    title: str
    damping_origin: str
    contact: LawContact
    approach: np.ndarray
    rate: np.ndarray
    force: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    hertz_force: np.ndarray
    hertz_stiffness: np.ndarray
    cycle: _Cycle
    rows: tuple[Tables, ...]

    def to_dict(self) -> Tables:
        """Contact, table, curves and cycle as plain tables, SI."""
        curves = ("approach", "rate", "force", "stiffness", "damping", "hertz_force", "hertz_stiffness")
        cycle = attrs.asdict(self.cycle)
        return {
            **{key: getattr(self, key) for key in ("law", "title", "damping_origin")},
            **{key: getattr(self.contact, key) for key in ("race", "ball", "load", "approach", "reach", "hertz_factor")},
            "rows": list(self.rows),
            "curves": {name: getattr(self, name).tolist() for name in curves},
            "cycle": {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in cycle.items()},
        }

    def draw(self) -> Figure:
        """Force, stiffness, damping and the cycle's loop."""
        from raceway.extend import Line, Plot, draw_panels

        micro, contact, motion = 1e6 * self.approach, self.contact, self.cycle
        damped = motion.energy != 0.0 or bool(self.damping.any())

        def lines(numbers: np.ndarray, rates: bool = True) -> list[Line]:
            moving = ((1, "closing"), (2, "opening")) if damped and rates else ()
            words = ["at rest", *(f"{word} at {1e3 * abs(self.rate[k]):.3g} mm/s" for k, word in moving)]
            return [Line(micro, row, word, 2 * k) for k, (row, word) in enumerate(zip(numbers, words, strict=False))]

        force = [*lines(self.force), Line(micro, self.hertz_force, "Hertz", 1)]
        force += [Line(np.array([1e6 * contact.approach]), np.array([contact.load]), "equilibrium", style={"linestyle": ""})]
        stiffness = [*lines(1e-6 * self.stiffness, False), Line(micro, 1e-6 * self.hertz_stiffness, "Hertz", 1)]
        x, origin = "approach [µm]", "Force" if damped else f"Force; {self.damping_origin}"
        rows = [
            [Plot(tuple(force), x, "force [N]", origin), Plot(tuple(stiffness), x, "stiffness [N/µm]", "Stiffness at rest")]
        ]
        if damped:
            title = f"Cycle at {motion.frequency:.4g} Hz: {1e6 * motion.energy:.3g} µJ lost\nC {motion.damping:.4g} N s/m"
            cycle = Plot((Line(1e6 * motion.approach, motion.force),), x, "force [N]", title)
            rows.append([cycle, Plot(tuple(lines(self.damping)), x, "damping [N s/m]", "Damping: force over rate")])
        first = self.title.partition("\n")[0]
        return draw_panels(rows, f"{self.law}, {contact.race} contact of ball {contact.ball}: {first}")

    def report(self) -> Iterator[Part]:
        """The contact, the law beside Hertz', the cycle."""
        contact, loop = self.contact, self.cycle
        load = f"{contact.load:.4g} N at an approach of {1e6 * contact.approach:.4g} µm"
        yield Words(f"{self.law}: {contact.race} contact of ball {contact.ball}, {load}", "bold")
        yield Words(self.title, "dim")
        if contact.reach > 0.0:
            yield f"it begins to carry at a gap of {1e6 * contact.reach:.4g} µm"
        yield [
            {
                "approach\nµm": f"{1e6 * row['approach']:.4g}",
                "force\nN": f"{row['force']:.5g}",
                "F over\nHertz'": _ratio(row["force_ratio"]),
                "stiffness\nN/µm": f"{1e-6 * row['stiffness']:.5g}",
                "k over\nHertz'": _ratio(row["stiffness_ratio"]),
                "damping\nN s/m": f"{row['damping']:.4g}",
            }
            for row in self.rows
        ]
        yield sections([
            ("Cycle", "", ""),
            ("amplitude", f"{1e6 * loop.amplitude:.4g} µm", f"about the equilibrium, at {loop.frequency:.4g} Hz"),
            ("stiffness K", f"{1e-6 * loop.stiffness:.5g} N/µm", "in phase with the approach"),
            ("damping C", f"{loop.damping:.4g} N s/m", "in phase with its rate"),
            ("energy lost", f"{1e6 * loop.energy:.4g} µJ", f"a cycle; {self.damping_origin}"),
            ("loss factor", _ratio(loop.loss_factor), "w C / K"),
        ])  # fmt: skip
        if loop.opens:
            yield "the contact opens on the way"

    def _facts(self) -> tuple[str, list[Fact]]:
        c, loop = self.contact, self.cycle
        return (
            f"{self.law}, {c.race} contact of ball {c.ball}\n{self.title}",
            [
                ("load, approach", f"{c.load:.4g} N", f"{1e6 * c.approach:.4g} µm"),
                ("K, C", f"{1e-6 * loop.stiffness:.4g} N/µm", f"{loop.damping:.4g} N s/m, {loop.frequency:.4g} Hz"),
                ("energy per cycle", f"{1e6 * loop.energy:.3g} µJ", self.damping_origin),
            ],
        )


@door
def law(
    name: str,
    scene: SceneSource | None = None,
    *changes: Change,
    race: str = "inner",
    ball: Annotated[int | None, at_least(0)] = None,
    amplitude: Annotated[float, positive()] = 0.2,
    frequency: Annotated[float | None, positive()] = None,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
) -> LawCurves:
    """Force, stiffness, damping and energy per cycle of a contact law at one contact of a bearing.

    Parameters
    ----------
    name : name of the law
    scene : Scene, path, TOML text or dict of tables with rigid bodies; None: B7206C under 1 kN axial load
    changes : changes of the scene as for ``raceway.evolve``, for instance ``"contact.damping=300"``
    race : "inner" or "outer";  ball : number of the ball, from 0 over all rows; None: the most loaded one
    amplitude : amplitude of the cycle over the elastic approach at equilibrium
    frequency : frequency of the cycle [Hz]; None: the excitation's, else 200 Hz
    plugins : files of one-off plug-ins that hold the law

    Returns
    -------
    LawCurves
        ``approach``, ``force``, ``stiffness``, ``damping``, ``hertz_force``, ``cycle``; ``picture(folder)``

    Raises
    ------
    SceneError
        An unknown law, mistakes of the scene, bodies that are not rigid, a ball or race that is not there, a cycle without size.
    RacewayError
        A contact that carries nothing.
    ConvergenceError
        No equilibrium.

    Examples
    --------
    >>> import raceway as rw
    >>> curves = rw.law("penalty")
    >>> [round(row["stiffness_ratio"], 2) for row in curves.rows]  # against Hertz', at 1/4 to 2 times the approach at rest
    [0.67, 0.94, 1.33, 1.63, 1.89]
    """
    inputs = as_given(BASE if scene is None else scene).changed({"contact.kind": name}, *changes)
    read = inputs.scene(registry_with(plugins))
    if read.contact.in_a_band:
        low, high = TIME_CONSTANTS
        rule = f"is a band; one contact needs one value: set contact.time_constant, from {low:g} to {high:g} s"
        raise SceneError.at("contact.damping", "band", rule)
    if frequency is None:
        period = None if read.excitation is None else read.excitation.period_s
        frequency = _FREQUENCY if period is None else 1.0 / period
    contact = _contact_of(read, race, ball)
    elastic = contact.approach + contact.reach
    size = amplitude * elastic
    approach = np.linspace(_FIRST, _LAST, _POINTS) * elastic - contact.reach
    rate = 2.0 * np.pi * frequency * size * np.array([0.0, 1.0, -1.0])
    force, stiffness, damping = contact.curves(approach, rate)
    hertz_force, hertz_stiffness = contact.hertz(approach)
    return LawCurves(
        read.contact.kind, read.title, damping_origin(resolve(read)), contact, approach, rate, force, stiffness, damping,
        hertz_force, hertz_stiffness, cycle(contact, size, frequency), tuple(contact.row(share * elastic) for share in _SHARES),
    )  # fmt: skip


def _contact_of(scene: Scene, race: str = "inner", ball: int | None = None) -> LawContact:
    """A contact of a scene with rigid bodies, in its equilibrium; arguments and errors as of ``law``."""
    if race not in RACES:
        raise SceneError.at("race", race, f"must be one of {', '.join(RACES)}")
    if not resolve(scene).traits.contacts_alone:
        rule = "has contacts whose approach bodies share by their compliance: use bodies.kind = 'rigid' to see a law alone"
        raise SceneError.at("bodies.kind", scene.bodies.name, rule)
    model = build_model(scene)
    still, ring = solve_equilibrium(model), compiled(model.system)
    assert ring is not None, "contacts that deform alone are compiled"
    count = ring.ball_count
    loads = still.contact_force.reshape(2, count)[RACES.index(race)]
    number = int(np.argmax(loads)) if ball is None else ball
    if not 0 <= number < count:
        raise SceneError.at("ball", ball, f"must be from 0 to {count - 1}")
    index, load = RACES.index(race) * count + number, float(loads[number])
    if load <= 0.0:
        rule = f"is unloaded at the {race} race; the most loaded is {int(np.argmax(loads))}"
        raise RacewayError(f"ball {number} {rule}" if loads.any() else f"no ball is loaded at the {race} race")
    ellipse = model.inner if race == "inner" else model.outer
    factors = np.broadcast_to(np.asarray(ellipse.factor, dtype=float), count)
    reach = 0.0 if ring.reach is None else float(ring.reach[index])
    approach = -float(still.gap[index]) - reach
    return LawContact(race, number, load, approach, reach, float(factors[number]), single_contact(ring, index))


def cycle(contact: LawContact, amplitude: float, frequency: float) -> _Cycle:
    """A contact moved about its equilibrium with an amplitude [m] and a frequency [Hz]."""
    w = 2.0 * np.pi * frequency
    phase = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    approach, rate = contact.approach + amplitude * np.cos(phase), -w * amplitude * np.sin(phase)
    remembers = contact.system.law_state.size > 0
    step = Increment(0.0, 0.0, np.zeros_like(contact.system.law_state))  # no time has passed before the first sample
    force = np.empty(SAMPLES)
    for _ in range(_PERIODS if remembers else 1):
        for k in range(SAMPLES):
            force[k], _, _, memory = contact.at(float(approach[k]), float(rate[k]), step)
            step = attrs.evolve(step, dt=1.0 / (frequency * SAMPLES), memory=memory)
    in_phase, ahead = 2.0 * float(np.mean(force * np.cos(phase))), -2.0 * float(np.mean(force * np.sin(phase)))
    ahead = ahead if abs(ahead) > _ROUNDING * float(np.max(force)) else 0.0
    return _Cycle(
        frequency, amplitude, approach, rate, force, in_phase / amplitude, ahead / (w * amplitude), np.pi * ahead * amplitude,
        ahead / in_phase if in_phase > 0.0 else None, bool((force <= 0.0).any()),
    )  # fmt: skip


def _ratio(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"
