"""By how much the grooves of a running, warm bearing differ from the mounted one's: speed, fits, temperatures.

Temperatures are given numbers: nothing here knows where the heat comes from.
"""

from functools import cache, cached_property, lru_cache
from math import degrees, inf, pi
from types import SimpleNamespace
from typing import Any

import attrs
import numpy as np

from raceway.core.columns import Number, acos, at_row, cos, has_columns, largest, least, length, sin, some, where
from raceway.core.contact.hertz import Ellipse
from raceway.framework.rules import Rule, speaking
from raceway.scene.bearing import Bearing
from raceway.scene.tables import Kinematics, Mounting


def ring_inertia(bearing: Bearing) -> tuple[Number, Number, Number]:
    """Mass [kg], transverse and polar inertia [kg m2] of the inner rings of all rows; zeros when bore or width are not known.

    Of ``bearing.inner_profile``, or of a hollow cylinder from the bore to a land at d_m - D + 2 h (groove depth h); the groove
    is cut out exactly.  Of a bearing with columns they are columns.
    """
    masses, transverses, polars = [], [], []
    for (_, position), row in zip(bearing.rows, bearing.of_rows, strict=True):
        moments = (_moments.__wrapped__ if has_columns(row) else _moments)(row, groove_depth(row))
        if moments is None:
            return 0.0, 0.0, 0.0
        mass, transverse, polar = (row.rings.density * moment for moment in moments)
        masses.append(mass)
        transverses.append(transverse + mass * position**2)
        polars.append(polar)
    return sum(masses), sum(transverses), sum(polars)


@cache
def _moments(b: Bearing, depth: Number) -> tuple[Number, Number, Number] | None:
    """Volume [m3] of one inner ring, transverse and polar inertia over density [m5]; None when bore or width are not known."""
    if b.inner_profile is not None:
        from raceway.core.fem.mesh.part_meshes import ring_shape

        if has_columns(b):
            each = np.array([ring_shape(at_row(b, point), True).moments for point in range(length(b))])
            return each[:, 0], each[:, 1], each[:, 2]
        return ring_shape(b, True).moments
    if b.bore is None or b.width is None:
        return None
    from raceway.core.fem.mesh.ring_section import RingSection

    volume, transverse, polar = RingSection.of(b, depth).moments
    return volume, transverse, polar


#: Sections that are solved at once, of 2 MB each; numbers of a section; error of their growth by interpolation.
_TOGETHER, _SECTION = 32, ("bore", "width", "pitch_diameter", "ball_diameter", "conformity_inner", "contact_angle")
_GROWTH_ERROR = 1e-10


@cache
def _growth(b: Bearing, depth: Number) -> Number:
    """Centrifugal growth [m] for 1 kg/m3 and 1 rad/s; ``b`` is a scene's [bearing], ``depth`` that of its grooves."""
    young, poisson = b.rings.young, b.rings.poisson
    if b.width is None:
        bore, land = 0.5 * (b.bore or 0.0), 0.5 * (b.pitch_diameter - b.ball_diameter) + depth
        return land / (4.0 * young) * ((1.0 - poisson) * land**2 + (3.0 + poisson) * bore**2)
    from raceway.core.fem.mesh.ring_section import RingSection

    if not has_columns(b):
        return RingSection.of(b, depth).growth(young, poisson)
    from raceway.core.columns import interpolated

    numbers: tuple[Number, ...] = (b.bore, b.width, b.pitch_diameter, b.ball_diameter, b.conformity_inner, b.contact_angle)
    points = np.stack(np.broadcast_arrays(*numbers, depth, poisson, np.zeros(length(b))))
    return interpolated(lambda some: _growth_of_sections(some.tobytes(), some.shape[1]), points, _GROWTH_ERROR) / young


@lru_cache(maxsize=16)
def _growth_of_sections(table: bytes, count: int) -> np.ndarray:
    """Growth (m,) for 1 Pa, too, of rings with the numbers (9, m) of their section and Poisson's: bearings stay, loads change."""
    from raceway.core.fem.mesh.ring_section import RingSection

    points, growth = np.frombuffer(table).reshape(-1, count), np.empty(count)
    for k in range(0, len(growth), _TOGETHER):
        *numbers, depth, poisson, _ = points[:, k : k + _TOGETHER]
        section = RingSection.of(SimpleNamespace(**dict(zip(_SECTION, numbers, strict=True))), depth)
        growth[k : k + _TOGETHER] = section.growth(np.float64(1.0), poisson)
    return growth


