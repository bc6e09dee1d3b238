"""Every number that the product states, declared once: its names, unit, definition, and where a result has it.

Data sets, CSV heads, axes of pictures, screens and JSON look here; nothing else holds the unit or the words of a quantity.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import attrs

from raceway.errors import PluginError
from raceway.framework.loading.registry import Registry, default_registry
from raceway.framework.shown import Fact, number, number_within

#: Units that people read, with their factors.
_READ = {"N/m": (1e-6, "N/µm"), "m": (1e6, "µm"), "Pa": (1e-6, "MPa")}


def read_in(value: float, unit: str) -> tuple[float, str]:
    """A stiffness, a length or a pressure of a bearing in the unit that people read it in, and that unit; other numbers as they are."""
    factor, word = _READ.get(unit, (1.0, unit))
    return factor * value, word


def _at(source: object, path: str) -> Any:
    """What lies there, steps with dots between; of several paths at the first that leads anywhere, else None."""
    first, _, alternatives = path.partition(" | ")
    value: Any = source
    for step in first.split("."):
        if isinstance(value, Mapping):
            value = value.get(step)
        elif value is not None:
            value = value[int(step)] if step.isdigit() else getattr(value, step)
    return _at(source, alternatives) if value is None and alternatives else value


@attrs.frozen
class Quantity:
    """A number, or an array, that results state.

    Attributes
    ----------
    name : of variables, columns and attributes;  unit : SI, "1" of ratios, of arrays that of each kind of entry;  words : definition
    path : its place in result.json, keys with dots between; of several, with " | " between, the first that a result has
    attribute : of a ``Result`` that leads to it, in the same form
    symbol : its name in formulas, in fits and among quantities over tolerances;  label : its name on screens
    error : the quantity that is its absolute error;  dims : dimensions of an array

    Examples
    --------
    >>> import raceway as rw
    >>> ratio = rw.Quantity("stress_ratio", "1", "largest pressure over its limit", "stress.ratio")
    >>> ratio.of({"stress": {"ratio": 0.7}})
    0.7
    """

    name: str
    unit: str
    words: str
    path: str = ""
    attribute: str = attrs.Factory(lambda self: self.name, takes_self=True)
    symbol: str = attrs.field(default=attrs.Factory(lambda self: self.name, takes_self=True), kw_only=True)
    label: str = attrs.field(default=attrs.Factory(lambda self: self.name.replace("_", " "), takes_self=True), kw_only=True)
    error: "Quantity | None" = attrs.field(default=None, kw_only=True)
    dims: tuple[str, ...] = attrs.field(default=(), kw_only=True)

    def of(self, source: object) -> Any:
        """Of a ``Result``, or of the content of its result.json; None where that has none.  Complex ones by their size."""
        value = _at(source, self.path if isinstance(source, Mapping) else self.attribute)
        return abs(value) if isinstance(value, complex) else value

    @property
    def labels(self) -> dict[str, str]:
        """Attributes of a labelled array: xarray writes the short ``long_name`` and the unit beside an axis."""
        return {"units": self.unit, "long_name": self.name.replace("_", " "), "description": self.words}

    def read(self, value: float) -> float:
        """In the unit that people read it in."""
        return read_in(value, self.unit)[0]

    @property
    def read_unit(self) -> str:
        """That unit."""
        return read_in(1.0, self.unit)[1]

    @property
    def axis(self) -> str:
        """Label of an axis: symbol and that unit."""
        return f"{self.symbol} [{self.read_unit}]"

    def text(self, value: float | None, digits: int = 5) -> str:
        """With that unit; a dash for what is not there."""
        return "-" if value is None else number(self.read(value), self.read_unit, digits)

    def span(self, ends: Sequence[float], digits: int = 5) -> str:
        """From the first to the last, with that unit."""
        return f"{self.read(ends[0]):.{digits}g} to {self.text(ends[-1], digits)}"

    def fact(self, source: object, remark: str | None = None) -> Fact:
        """Label, number down to its error with that unit, and its definition or another remark."""
        value, remark = self.of(source), self.words if remark is None else remark
        if self.error is None:
            return self.label, self.text(value), remark
        error = self.error.of(source)
        if error is None:
            return self.label, self.text(value), f"error not estimated; {remark}"
        if abs(value) < error:
            return self.label, "not resolved", f"below its error of {self.text(error, 2)}; {remark}"
        text = number_within(self.read(value), self.read(error), self.read_unit)
        return self.label, text, f"+- {self.text(error, 2)}; {remark}"


def named(*quantities: Quantity) -> dict[str, Quantity]:
    """Quantities by their names."""
    return {quantity.name: quantity for quantity in quantities}


def entry_unit(unit: str, entry: Sequence[str]) -> str:
    """The unit of one entry of an array over coordinates of the ring, such as ("y", "tilt_z"); any other unit as it is."""
    index = 0
    for coordinate in entry:
        index = 2 * index + coordinate.startswith("tilt")
    return unit.split(", ")[index] if ", " in unit else unit


#: One line per quantity: name, unit, words, path, attribute.
# fmt: off
# Of the 1x line.
_ID = "identification"
SPEED = Quantity("speed_rpm", "r/min", "speed of the excitation", f"{_ID}.speed_rpm")
FREQUENCY = Quantity("frequency", "Hz", "of the synchronous (1x) component", f"{_ID}.frequency_hz", f"{_ID}.frequency_hz")
FORCE_AMPLITUDE = Quantity("force_amplitude", "N", "amplitude of the 1x force", f"{_ID}.force_amplitude_n", f"{_ID}.force_amplitude", label="force")
_Z = f"{_ID}.dynamic_stiffness"
Z = Quantity("dynamic_stiffness", "N/m", "size of Z = F/x", f"{_Z}.abs", symbol="|Z|", label="|Z|")
Z_REAL = Quantity("z_real", "N/m", "real part of the dynamic stiffness Z = F/x", f"{_Z}.real", f"{_Z}.real", label="Z real")
_Z_IMAG_ERROR = Quantity("dynamic_stiffness_imag_error", "N/m", "estimated error of Im Z", f"{_Z}_imag_error")
Z_IMAG = Quantity("z_imag", "N/m", "imaginary part of the dynamic stiffness Z = F/x, w C", f"{_Z}.imag", f"{_Z}.imag", label="Z imaginary", error=_Z_IMAG_ERROR)
K_ERROR = Quantity("equivalent_stiffness_error", "N/m", "estimated error of K", f"{_ID}.equivalent_stiffness_error")
K = Quantity("equivalent_stiffness", "N/m", "K = Re Z + m w^2", f"{_ID}.equivalent_stiffness", symbol="K", label="equivalent stiffness K", error=K_ERROR)
C_ERROR = Quantity("equivalent_damping_error", "N s/m", "estimated error of C", f"{_ID}.equivalent_damping_error")
C = Quantity("equivalent_damping", "N s/m", "C = Im Z / w", f"{_ID}.equivalent_damping", symbol="C", label="equivalent damping C", error=C_ERROR)
MASS = Quantity("mass", "kg", "m of K = Re Z + m w^2", f"{_ID}.mass_used_kg", f"{_ID}.mass_used")
_PHASE_LAG_ERROR = Quantity("phase_lag_error_deg", "deg", "estimated error of the phase lag", f"{_ID}.phase_lag_error_deg")
PHASE_LAG = Quantity("phase_lag", "deg", "displacement behind force", f"{_ID}.phase_lag_deg", f"{_ID}.phase_lag_deg", error=_PHASE_LAG_ERROR)
_FORWARD = Quantity("forward_amplitude", "m", "forward part of the 1x orbit", f"{_ID}.forward_amplitude_m", f"{_ID}.forward_amplitude")
_BACKWARD = Quantity("backward_amplitude", "m", "backward part of the 1x orbit", f"{_ID}.backward_amplitude_m", f"{_ID}.backward_amplitude")
ORBIT_MAJOR = Quantity("orbit_major", "m", "major semi-axis of the 1x orbit", f"{_ID}.orbit.major_m", f"{_ID}.orbit_major")
ORBIT_MINOR = Quantity("orbit_minor", "m", "minor semi-axis of the 1x orbit", f"{_ID}.orbit.minor_m", f"{_ID}.orbit_minor")
RESIDUAL = Quantity("residual", "1", "motion other than 1x, rms over rms of 1x", f"{_ID}.residual", f"{_ID}.residual")
_SPREAD = Quantity("spread", "1", "largest deviation of Z of a turn from that of all turns", f"{_ID}.spread", f"{_ID}.spread")
AMPLITUDE = Quantity("amplitude", "m", "of the 1x motion along the force", attribute=ORBIT_MAJOR.attribute)
# At rest, under the constant loads.
KXX = Quantity("kxx", "N/m", "axial, other motions held", "equilibrium.stiffness.0.0", "stiffness.0.0", label="tangent kxx")
KYY = Quantity("kyy", "N/m", "radial, tilts and other motions held", "equilibrium.stiffness.1.1", "stiffness.1.1", label="tangent kyy")
KYY_TILTS_FOLLOW = Quantity("kyy_tilts_follow", "N/m", "radial tangent with tilts as in supports.tilt, x and z held", "equilibrium.kyy_tilts_follow_n_per_m")
X = Quantity("x", "m", "axial displacement under the constant loads", "equilibrium.displacement.x", "displacement.0", label="displacement x")
LARGEST_BALL_LOAD = Quantity("largest_ball_load", "N", "largest static load of a ball, of both races", "equilibrium.largest_ball_load_n")
# Of the motion where there is one, else of the equilibrium.
AXIAL_DISPLACEMENT = Quantity("axial_displacement", "m", "mean axial displacement", f"motion.axial_displacement_m | {X.path}", "extremes.axial_displacement")
PEAK_BALL_LOAD = Quantity("peak_ball_load", "N", "largest load of a ball, of both races", f"motion.peak_ball_load_n | {LARGEST_BALL_LOAD.path}", "extremes.peak_ball_load")
_PEAK_INNER = Quantity("peak_ball_load_inner", "N", "largest load of a ball on the inner race", attribute="extremes.peak_ball_load_inner")
_PEAK_OUTER = Quantity("peak_ball_load_outer", "N", "largest load of a ball on the outer race", attribute="extremes.peak_ball_load_outer")
_LEAST_LOAD = Quantity("min_ball_load", "N", "least load of a ball on the inner race, 0 where one is unloaded", attribute="extremes.min_ball_load")
P0 = Quantity("p0", "Pa", "largest Hertz pressure, of both races", "motion.peak_pressure_pa | equilibrium.largest_pressure_pa", "extremes.p0")
_P0_INNER = Quantity("p0_inner", "Pa", "largest Hertz pressure on the inner race", attribute="extremes.p0_inner")
_P0_OUTER = Quantity("p0_outer", "Pa", "largest Hertz pressure on the outer race", attribute="extremes.p0_outer")
L10R = Quantity("l10r_million_revolutions", "1e6", "reference life, reached by 90 %", "life.l10r_million_revolutions", "quantities.l10r_million_revolutions", symbol="L10r", label="reference life L10r")
PRELOAD = Quantity("running_preload", "N", "preload of a set as it runs, without loads", "equilibrium.preload.running_n", "at_rest.preload.running_n", symbol="preload")
#: What has an ``uncertainty``, stiffnesses first.
STIFFNESSES = (K, KXX, KYY, KYY_TILTS_FOLLOW)
HEADLINE = (*STIFFNESSES, PEAK_BALL_LOAD, P0, L10R, PRELOAD)
#: Ends of the intervals of stiffnesses, columns of a sweep on request.
ENDS = named(*(
    Quantity(f"{one.symbol}_{end}", "N/m", f"{end} end of the interval of {one.symbol}", *2 * (f"uncertainty.{one.name}.{end}",))
    for one in (K, KYY) for end in ("low", "high")
))
# Relative errors of Z, and of kyy.
ERROR = Quantity("error_total", "1", "estimated relative error of Z", "error.total", "error.total")
_PARTS = {"time_step": "time step", "transient": "transient", "mesh": "mesh", "contact": "contact law", "identification": "identification"}
_ERRORS = [Quantity(f"error_{part}", "1", f"part of the {words} in the relative error of Z", f"error.{part}", f"error.{part}") for part, words in _PARTS.items()]
ERROR_BODIES = Quantity("error_bodies", "1", "sum of the parts of mesh and contact law", "error.bodies", "error.bodies")
MODEL_BOUND = Quantity("error_model_bound", "1", "upper estimate of the change of kyy by hypotheses of [kinematics] left at their defaults", "error.model.bound", "model_bound")
# Arrays: over coordinates of the ring, races and balls, times.
DISPLACEMENT = Quantity("displacement", "m, rad", "equilibrium under the constant loads", dims=("dof",))
STIFFNESS = Quantity("stiffness", "N/m, N/rad, N m/m, N m/rad", "tangent of the contacts at the equilibrium: kyy is y, y, tilts held", dims=("dof", "dof2"))
_DAMPING = Quantity("damping", "N s/m, N s/rad, N m s/m, N m s/rad", "damping of the contacts at the equilibrium", dims=("dof", "dof2"))
BALL_LOAD = Quantity("ball_load", "N", "static contact force", dims=("race", "ball"))
CONTACT_ANGLE = Quantity("contact_angle", "deg", "static; nan where the contact is open", dims=("race", "ball"))
MOTION = Quantity("motion", "m, rad", "of the inner ring", dims=("time", "dof"))
FORCE = Quantity("force", "N, N m", "of the excitation", dims=("time", "dof"))
CONTACT_FORCE = Quantity("contact_force", "N", "of each ball on each race", dims=("time", "race", "ball"))
AZIMUTH = Quantity("azimuth", "deg", "from +y towards +z", dims=("ball",))
TIME = Quantity("time", "s", "in the evaluated turns", dims=("time",))
#: Of a setting whose error is measured against its time.
PRECISION = (
    Quantity("value", "N/m", "size of Z, or of the tangent where nothing is identified"),
    Quantity("error", "1", "relative error against the reference of the row's model"),
    Quantity("own_error", "1", "relative error estimated by the run"),
    Quantity("time_s", "s", "of the fastest repeat, compiling apart"),
)
#: What result.json states of the identification, in its order.
IDENTIFIED = (
    SPEED, FREQUENCY, FORCE_AMPLITUDE, Z_REAL, Z_IMAG, Z, _Z_IMAG_ERROR, K, K_ERROR, C, C_ERROR, MASS, PHASE_LAG, _PHASE_LAG_ERROR,
    _FORWARD, _BACKWARD, ORBIT_MAJOR, ORBIT_MINOR, RESIDUAL, _SPREAD,
)
#: Columns of a sweep, numbers before arrays.
COLUMNS = named(
    Z_REAL, Z_IMAG, K, C, FORCE_AMPLITUDE, FREQUENCY, MASS, _FORWARD, _BACKWARD, ORBIT_MAJOR, ORBIT_MINOR, RESIDUAL,
    AXIAL_DISPLACEMENT, KYY_TILTS_FOLLOW, PEAK_BALL_LOAD, _PEAK_INNER, _PEAK_OUTER, _LEAST_LOAD, P0, _P0_INNER, _P0_OUTER,
    ERROR, *_ERRORS, MODEL_BOUND, DISPLACEMENT, STIFFNESS, _DAMPING,
)
# fmt: on
#: Numbers that have derivatives by the keys of a scene, by their symbols; what a scene does not have is left out.
DIFFERENTIABLE = {number.symbol: number for number in (K, C, AMPLITUDE, KXX, KYY, KYY_TILTS_FOLLOW, X, LARGEST_BALL_LOAD)}
#: All that a function or a sweep states, by names.
KNOWN = COLUMNS | named(*IDENTIFIED, *DIFFERENTIABLE.values(), BALL_LOAD, CONTACT_ANGLE)

#: What only the loop over steady orbits states: the largest Floquet multiplier, and the change of stiffness along an orbit.
OF_ORBITS = ("largest_multiplier", "stiffness_change")


def plugin_quantities(registry: Registry) -> dict[str, tuple[str, Quantity]]:
    """Name -> plug-in and quantity of every number that plug-ins of quantities state.

    PluginError: A name that is another quantity's.
    """
    numbers: dict[str, tuple[str, Quantity]] = {}
    for entry in registry.of_kind("quantity"):
        for quantity in entry.plugin.numbers:
            if quantity.name in numbers or quantity.name in KNOWN or quantity.name in OF_ORBITS:
                raise PluginError(f"{entry}: its number '{quantity.name}' has the name of another quantity: rename it")
            numbers[quantity.name] = entry.name, quantity
    return numbers


def quantity_of(symbol: str) -> Quantity:
    """That of results which has derivatives, by its symbol, or a plug-in's by its name."""
    return DIFFERENTIABLE.get(symbol) or plugin_quantities(default_registry())[symbol][1]


