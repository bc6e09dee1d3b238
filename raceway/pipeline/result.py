"""What a run leaves: numbers with error and cost, as an object and as result.json."""

from __future__ import annotations

import math
from collections.abc import Iterable
from contextlib import suppress
from functools import cached_property
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, cast, overload

import attrs
import numpy as np

from raceway.answers.answer import Answer, Part
from raceway.answers.quantities import C_ERROR, DRY, IDENTIFIED, KXX, KYY, KYY_TILTS_FOLLOW, C, K, X, Z
from raceway.bodies.model import Equilibrium, Model, tilts_follow
from raceway.core.signals import Identification, Line
from raceway.errors import PluginError, RacewayError
from raceway.framework.contracts import Format
from raceway.framework.doors import PATH, door
from raceway.framework.duties import of_results
from raceway.framework.estimate import Note, few_words
from raceway.framework.loading.registry import Entry, Registry
from raceway.framework.loading.sources import blamed
from raceway.framework.options import nearest
from raceway.framework.shown import Fact, in_micro, largest_facts, number, tilt_words
from raceway.pipeline.content import AtRest, Content, ErrorTable
from raceway.pipeline.equilibrium import equilibrium_table, largest_contacts, motion_table, pressures
from raceway.pipeline.error import Errors
from raceway.pipeline.plausible import Spread, closed_bound, model_spread
from raceway.pipeline.quantities import StatedQuantities
from raceway.pipeline.simulate import Simulation
from raceway.pipeline.uncertainty import stated, uncertainty_table
from raceway.planning.resolve import Problem
from raceway.scene.catalogue import geometry_of
from raceway.scene.tables import TIME_CONSTANTS
from raceway.storage.files import without_nan
from raceway.storage.tables import Tables, nested

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from raceway.pipeline.gradient import Gradient

SCHEMA = 2
#: Of a spectral line, in the order of ``Line``.
_LINE = ("name", "frequency_hz", "forward_m", "backward_m", "axial_m")
#: The entry in the registry of a format of results, and the format with its options' defaults.
Chosen = tuple["Entry", "Format"]