def groove_depth(bearing: Bearing) -> float:
    """Depth of a bearing's grooves [m]: given, or 0.2 D."""
    return bearing.shoulder_height or 0.2 * bearing.ball_diameter


def groove_edge(bearing: Bearing) -> float:
    """Angle from a groove's bottom to its edge, seen from the ball's centre [rad]."""
    return acos(1.0 - groove_depth(bearing) / (0.5 * bearing.ball_diameter))


def load_at_edge(ellipse: Ellipse, ball_radius: float, angle: float) -> float:
    """Load of a ball [N] at which its contact ellipse reaches the groove's edge.

    ellipse : of the contact, with ``semi_axes(load)`` [m]
    angle : from the contact to the edge, seen from the ball's centre [rad]

    The semi-major axis grows with the cube root of the load; the edge is reached where a = R angle.
    """
    return float((max(ball_radius * angle, 0.0) / float(ellipse.semi_axes(1.0)[0])) ** 3)


@attrs.frozen
class Grooves:
    """Growth of one row's grooves [m]."""

    #: axial, radial : of the vector from the outer to the inner groove centre, at rest
    axial: float
    radial: float
    #: inner, outer : of the distance of groove centre and ball centre at the first touch
    inner: float
    outer: float


def ball_growth(bearing: Bearing, spin_speed: float) -> float:
    """Centrifugal growth of a ball's radius at its equator, where it rolls [m].

    A free elastic sphere of the radius R that turns with w_b grows there by
    rho w_b^2 R^3 / E (2 (1 - 2 nu) / 15 + (1 + nu) (2 + nu) / (3 (7 + 5 nu))): the solution of the equations of elasticity in the
    second spherical harmonic.  A ball that rolls on a standing outer ring at the free contact angle has, with g = D cos(alpha)/d_m,
    w_b = w (d_m / (2 D) (1 - g^2) - (1 - g) / 2) about an axis next to the bearing's.

    Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed., chapter XI (solid sphere under a body force).
    """
    d, dm, ball = bearing.ball_diameter, bearing.pitch_diameter, bearing.balls
    g = d * cos(bearing.contact_angle) / dm
    speed = spin_speed * (0.5 * dm / d * (1.0 - g**2) - 0.5 * (1.0 - g))
    nu = ball.poisson
    shape = 2.0 * (1.0 - 2.0 * nu) / 15.0 + (1.0 + nu) * (2.0 + nu) / (3.0 * (7.0 + 5.0 * nu))
    return shape * ball.density * speed**2 * (0.5 * d) ** 3 / ball.young