#: Damping over stiffness by the rule of thumb of rotor programs [s]: ROSS 2.3 takes c = 1.25e-5 s k for a ball bearing without a
#: given damping (``ross.BallBearingElement``), the middle of its "typical range" of 0.25e-5 to 2.5e-5 s.
RULE_OF_THUMB_S = 1.25e-5

#: Part of the rule's damping below which a damping is next to nothing: a twentieth of the lower end of the typical range.
_NOTHING = 1e-2

#: Of scenes without any damping.
DRY = "dry: no damping is modelled"

#: What to do in the scene.
_REMEDY = "set contact.damping or contact.time_constant"


def dry_damping_note(content: Mapping[str, object]) -> str | None:
    """The sentence for one run (result.json); None where nothing is identified, or where C is not far below the rule of thumb."""
    if content["identification"] is None:
        return None
    error, damping = C_ERROR.of(content), C.of(content)
    above_error = error is None or abs(damping) > error
    return dry_damping_words(damping if above_error else None, K.of(content))


def dry_damping_words(damping: float | None, stiffness: float, remedy: str = _REMEDY) -> str | None:
    """The sentence for C [N s/m], None where it is not resolved, and K [N/m]; None where C is not far below the rule of thumb."""
    rule = RULE_OF_THUMB_S * abs(stiffness)
    if damping is not None and abs(damping) > _NOTHING * rule:
        return None
    state = "is not resolved" if damping is None else "is 0" if damping == 0.0 else f"is {damping:.2g} N s/m"
    return f"C {state}, nearly dry; the rule of thumb of rotor programs, 1.25e-5 s K, gives {rule:.2g} N s/m: {remedy}"