@attrs.frozen(eq=False, repr=False, slots=False)
class Result(Answer):
    """One run.  ``to_dict`` gives result.json; the arrays stay on the object.

    Attributes
    ----------
    model : the bearing as it was computed; ``model.scene`` and ``model.plan`` are what it was made from
    equilibrium : the static state under the constant loads, with ``gap`` [m] and ``contact_force`` [N] of every contact
    identification, simulation : None in a static scene (simulation also where the identifier needs no motion)
    errors : of Z, by their parts, each with how it was estimated
    cost, stability, environment : the tables of result.json
    bodies : the table ``model``: what elastic bodies change against rigid ones; None for rigid bodies
    stated : numbers, tables and warnings of plug-ins of quantities
    lines : spectral components of the motion, empty where it was not recorded or its speed changes
    warnings : tuple of str, the weightiest first
    band : numbers [low, high] at both ends of the band of time constants, for ``contact.damping`` = "band"; all else is the low end's
    reports : what ``save`` writes beside result.json

    Examples
    --------
    >>> import raceway as rw
    >>> result = rw.run({"bearing": {"preset": "B7206C"}, "load": {"axial": "1 kN"}})
    >>> result.stiffness.shape, result.ball_loads.shape
    ((5, 5), (12,))
    """

    stem: ClassVar[str] = "result"

    model: Model
    equilibrium: Equilibrium
    identification: Identification | None
    simulation: Simulation | None
    errors: Errors
    cost: dict[str, float]
    stability: Tables
    environment: Tables
    lines: list[Line]
    stated: StatedQuantities
    warnings: tuple[str, ...]
    bodies: Tables | None = None
    band: Tables | None = None
    reports: tuple[Chosen, ...] = ()

    @property
    def title(self) -> str:
        """Of the scene; its second line says what was changed."""
        return self.model.scene.title

    @property
    def displacement(self) -> np.ndarray:
        """(5,) static displacement of the inner ring: x, y, z [m], tilt_y, tilt_z [rad]."""
        return self.equilibrium.displacement

    @property
    def stiffness(self) -> np.ndarray:
        """(5, 5) tangent of the contacts, rows on a spring following [N/m, N/rad, N m/m, N m/rad]; kyy, tilts held, is [1, 1]."""
        return self.equilibrium.stiffness

    @property
    def kyy_tilts_follow(self) -> float | None:
        """Radial stiffness with tilts that follow, x and z held [N/m]; None where ``supports.tilt`` is "locked"."""
        return tilts_follow(self.stiffness, self.model.problem.supports.tilt)

    @property
    def damping(self) -> np.ndarray:
        """(5, 5) damping of the contacts at the equilibrium [N s/m, N s/rad, N m s/m, N m s/rad]; 0 where they are dry."""
        return self.equilibrium.damping

    @property
    def ball_loads(self) -> np.ndarray:
        """(Z,) static load of each ball on the inner race [N]; of a pair, row after row."""
        return self.equilibrium.contact_force[: self.model.system.ball_count]

    @property
    def speed_rpm(self) -> float | None:
        """Speed of the force whose 1x response is identified [r/min]; None in a static scene."""
        return None if self.identification is None else self.identification.frequency_hz * 60.0

    @property
    def dynamic_stiffness(self) -> complex | None:
        """Z = F/x, complex [N/m]; None in a static scene."""
        return None if self.identification is None else self.identification.dynamic_stiffness

    @property
    def equivalent_stiffness(self) -> float | None:
        """K = Re Z + m w^2 [N/m]; None in a static scene."""
        return None if self.identification is None else self.identification.equivalent_stiffness

    Z, K = dynamic_stiffness, equivalent_stiffness

    @property
    def error(self) -> ErrorTable:
        """The table ``error`` of result.json, but for ``model``, which takes solutions of its own."""
        return self.errors.table

    @property
    def equivalent_stiffness_error(self) -> float | None:
        """Estimated absolute error of K [N/m]; None where it is not estimated."""
        total, z = self.errors.total.size, self.dynamic_stiffness
        return None if total is None or z is None else total * abs(z)

    @property
    def equivalent_damping(self) -> float | None:
        """C = Im Z / w [N s/m]; None in a static scene."""
        return None if self.identification is None else self.identification.equivalent_damping

    C = equivalent_damping

    @property
    def dynamic_stiffness_imag_error(self) -> float | None:
        """Estimated absolute error of Im Z [N/m]; None where it is not estimated."""
        across, z = self._across(), self.identification
        return None if across is None or z is None else across * abs(z.dynamic_stiffness)

    @property
    def equivalent_damping_error(self) -> float | None:
        """Estimated absolute error of C [N s/m]; None where it is not estimated.  A smaller C is not resolved."""
        error, z = self.dynamic_stiffness_imag_error, self.identification
        return None if error is None or z is None else error / z.speed

    @property
    def phase_lag_error_deg(self) -> float | None:
        """Estimated absolute error of the lag [deg]; None where it is not estimated."""
        across = self._across()
        return None if across is None else math.degrees(across)

    @door
    def gradient(self, path: str) -> Gradient:
        """Derivatives by the number at one key: of displacement, stiffness and ball loads, and of Z, K, C where there is an excitation.

        Parameters
        ----------
        path : a continuous key of the scene, such as "load.axial" or "load.radial[0]"

        Notes
        -----
        Differences of neighbouring solutions; the steady orbit of the excitation is searched for once a call.
        ``raceway.sensitivities`` gives all keys at once.

        Raises
        ------
        SceneError
            No continuous key, one without a derivative, or bodies whose contacts have none.
        ConvergenceError
            No steady orbit was found.

        Examples
        --------
        >>> import raceway as rw
        >>> result = rw.run({"bearing": {"preset": "B7206C"}, "load": {"axial": "1 kN"}})
        >>> slope = result.gradient("load.axial").statics.stiffness[0, 0]  # d kxx / d axial load [1/m]
        >>> round(float(slope * 1000.0 / result.stiffness[0, 0]), 2)  # one per cent more load, so many per cent more kxx
        0.54
        """
        from raceway.pipeline.gradient import Gradients

        return Gradients(self.model, self.equilibrium).by_path(path)

    @cached_property
    def tolerances(self) -> Tables | None:
        """95 % band over the scene's [tolerances] to first order, by derivatives; None without that table."""
        if "tolerances" not in self.model.scene.source:
            return None
        from raceway.pipeline.first_order import first_order_band

        return first_order_band(self.model, self.equilibrium)

    @cached_property
    def spread(self) -> tuple[Spread | None, Note]:
        """Change of K and kyy by hypotheses left at their defaults, and how it was found."""
        return model_spread(self.model, self.equilibrium, self.identification, self.simulation)

    @property
    def model_spread(self) -> tuple[Tables | None, Note]:
        """The same as ``error.model`` of result.json has it."""
        spread, note = self.spread
        return None if spread is None else spread.table, note

    @property
    def model_bound(self) -> float | None:
        """Upper estimate of the relative change of kyy by hypotheses left at their defaults; None where there are none."""
        return closed_bound(self.model, self.equilibrium)

    @cached_property
    def uncertainty(self) -> Tables:
        """How far K, kxx, kyy, loads, p0, L10r and preload may be off, and by what: the table ``uncertainty`` of result.json.

        Each is a table of ``value``, ``unit``, ``low``, ``high``, ``relative``, ``parts`` and ``rule``, or None with its reason in ``why``.

        Examples
        --------
        >>> import raceway as rw
        >>> result = rw.run({"bearing": {"preset": "B7206C"}, "load": {"axial": "1 kN"}})
        >>> [result.uncertainty["kyy"][end] > result.stiffness[1, 1] for end in ("low", "high")]
        [False, True]
        """
        return uncertainty_table(self)

    @cached_property
    def at_rest(self) -> AtRest:
        """The table ``equilibrium``."""
        return equilibrium_table(self.model, self.equilibrium)

    @cached_property
    def extremes(self) -> Tables:
        """Mean axial displacement [m], ball loads [N] and pressures [Pa]: of the motion where there is one, else of the equilibrium."""
        loads = self.equilibrium.contact_force
        if self.simulation is not None:
            record = self.simulation.record
            table, loads = motion_table(self.model, record), record.contact_force
        else:
            table = largest_contacts(loads, pressures(self.model, loads), "peak")
        each = {
            f"{name}{suffix}": table[f"{key}{suffix}_{unit}"]
            for name, key, unit in (("peak_ball_load", "peak_ball_load", "n"), ("p0", "peak_pressure", "pa"))
            for suffix in ("", "_inner", "_outer")
        }
        return {
            "axial_displacement": table.get("axial_displacement_m", self.displacement[0]),
            "min_ball_load": loads[..., : self.model.system.ball_count].min(),
            **each,
        }

    @property
    def quantities(self) -> dict[str, float | np.ndarray]:
        """Numbers of plug-ins of quantities by their names, arrays over their dimensions."""
        return self.stated.values

    @property
    def ball_pass(self) -> Tables:
        """``speed_rpm``, and for each row FTF, BPFO, BPFI and BSF over the shaft's speed and in Hz, at the loaded contact angle."""
        return self.stated.tables["ball_pass"]

    @property
    def geometry(self) -> Tables | None:
        """What is inferred of the preset's geometry, and how well that knows the stiffness; None where a source states it."""
        scene = self.model.scene
        tables = scene.source if scene.given is None else scene.given.merged()
        return geometry_of(scene.source["bearing"], tables.get("bearing", {}))

    @property
    def orbit(self) -> tuple[float, float] | None:
        """Major and minor semi-axis of the 1x orbit [m]; None in a static scene.  ``to_xarray().motion`` is the path itself."""
        z = self.identification
        return None if z is None else (z.orbit_major, z.orbit_minor)

    def to_xarray(self) -> xarray.Dataset:
        """Equilibrium, recorded motion, ball loads and identified numbers with coordinates and units.

        Returns
        -------
        xarray.Dataset : whose variables say ``units`` and ``long_name``

        Raises
        ------
        RacewayError
            xarray is missing.
        """
        from raceway.plugins.formats import labelled

        return labelled(self)

    @overload
    def plot(self, what: str, ax: Axes | None = None) -> Axes: ...

    @overload
    def plot(self, what: None = None, ax: None = None) -> tuple[Axes, ...]: ...

    @door
    def plot(self, what: str | None = None, ax: Axes | None = None) -> Axes | tuple[Axes, ...]:
        """Draw the orbit, the spectrum of the displacement, or the ball loads.

        Parameters
        ----------
        what : "orbit", "spectrum" or "ball_loads"; None: all that there is data for, side by side
        ax : axes of matplotlib for one picture, polar ones for the ball loads; None: new ones

        Returns
        -------
        Axes, or a tuple of them where ``what`` is None

        Raises
        ------
        RacewayError
            matplotlib is missing; no such picture, or no data for it.
        """
        from raceway.plugins.formats import plot

        return plot(self, what, ax)

    def _facts(self) -> tuple[str, list[Fact]]:
        return self.title, facts(self)

    def to_dict(self) -> Tables:
        """The content of result.json: plain numbers, lists and tables, None where a number does not exist."""
        return cast(Tables, self.content)

    @property
    def content(self) -> Content:
        """The same by its keys."""
        (model, note), error = self.model_spread, self.error
        notes = {**error["how"], "model": note}
        how, few = ({name: words(note) for name, note in notes.items()} for words in (str, few_words))
        motion = self.simulation
        content: Content = without_nan({
            "schema": SCHEMA,
            "title": self.title,
            "scene": self.model.scene.to_dict(),
            "plan": self.model.plan.to_dict(),
            "geometry": self.geometry,
            "equilibrium": self.at_rest,
            **self.stated.tables,
            "not_computed": self.stated.missing,
            "identification": self._identification(),
            "model": self.bodies,
            "motion": None if motion is None else {**motion_table(self.model, motion.record), "orbits": motion.orbits},
            "uncertainty": self.uncertainty,
            "tolerances": self.tolerances,
            "error": {**error, "model": model, "how": how, "short": few},
            "cost": self.cost,
            "stability": self.stability,
            "environment": self.environment,
            "warnings": list(self.warnings),
        })  # fmt: skip
        return content

    def _identification(self) -> Tables | None:
        z = self.identification
        if z is None:
            return None
        return {
            "definition": z.definition,
            **nested((quantity.path, quantity.of(self)) for quantity in IDENTIFIED)["identification"],
            "damping_origin": damping_origin(self.model.problem),
            "band": self.band,
            "tilt": self.model.problem.supports.tilt,
            "lines": [dict(zip(_LINE, attrs.astuple(line), strict=True)) for line in self.lines],
            "series": [
                {
                    "speed_rpm": speed * 30.0 / math.pi,
                    "real": value.real,
                    "imag": value.imag,
                    "abs": abs(value),
                    "error": error,
                }
                for (speed, value), error in zip_longest(z.series, z.series_error)
            ],
        }

    def _across(self) -> float | None:
        """Error of Z across its own direction, over |Z|: mesh and calibration change the size of a stiffness and turn no phase."""
        total, bodies, z = self.errors.total.size, self.errors.bodies or 0.0, self.dynamic_stiffness
        angle = abs(z.imag) / abs(z) if z else 0.0
        return None if total is None else max(total - bodies, 0.0) + bodies * angle

    def report(self) -> Iterable[Part]:
        """The answer first, then what it rests on; what makes the numbers doubtful before them."""
        from raceway.pipeline.run_screen import report

        return report(self.content)

    def drawings(self) -> dict[str, Figure]:
        """Orbit, spectrum and ball loads, as far as there is data."""
        from raceway.plugins.formats import drawings

        return drawings(self)

    @door
    def save(self, folder: Annotated[str | Path, PATH], pictures: bool | str = False) -> list[Path]:
        """Write result.json, pictures where they are asked for, and the reports; remove what an earlier run that failed left there.

        Raises
        ------
        RacewayError
            A folder that cannot be written; a report that failed.
        """
        folder = Path(folder)
        paths = super().save(folder, pictures)
        for name in ("failure.json", "last-good-state.npz"):
            with suppress(OSError):
                (folder / name).unlink(missing_ok=True)
        failures = list[str]()  # a report that fails stops no other
        for entry, writer in self.reports:
            try:
                with blamed(str(entry), "write()"):
                    paths += cast(list[Path], writer.write(folder, self))
            except PluginError as why:
                failures.append(str(why))
            except RacewayError as why:
                failures.append(f"{entry}: {why}")
        if failures:
            raise PluginError(f"{'; '.join(failures)}. The result is saved: `{folder / 'result.json'}`")
        return paths