@attrs.frozen
class RunningBearing:
    """A bearing as it runs: on its seats, warm, at its spin speed [rad/s]."""

    bearing: Bearing
    mounting: Mounting
    kinematics: Kinematics
    spin_speed: float

    @cached_property
    def grooves(self) -> tuple[Grooves, ...]:
        """Growth of the grooves of each row.

        A ring whose temperature rises by T grows by a T in all lengths: the circles of the groove centres R_i and R_o, the groove
        radii f D; a ball likewise.  Rings and sleeves between them keep rows apart: the planes of the groove centres, at X of the
        inner and X - s A sin(alpha) of the outer one (side s, distance A), move axially by a T_i X and a T_o (X - s A sin(alpha)).
        At one temperature for all, everything keeps its shape.
        """
        return tuple(self._grooves(b, *row) for b, row in zip(self.bearing.of_rows, self.bearing.rows, strict=True))

    def _grooves(self, b: Bearing, side: float, position: float) -> Grooves:
        warm, angle, half = self.mounting, b.contact_angle, 0.5 * b.ball_diameter
        to_inner, to_outer = ((f - 0.5) * b.ball_diameter for f in (b.conformity_inner, b.conformity_outer))
        by_inner = b.rings.strain("bearing.rings", warm.inner_temperature)
        by_outer = b.rings.strain("bearing.rings", warm.outer_temperature)
        ball = b.balls.strain("bearing.balls", warm.ball_temperature) * half
        if self.kinematics.ball_growth:
            ball += ball_growth(b, self.spin_speed)
        circle = 0.5 * b.pitch_diameter + to_inner * cos(angle)
        outer_circle = 0.5 * b.pitch_diameter - to_outer * cos(angle)
        fits = self.inner_fit(b) - self.outer_fit(b)
        return Grooves(
            axial=by_outer * (to_inner + to_outer) * sin(angle) + side * (by_inner - by_outer) * position,
            radial=self.radial_growth(b) + fits + by_inner * circle - by_outer * outer_circle,
            inner=by_inner * (to_inner + half) - ball,
            outer=by_outer * (to_outer + half) - ball,
        )

    def centre_distance(self, row: int) -> tuple[float, float]:
        """Distance of a row's groove centres at which balls touch both races, and its radial part [m]."""
        b, groove = self.bearing.of_rows[row], self.grooves[row]
        distance = (b.conformity_inner + b.conformity_outer - 1.0) * b.ball_diameter
        return distance + groove.inner + groove.outer, distance * cos(b.contact_angle) + groove.radial

    def free_angle(self, row: int) -> float:
        """Free contact angle of a row [rad]; 0 where nothing is left of its clearance."""
        distance, radial = self.centre_distance(row)
        return acos(least(largest(radial / distance, -1.0), 1.0))

    def least_interference(self, seat: str) -> float:
        """Of all rows on shaft or in housing, at speed and temperature, on the diameter [m]."""
        return min(self.interference(b, seat) for b in self.bearing.of_rows)

    def radial_growth(self, b: Bearing) -> float:
        """Radial growth of a row's inner raceway [m]: what the scene gives, and with ``ring_growth`` the centrifugal one.

        Of a free ring of the exact section, at the free contact angle.  Without a width the ring is taken for a plane-stress annulus
        from the bore a to the land b, which grows at b by rho w^2 b / (4 E) ((1 - nu) b^2 + (3 + nu) a^2).  "with_shaft" ring and
        shaft without a fit are one elastic body: the ring is held back by what speed would take from a fit that holds.

        Timoshenko & Goodier, Theory of Elasticity, 3rd ed., section 32.
        """
        growth = self.kinematics.radial_expansion
        if self.kinematics.ring_growth and b.bore is not None and some(self.spin_speed):
            of_speed = _growth.__wrapped__ if has_columns(b) else _growth
            growth = growth + b.rings.density * self.spin_speed**2 * of_speed(b, groove_depth(b))
            if self.kinematics.ring_growth == "with_shaft":
                loose = where(self.interference_at_standstill(b) > 0.0, 0.0, 1.0)
                growth = growth - loose * self._fit_lost(b) * self._by_interference(b, 1.0)
        return growth

    def inner_fit(self, b: Bearing) -> float:
        """Radial growth of the inner raceway by the interference on the shaft [m].

        Thick-walled cylinders of one material: with bore d, raceway d_1 = d_m - D and hole d_s the raceway grows, on the radius, by
        I/2 (d_1 / d) (d^2 - d_s^2) / (d_1^2 - d_s^2); ``_by_interference`` takes two.  The interference
        falls by as much as the ring's bore grows beyond the shaft, by centrifugal growth and by temperature.

        Harris & Kotzalas, Essential Concepts of Bearing Technology, 5th ed., chapter 3 (interference fitting and clearance).
        """
        return self._by_interference(b, self.interference(b))

    def outer_fit(self, b: Bearing) -> float:
        """Radial growth of the outer raceway by the interference in the housing [m], negative: as ``inner_fit``, from outside."""
        return self._by_interference(b, self.interference_at_standstill(b, "housing"), "housing")

    def speed_growth(self) -> tuple[float, float, float]:
        """Radial growth of the inner raceway [m]: by speed, by its fit at standstill, and what speed takes from that fit."""
        b = self.bearing.of_rows[0]
        free = self.radial_growth(b) - self.kinematics.radial_expansion
        fit, each = self.interference_at_standstill(b), self._by_interference(b, 1.0)
        return free, each * fit, each * (fit - self.interference(b))

    def _by_interference(self, b: Bearing, interference: float, seat: str = "shaft") -> float:
        """Radial growth of a raceway by the interference of its ring [m]: Lamé's thick-walled cylinders, each of its own material
        (Timoshenko & Goodier, section 28)."""
        warm, rings, sign = self.mounting, b.rings, 1.0 if seat == "shaft" else -1.0
        d, far = (b.bore, warm.shaft_bore) if seat == "shaft" else (b.outer_diameter, warm.housing_diameter)
        if d is None or not some(interference > 0.0):
            return 0.0
        core, race = getattr(warm, f"{seat}_material") or rings, b.pitch_diameter - sign * b.ball_diameter
        around = 1.0 if far is None else abs((far**2 + d**2) / (far**2 - d**2))
        softness = (abs((race**2 + d**2) / (race**2 - d**2)) + sign * rings.poisson) / rings.young
        softness += (around - sign * core.poisson) / core.young
        return where(interference > 0.0, interference, 0.0) * d * race / (softness * rings.young * (race**2 - d**2))

    def interference_at_standstill(self, b: Bearing, seat: str = "shaft") -> float:
        """Interference of shaft or housing with its ring at their temperature, at standstill, on the diameter [m]."""
        rings, warm, inside = b.rings, self.mounting, seat == "shaft"
        d, kelvin = (b.bore, warm.inner_temperature) if inside else (b.outer_diameter, warm.outer_temperature)
        cold, material = (getattr(warm, f"{seat}_{word}") for word in ("interference", "material"))
        if material is None or d is None:
            return cold
        expands = material.strain(f"mounting.{seat}_material", kelvin) - rings.strain("bearing.rings", kelvin)
        return cold + (expands if inside else -expands) * d

    def interference(self, b: Bearing, seat: str = "shaft") -> float:
        """Interference of shaft or housing with its ring at speed and temperature, on the diameter [m].

        Of plane-stress annuli: the bore a of a ring up to the radius b grows by rho w^2 a / (4 E) ((1 - nu) a^2 + (3 + nu) b^2), a
        shaft with the hole c by the same with its own numbers and c for b.

        Timoshenko & Goodier, Theory of Elasticity, 3rd ed., section 32.
        """
        at_rest = self.interference_at_standstill(b, seat)
        if seat == "housing" or b.bore is None or not self.kinematics.ring_growth:
            return at_rest
        holds = at_rest > 0.0 if self.kinematics.ring_growth == "with_shaft" else True
        return at_rest - where(holds, self._fit_lost(b), 0.0)

    def _fit_lost(self, b: Bearing) -> float:
        """By how much the bore of a free ring grows beyond the shaft at speed, on the diameter [m]."""
        assert b.bore is not None, "required by ring_growth"
        rings, bore, hole = b.rings, 0.5 * b.bore, 0.5 * self.mounting.shaft_bore
        land = 0.5 * (b.pitch_diameter - b.ball_diameter) + groove_depth(b)
        ring, core = (
            body.density / (4.0 * body.young) * ((1.0 - body.poisson) * bore**2 + (3.0 + body.poisson) * far**2)
            for body, far in ((rings, land), (self.mounting.shaft_material or rings, hole))
        )
        return 2.0 * self.spin_speed**2 * bore * (ring - core)


