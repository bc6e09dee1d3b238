"""``raceway verify``: reference cases, in the units of their sources, against this program's own numbers.

Two equal spheres that meet count as one of half the mass at the relative speed.  With the approach d, m d'' + k d^1.5 = 0 gives
d_max = (5 m v^2 / (4 k))^(2/5), F_max = k d_max^1.5 and t_c = (4/5) sqrt(pi) Gamma(2/5) / Gamma(9/10) d_max / v.

Chung, Ooi, Granular Matter 13 (2011), benchmark tests 1 and 3; Johnson, Contact Mechanics (1985), section 11.4.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from math import gamma, pi, sqrt
from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np

from raceway import Answer, Mistake, RacewayError, Scene, SceneError, build_model, scene_from_dict
from raceway.extend import (
    Fact, Motion, Part, Registry, Schedule, Tables, Words, contact_modulus, default_registry, ellipse, impact_system,
    integrate, micro, nearest, number, run, solve_equilibrium,
)  # fmt: skip
from raceway_checks.stability.catalogue import transient_integrators
from raceway_checks.verify.reference import BASES, Case, Verified, reference_cases

if TYPE_CHECKING:
    from raceway.extend import Excitation, Integrator, Model, OnProgress

_INCH, _POUND, _PSI = 0.0254, 4.4482216152605, 6894.757293168361

Rows = Iterator[Verified]


def _scene(case: Case, registry: Registry, **tables: Tables) -> Scene:
    return scene_from_dict({"title": case.id, **tables}, registry)


def _number_rows(case: Case, values: dict[str, tuple[str, float]]) -> Rows:
    """What the case states, beside the quantity and number that were computed for its key."""
    for key, reference in case.outputs.items():
        yield case.row(values[key][0], reference, float(values[key][1]), case.rel_tol)


def _masta(case: Case, registry: Registry) -> Rows:
    """Displacements and reference life of a deep-groove bearing with tilts free.

    Frame: the source's radial x is our y, its axial z our x.  Both arms of a tilt are d_m / 2: ``tilt_arm = "pitch"``.
    Both count the axial displacement from the middle of the axial clearance.  The source takes the curvatures at a contact angle of zero, we at the free one: worth 4e-5.
    """
    inputs = case.inputs
    clearance, azimuth = float(inputs["Gr_mm"]) * 1e-3, inputs["first_ball_angle_deg"]
    bearing = {
        "preset": "DGB7-MASTA", "radial_clearance": clearance, "first_ball_azimuth_deg": azimuth, "tilt_arm": "pitch",
        "dynamic_rating": float(inputs["C_N"]),
    }  # fmt: skip
    radial, moment = [float(inputs["Fx_N"]), 0.0], [inputs["Mx_Nmm"] * 1e-3, 0.0]
    load = {"axial": float(inputs["Fz_N"]), "radial": radial, "moment": moment}
    result = run(_scene(case, registry, bearing=bearing, supports={"tilt": "free"}, load=load), registry)
    q = result.equilibrium.displacement
    yield from _number_rows(case, {
        "dr_um": ("radial displacement [um]", 1e6 * float(np.hypot(q[1], q[2]))),
        "da_um": ("axial displacement from mid-clearance [um]", 1e6 * float(q[0])),
        "psi_mrad": ("tilt [mrad]", 1e3 * float(np.hypot(q[3], q[4]))),
        "l10r_million_revolutions": ("reference life [million turns]", float(result.quantities["l10r_million_revolutions"])),
    })  # fmt: skip


def _race_ellipse(case: Case, registry: Registry) -> Rows:
    """Ellipse, approach and pressure of the inner race at a load and contact angle (the loaded one)."""
    bearing = {"preset": "ACB21-HARRIS-MINDEL", "contact_angle_deg": case.inputs["alpha_deg"]}
    inner = build_model(_scene(case, registry, bearing=bearing, load={"axial": 3000.0 * _POUND})).inner
    load = case.inputs["Q_lb"] * _POUND
    a, b = inner.semi_axes(load)
    yield from _number_rows(case, {
        "a_in": ("semi-major axis [in]", float(a) / _INCH), "b_in": ("semi-minor axis [in]", float(b) / _INCH),
        "delta_in": ("approach [in]", float(inner.approach(load)) / _INCH),
        "pmax_psi": ("peak pressure [psi]", float(inner.peak_pressure(load)) / _PSI),
    })  # fmt: skip


def _ellipse_table(case: Case, registry: Registry) -> Rows:
    """a*, b* and delta* for a column of curvature differences: no bearing, so the Hertz functions themselves."""
    for difference, a_star, b_star, delta_star in case.outputs["rows"]:
        contact, where = ellipse(1.0, difference, 1.0), f"at F(rho) = {difference:g}"
        yield case.row(f"a* {where}", a_star, contact.a_star, case.rel_tol)
        yield case.row(f"b* {where}", b_star, contact.b_star, case.rel_tol)
        yield case.row(f"delta* {where}", delta_star, contact.delta_star, case.rel_tol)


def _nsk_pair(case: Case, registry: Registry) -> Rows:
    """Stiffness of a mounted duplex pair, tilts locked: twice the tangent of one row at an axial load equal to the
    preload, as the source's conventions say, and from a scene that is the pair itself."""
    preset = "7206C-NSK" if case.inputs["alpha_deg"] == 15 else "7206A-NSK"
    axial, radial = case.outputs["ka_pair_N_per_um"], case.outputs["kr_pair_N_per_um"]
    for words, factor in (("", 2.0), (" as pair", 1.0)):
        for preload, ka, kr in zip(case.inputs["preload_N"], axial, radial, strict=True):
            # Of the pair: with locked tilts the distance of the rows does not matter.
            pair_keys = {"preset": preset, "arrangement": "DB", "preload": float(preload), "row_distance": 16e-3}
            row: dict[str, Tables] = {"bearing": {"preset": preset}, "load": {"axial": float(preload)}}
            scene = _scene(case, registry, **({"bearing": pair_keys} if words else row))
            stiffness = run(scene, registry).equilibrium.stiffness
            where = f"of the pair at {preload} N{words} [N/um]"
            yield case.row(f"axial stiffness {where}", ka, factor * 1e-6 * float(stiffness[0, 0]), case.rel_tol["ka"])
            yield case.row(f"radial stiffness {where}", kr, factor * 1e-6 * float(stiffness[1, 1]), case.rel_tol["kr"])