def band_table(ends: list[Result]) -> Tables:
    """``identification.band``: numbers of the results at both ends of the band of time constants, [low, high]."""
    identifications = [end.identification for end in ends if end.identification is not None]
    assert len(identifications) == len(ends), "static scenes have no band"
    return {
        "time_constant_s": list(TIME_CONSTANTS),
        **{quantity.name: [quantity.of(end) for end in ends] for quantity in (C, C_ERROR, K)},
        "loss_factor": [z.equivalent_damping * z.speed / z.equivalent_stiffness for z in identifications],
        "phase_lag_deg": [z.phase_lag_deg for z in identifications],
    }


def damping_origin(problem: Problem) -> str:
    """What damps a scene, in words."""
    contact, (low, high) = problem.contact, TIME_CONSTANTS
    if contact.in_a_band:
        origin = f"c = tau k at the contacts, tau from {low:g} to {high:g} s: the band of rolling bearings (Kraemer 1993)"
    elif contact.loss_factor is not None:
        tau = f"tau = {problem.time_constant:.4g} s"
        origin = f"contact.loss_factor {contact.loss_factor:g}: c = tau k at the contacts, {tau}"
    elif contact.time_constant is not None:
        origin = f"contact.time_constant: c = tau k at the contacts, tau = {contact.time_constant:g} s"
    else:
        origin = f"contact.damping: {contact.dashpot:g} N s/m at each contact" if contact.dashpot > 0.0 else ""
    origins = {
        origin: bool(origin),
        f"contact law '{contact.kind}'": contact.law.dissipative,
        "contact.friction": contact.friction > 0.0,
        f"rotor.damping: {problem.rotor.damping:g} N s/m": problem.rotor.damping > 0.0,
    }
    return "; ".join(words for words, damps in origins.items() if damps) or DRY