def _widths(b: RunningBearing, dimension: str) -> list[float]:
    """Bores or outer diameters of the rows that have one [m]."""
    return [size for row in b.bearing.of_rows if (size := getattr(row, dimension)) is not None]


#: Fits that lack a dimension or have an impossible one.
_FITS: tuple[Rule[RunningBearing], ...] = (
    *(
        Rule(
            f"mounting.{key}",
            lambda b, key=key, dimension=dimension: getattr(b.mounting, key)  # type: ignore[misc]
            and len(_widths(b, dimension)) < len(b.bearing.rows),
            f"needs the bearing's `{dimension}`",
        )
        for seat, dimension in (("shaft", "bore"), ("housing", "outer_diameter"))
        for key in (f"{seat}_interference", f"{seat}_material")
    ),
    Rule(
        "mounting.shaft_bore", lambda b: b.mounting.shaft_bore >= min(_widths(b, "bore"), default=inf),
        lambda b: f"must be smaller than the bearing's bore, {min(_widths(b, 'bore')):g} m",
    ),
    Rule(
        "mounting.housing_diameter",
        lambda b: (b.mounting.housing_diameter or inf) <= max(_widths(b, "outer_diameter"), default=0.0),
        lambda b: f"must be larger than the bearing's outer diameter, {max(_widths(b, 'outer_diameter')):g} m",
    ),
)  # fmt: skip