def _rig_force(case: Case, registry: Registry) -> Rows:
    """The rig's unbalance force, read off what the excitations' compiled kernels put out over a turn."""
    inputs, out = case.inputs, case.outputs
    moment = inputs["m_g"] * 1e-3 * inputs["e_mm"] * 1e-3
    load: Tables = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}

    def excitation(kind: str, rpm: float, share: float) -> Excitation:
        keys = {"kind": kind, "speed_rpm": float(rpm), "amplitude": "unbalance", "unbalance": moment, "load_share": share}
        return _scene(case, registry, **load, excitation=keys).excitation

    for kind in ("bidirectional", "unidirectional"):
        for rpm, total, half, frequency in zip(inputs["rpm"], out["F0_N"], out["Ftr_N"], out["f_Hz"], strict=True):
            where = f"{kind}, {rpm} r/min"
            rotor, bearing = (excitation(kind, rpm, share) for share in (1.0, 0.5))
            yield case.row(f"force of the rotor, {where} [N]", total, _largest_force(rotor), case.rel_tol)
            yield case.row(f"force on each bearing, {where} [N]", half, _largest_force(bearing), case.rel_tol)
            yield case.row(f"frequency, {where} [Hz]", frequency, bearing.frequency_hz, case.rel_tol)


def _largest_force(excitation: Excitation) -> float:
    """Largest radial force [N] over one turn, sampled at eight instants, the first of which is a crest."""
    kernel, params, out = excitation.kernel(), excitation.parameters(), np.zeros(5)
    largest = 0.0
    for phase in np.arange(8) * pi / 4.0:
        kernel(float(phase / (2.0 * pi * excitation.frequency_hz)), params, out)
        largest = max(largest, float(np.hypot(out[1], out[2])))
    return largest