def facts(result: Result) -> list[Fact]:
    """Name, value with unit, remark of what a result shows in short: K with its error first."""
    count = len(result.warnings)
    warning = [(f"{count} warning{'' if count == 1 else 's'}", "see .warnings", result.warnings[0])] if count else []
    loads, forces = result.ball_loads, result.equilibrium.contact_force
    of_result = {"uncertainty": result.uncertainty, "equilibrium": result.at_rest}
    problem, cost = result.model.problem, result.cost
    kind = f"{problem.bodies.name} bodies, {problem.contact.kind}, {problem.integrator.kind}"
    steps = f"{cost['steps']} steps" if cost["steps"] else "static"
    compilation = f"; compiling, apart and once: {cost['compile_s']:.2g} s" if cost["compile_s"] else ""
    return [
        *_identified_facts(result),
        *warning,
        *(stated(quantity, of_result) for quantity in (KXX, KYY, KYY_TILTS_FOLLOW) if quantity.of(result) is not None),
        X.fact(result),
        ("ball loads", f"{np.min(loads):.5g} to {np.max(loads):.5g} N", f"static, {len(loads)} balls, inner race"),
        *largest_facts(largest_contacts(forces, pressures(result.model, forces), "largest"), "static"),
        ("bearing", str(problem.scene.source["bearing"].get("preset") or "own geometry"), kind),
        ("cost", number(cost["wall_s"], "s", 3), f"{steps}{compilation}"),
    ]