def _grown_rows(b: RunningBearing) -> range:
    """Rows whose growth is looked at: what kinematics.radial_expansion does alone shows at the equilibrium."""
    return range(len(b.bearing.rows) if b.mounting.changes and not any(speaking(_FITS, b)) else 0)


def _closed_rows(b: RunningBearing) -> list[int]:
    """Rows that temperatures and fits close."""
    rooms = map(b.centre_distance, _grown_rows(b))
    return [row for row, (distance, radial) in enumerate(rooms) if distance <= max(radial, 0.0)]


def _open_rows(b: RunningBearing) -> list[int]:
    """Rows that they open: balls would touch beyond the grooves."""
    edges = [min(groove_edge(row), 0.5 * pi) for row in b.bearing.of_rows]
    return [row for row in _grown_rows(b) if not _closed_rows(b) and b.free_angle(row) >= edges[row]]


def _cause(b: RunningBearing) -> str:
    """The key that does most to the grooves' room: the temperature furthest from the others, brought to their mean, or a fit."""
    row = (_closed_rows(b) or _open_rows(b))[0]
    warm = {name: value for name, value in attrs.asdict(b.mounting).items() if name.endswith("_temperature")}
    mean = sum(warm.values()) / len(warm)
    furthest = max(warm, key=lambda name: abs(warm[name] - mean))
    mean_of_others = (sum(warm.values()) - warm[furthest]) / (len(warm) - 1)
    without = {furthest: mean_of_others, "shaft_interference": 0.0, "housing_interference": 0.0}

    def room(**differences: Any) -> float:
        mounting = attrs.evolve(b.mounting, **differences)
        groove = attrs.evolve(b, mounting=mounting).grooves[row]
        return groove.inner + groove.outer - groove.radial

    now = room()
    return "mounting." + max(without, key=lambda name: abs(room(**{name: without[name]}) - now))


def _closed_words(b: RunningBearing) -> str:
    distance, radial = b.centre_distance(_closed_rows(b)[0])
    return (
        f"temperatures and fits close the bearing: its grooves leave {1e6 * (radial - max(distance, 0.0)):.3g} µm too little room for "
        "the balls, which would be squeezed all around at a contact angle of 0. Use smaller differences of temperature, a looser fit, or more clearance"
    )


def _opened_words(b: RunningBearing) -> str:
    row = _open_rows(b)[0]
    angle, edge = degrees(b.free_angle(row)), degrees(groove_edge(b.bearing.of_rows[row]))
    return (
        f"temperatures and fits open the bearing: balls would touch at {min(angle, 90.0):.3g} deg, beyond the groove's edge at "
        f"{edge:.3g} deg. Use smaller differences of temperature"
    )


#: Fits, and growth that leaves no bearing.
SIZES: tuple[Rule[RunningBearing], ...] = (
    *_FITS,
    Rule(_cause, _closed_rows, _closed_words),
    Rule(_cause, _open_rows, _opened_words),
)

#: Loss of fit [m] that is reported: the finest standard tolerance of any diameter (ISO 286-1, IT01 up to 3 mm).
_FINEST_TOLERANCE = 0.3e-6


def _loose_words(b: RunningBearing, where: str, seat: str, growth: str) -> str:
    least, fit = b.least_interference(seat), getattr(b.mounting, f"{seat}_interference")
    return (
        f"the {where} {seat} by {-1e6 * least:.3g} µm, on the diameter: it has grown {1e6 * (fit - least):.3g} µm {growth}, by speed "
        f"({30.0 * b.spin_speed / pi:.6g} r/min) and temperature, and `mounting.{seat}_interference` is {1e6 * fit:g} µm. It is "
        "computed as a free ring that stays centred"
    )


#: Rings that their running, warm fits do not hold.
LOOSE: tuple[Rule[RunningBearing], ...] = tuple(
    Rule(
        f"mounting.{words[1]}_interference",
        lambda b, words=words: b.least_interference(words[1]) < -_FINEST_TOLERANCE,  # type: ignore[misc]
        lambda b, words=words: _loose_words(b, *words),  # type: ignore[misc]
    )
    for words in (("inner ring is loose on its", "shaft", "more"), ("outer ring is loose in its", "housing", "less"))
)