#: Peak force and contact time of an integrator at this many steps a contact, and how close they have to come: 0.1 %.
_STEPS_PER_CONTACT = 100
_TRANSIENT_TOLERANCE = 1e-3
#: Instants of the first touch within a step; the worst of them counts.
_PHASES = (0.0, 0.25, 0.5, 0.75)
#: d_max / v to the time of contact.
_CONTACT_TIME = 0.8 * sqrt(pi) * gamma(0.4) / gamma(0.9)


@attrs.frozen
class _Impact:
    """One mass against one Hertz contact: mass [kg], relative speed [m/s], factor k [N/m^1.5]."""

    mass: float
    speed: float
    factor: float

    @property
    def largest_approach(self) -> float:
        """d_max [m]."""
        return float((1.25 * self.mass * self.speed**2 / self.factor) ** 0.4)

    @property
    def largest_force(self) -> float:
        """F_max [N]."""
        return float(self.factor * self.largest_approach**1.5)

    @property
    def contact_time(self) -> float:
        """t_c [s]."""
        return _CONTACT_TIME * self.largest_approach / self.speed


def impact_of(inputs: Tables) -> _Impact:
    """The impact that a case describes; its ``type`` says what the sphere meets."""
    radius, speed = inputs["R_m"], inputs["v_each_m_s"]
    mass = inputs["rho_kg_m3"] * 4.0 / 3.0 * pi * radius**3
    young, poisson = inputs["E_Pa"], inputs["nu"]
    if inputs["type"] == "two equal spheres":
        modulus = contact_modulus(young, poisson, young, poisson)
        return _Impact(0.5 * mass, 2.0 * speed, ellipse(4.0 / radius, 0.0, modulus).factor)
    modulus = young / (1.0 - poisson**2)
    return _Impact(mass, speed, ellipse(2.0 / radius, 0.0, modulus).factor)


def _impact_of_spheres(case: Case, registry: Registry) -> Rows:
    """Closed formulas with the factor of ``raceway.core.contact.hertz``, then each integrator."""
    impact, out = impact_of(case.inputs), case.outputs
    yield case.row("peak force, closed form [N]", out["Fmax_N"], impact.largest_force, case.rel_tol)
    yield case.row("largest approach, closed form [m]", out["dmax_m"], impact.largest_approach, case.rel_tol)
    yield case.row("contact time, closed form [s]", out["tc_s"], impact.contact_time, case.rel_tol)
    for entry in transient_integrators(registry):
        note, force, time = "", None, None
        try:
            # What lies farthest off, over touches at several instants within a step.
            touches = [peak_and_duration(entry.plugin(), impact, _STEPS_PER_CONTACT, phase) for phase in _PHASES]
            force = max((touch[0] for touch in touches), key=lambda f: abs(f - impact.largest_force))
            time = max((touch[1] for touch in touches), key=lambda t: abs(t - impact.contact_time))
        except Exception as why:  # a third party's own code: it is reported by name
            note = f"integrator '{entry.name}' of {entry.distribution} fails: {type(why).__name__}: {why}"
        yield case.row(f"peak force, {entry.name} [N]", out["Fmax_N"], force, _TRANSIENT_TOLERANCE, note)
        yield case.row(f"contact time, {entry.name} [s]", out["tc_s"], time, _TRANSIENT_TOLERANCE, note)