def _identified_facts(result: Result) -> list[Fact]:
    z, band, total = result.identification, result.band, result.errors.total.size
    if z is None:
        return []
    speed = f"{60.0 * z.frequency_hz:g} r/min, {tilt_words(result.model.problem.supports.tilt)}"
    damping = C.fact(result)
    if band is not None:
        remark = "both ends of the band of time constants; other numbers are of the low end"
        damping = C.label, C.span(band[C.name], 3), remark
    orbit = f"{in_micro(z.orbit_major)} x {in_micro(z.orbit_minor)} µm", "semi-axes of the synchronous (1x) component"
    rows = [stated(K, {"uncertainty": result.uncertainty}), damping, Z.fact(result, speed), ("orbit", *orbit)]
    rows = [(name, "not resolved" if result.errors.unresolved else value, remark) for name, value, remark in rows]
    error = "not estimated" if total is None else f"{total:.1e}"
    absolute = "" if total is None else f", of K {K.text(result.equivalent_stiffness_error, 2)}"
    return [*rows, ("error of Z", error, f"numerical, relative{absolute}")]


def chosen_reports(names: Iterable[str], registry: Registry) -> list[Chosen]:
    """The formats of results of these names, each once, before anything is computed.

    PluginError: A name that no format of results has, or two; a format whose options have no defaults.
    """
    reports, names = [], dict.fromkeys(names)
    writing = sorted({each.name for each in registry.of_kind("format") if of_results(each.plugin)}) if names else []
    for name in names:
        if name not in writing:
            why = f"no format of results named '{name}'{nearest(name, writing)}; installed: {', '.join(writing)}"
            raise PluginError(why)
        entry = registry.find("format", name)
        with blamed(str(entry), "making it without options"):
            reports.append((entry, entry.plugin()))
    return reports