def peak_and_duration(method: Integrator, impact: _Impact, steps: int, phase: float) -> tuple[float, float]:
    """Peak force [N] and contact time [s] of one impact at ``steps`` steps a contact.

    phase : where within a step the first touch falls, in [0, 1)

    The peak is the largest sample, not interpolated.  Times of touch and release are interpolated linearly: the mass
    flies freely before the touch, and near the release its acceleration vanishes.
    """
    from raceway.extend import three_halves

    system = impact_system(impact.mass, three_halves, np.array([impact.factor]))
    dt, x = impact.contact_time / steps, np.eye(5)[0]
    lead = 2.0 + phase
    start = Motion(-lead * dt * impact.speed * x, impact.speed * x, np.zeros(5), np.zeros((1, 2)), np.zeros((1, 2)))
    record = integrate(method, system, start, Schedule(dt, steps + steps // 10 + 4, 1))
    t, x = record.time, record.displacement[:, 0]
    inside = np.flatnonzero(x > 0.0)
    if len(inside) == 0 or inside[0] == 0 or inside[-1] == len(x) - 1:
        raise ValueError(f"the mass does not touch and leave within {record.schedule.steps} steps")
    touch, release = (float(t[i] - x[i] * (t[i + 1] - t[i]) / (x[i + 1] - x[i])) for i in (inside[0] - 1, inside[-1]))
    return float(record.contact_force.max()), release - touch


def _article_pressures(case: Case, registry: Registry) -> Rows:
    """Largest nodal pressure of each race in each load case, and what fewer points would have given.

    The reference is computed, too: exact Hertz at the ball loads of rigid rings, as the article's program does.  The table of
    the article is lost; its text gives the largest deviation, which is the tolerance, and that of the heaviest case.
    """
    inputs, tolerance = case.inputs, case.rel_tol

    def model(axial: float, radial: float, points: int = 0) -> Model:
        """B7206C with rigid bodies and Hertz, or with so many surface points along each semi-axis."""
        nodal: dict[str, Tables] = {
            "bodies": {"kind": "condensed"}, "contact": {"kind": "unilateral", "discretisation": "nodal"},
            "mesh": {"kind": "structured", "nodes_per_semi_axis": points, "element_size": 0.8e-3},
        }  # fmt: skip
        load = {"axial": float(axial), "radial": [float(radial), 0.0]}
        return build_model(_scene(case, registry, bearing={"preset": "B7206C"}, load=load, **(nodal if points else {})))

    for axial, radial in inputs["loads_n"]:
        where = f"{axial:g} N axial" + (f", {radial:g} N radial" if radial else "")
        hertz, nodal_pressures = model(axial, radial), _nodal(model(axial, radial, int(inputs["points"])))
        force, z = solve_equilibrium(hertz).contact_force, hertz.system.ball_count
        for race, load in (("inner", force[:z].max()), ("outer", force[z:].max())):
            quantity, reference = f"peak pressure, {race} race, {where} [MPa]", getattr(hertz, race).peak_pressure(load)
            yield case.row(quantity, 1e-6 * float(reference), nodal_pressures[race], tolerance["pressure"])
    axial, radial = inputs["loads_n"][int(inputs["heaviest"])]
    most, fewer = inputs["independence_points"]
    fine, coarse = (_nodal(model(axial, radial, int(n))) for n in (most, fewer))
    for race in ("inner", "outer"):
        quantity = f"mesh independence: {race} race, {axial:g} N axial, {fewer} points per semi-axis against {most} [MPa]"
        yield case.row(quantity, fine[race], coarse[race], tolerance["mesh"])


def _nodal(model: Model) -> dict[str, float]:
    """Largest pressure at a surface point of each race [MPa]."""
    columns = model.bearing.ball_columns(model, solve_equilibrium(model))
    return {race: 1e-6 * float(np.max(columns[f"peak_pressure_nodal_{race}_pa"])) for race in ("inner", "outer")}


#: How each case is computed.
COMPUTED: dict[str, Callable[[Case, Registry], Rows]] = {
    "masta-dgbb-1": _masta, "masta-dgbb-3": _masta, "masta-dgbb-5": _masta,
    "harris-mindel-1973-hertz-inner": _race_ellipse, "harris-table-6.1": _ellipse_table,
    "nsk-7206C-stiffness": _nsk_pair, "nsk-7206A-stiffness": _nsk_pair,
    "chung-ooi-1-glass": _impact_of_spheres, "chung-ooi-3-alumina": _impact_of_spheres,
    "seed-unbalance": _rig_force, "seed-static-pressures": _article_pressures,
}  # fmt: skip

#: Columns of numbers and their significant digits.
_DIGITS = {"reference": 5, "computed": 5, "error": 2, "tolerance": 2}
#: Cases of which every number is shown: the pressures of the article, load by load, with their mesh independence.
_IN_FULL = ("seed-static-pressures",)


@attrs.frozen(eq=False, repr=False, slots=False)
class Verification(Answer):
    """The rows of all cases that were computed; ``every``: whether a screen shows all of them."""

    stem: ClassVar[str] = "verify"

    rows: tuple[Verified, ...]
    every: bool = False

    @property
    def passed(self) -> bool:
        """Whether every row keeps its tolerance (and there is at least one)."""
        return bool(self.rows) and all(row.ok for row in self.rows)

    @property
    def kept(self) -> dict[str, dict[str, int]]:
        """By basis how many numbers are within their tolerance, of how many."""
        rows = {basis: [row.ok for row in self.rows if row.basis == basis] for basis in BASES}
        return {basis: {"within": sum(ok), "of": len(ok)} for basis, ok in rows.items() if ok}

    @property
    def worst(self) -> tuple[Verified, ...]:
        """Of each case the row that comes closest to its tolerance, or misses it by most."""
        cases = dict.fromkeys(row.case for row in self.rows)
        strain = [float("inf") if r.error is None or not r.tolerance else r.error / r.tolerance for r in self.rows]
        rows = sorted(zip(strain, self.rows, strict=True), key=lambda pair: -pair[0])
        return tuple(next(row for _, row in rows if row.case == case) for case in cases)

    def to_dict(self) -> Tables:
        return {"passed": self.passed, "kept": self.kept, "rows": [attrs.asdict(row) for row in self.rows]}

    def _counts(self) -> list[str]:
        return [f"{count['within']} of {count['of']} {BASES[basis]}" for basis, count in self.kept.items()]

    def _facts(self) -> tuple[str, list[Fact]]:
        misses: list[Fact] = [("off", row.case, f"{row.quantity} {row.note}") for row in self.rows if not row.ok]
        return "Reference cases", [("within their tolerance", "", words) for words in self._counts()] + misses

    def report(self) -> Iterator[Part]:
        """Of each case the worst number and all that are off, or ``every`` one."""
        worst = self.worst
        rows = [row for row in self.rows if self.every or not row.ok or row.case in _IN_FULL or row in worst]
        yield [
            {
                "number": f"{row.case}: {micro(row.quantity)}",
                **{name: number(getattr(row, name), "", digits) for name, digits in _DIGITS.items()},
                "verdict": "ok" if row.ok else f"off {row.note}",
            }
            for row in rows
        ]
        yield Words(f"within their tolerance: {', '.join(self._counts())}", "green" if self.passed else "red")


def verify(
    only: str | Iterable[str] = (),
    every: bool = False,
    *,
    registry: Registry | None = None,
    progress: OnProgress | None = None,
) -> Verification:
    """Compute the reference cases; exit code 1 when a number misses its tolerance.

    Published numbers, closed forms and internal comparisons are counted separately.

    Parameters
    ----------
    only : this case only
    every : show every number, not only the worst of each case
    registry : whose integrators the impacts are run with
    progress : called as ``progress(case, done, total)`` before each case and once at the end

    Raises
    ------
    SceneError
        A case that does not exist (with the nearest name) or that is there for information only.
    """
    registry = registry or default_registry()
    cases = reference_cases()
    checkable = {name: case for name, case in cases.items() if case.checked}
    names = ([only] if isinstance(only, str) else list(only)) or list(checkable)
    faults = []
    for name in names:
        if name not in checkable:
            why = f"no such case{nearest(str(name), checkable)}; known"
            why = f"is not computed: {cases[name].role}; computed are" if name in cases else why
            faults.append(Mistake("only", name, f"{why}: {', '.join(checkable)}"))
    if faults:
        raise SceneError(faults)
    selection = [case for name, case in checkable.items() if name in names]
    rows, report = list[Verified](), progress or (lambda *_: None)
    for count, case in enumerate(selection):
        report(case.id, count, len(selection))
        rows += compute(case, registry)
    report("", len(selection), len(selection))
    return Verification(tuple(rows), every)


def compute(case: Case, registry: Registry) -> list[Verified]:
    """The rows of one case; a solver that fails makes a row that says why."""
    rows: list[Verified] = []
    try:
        rows.extend(COMPUTED[case.id](case, registry))
    except RacewayError as why:
        rows.append(case.row("the rest of the case", None, None, None, str(why)))
    return rows
