"""By how much the grooves of a running, warm bearing differ from the mounted one's: speed, fits, temperatures.

Temperatures are given numbers: nothing here knows where the heat comes from.
"""

from __future__ import annotations

from functools import cache
from math import acos, cos, degrees, pi, sin
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.errors import Mistake, SceneError
from raceway.scene.scene import Scene

if TYPE_CHECKING:
    from raceway.core.contact.hertz import Ellipse
    from raceway.scene.bearing import Bearing


def ring_inertia(scene: Scene) -> tuple[float, float, float]:
    """Mass [kg], transverse and polar inertia [kg m2] of the inner rings of all rows; zeros when bore or width are not known.

    Notes
    -----
    Of ``bearing.inner_profile``, or of a hollow cylinder from the bore to a land at d_m - D + 2 h (groove depth h); the groove
    is cut out exactly.
    """
    total = np.zeros(3)
    for (_, position), bearing in zip(scene.bearing.rows, scene.bearing.of_rows, strict=True):
        moments = _moments(bearing, groove_depth(bearing))
        if moments is None:
            return 0.0, 0.0, 0.0
        mass, transverse, polar = (bearing.rings.density * moment for moment in moments)
        total += mass, transverse + mass * position**2, polar
    return float(total[0]), float(total[1]), float(total[2])


@cache
def _moments(b: Bearing, depth: float) -> tuple[float, float, float] | None:
    """Volume [m3] of one inner ring, transverse and polar inertia over density [m5]; None when bore or width are not known."""
    if b.inner_profile is not None:
        from raceway.core.mesh.ring_mesh import ring_shape

        return ring_shape(b, True).moments
    if b.bore is None or b.width is None:
        return None
    from raceway.core.mesh.ring_mesh import RingSection

    return RingSection.of(b, depth).moments


def radial_growth(scene: Scene, row: int = 0) -> float:
    """Radial growth of a row's inner raceway [m]: what the scene gives, and with ``ring_growth`` the centrifugal one.

    Notes
    -----
    Of a free ring of the exact section, at the free contact angle.  Without a width the ring is taken for a plane-stress annulus
    from the bore a to the land b, which grows at b by rho w^2 b / (4 E) ((1 - nu) b^2 + (3 + nu) a^2).

    References
    ----------
    Timoshenko & Goodier, Theory of Elasticity, 3rd ed., section 32.
    """
    growth = scene.kinematics.radial_expansion
    b = scene.bearing.of_rows[row]
    if scene.kinematics.ring_growth and b.bore is not None and scene.spin_speed != 0.0:
        growth += b.rings.density * scene.spin_speed**2 * _growth(b, groove_depth(b))
    return growth


@cache
def _growth(b: Bearing, depth: float) -> float:
    """Centrifugal growth [m] for 1 kg/m3 and 1 rad/s; ``b`` is a scene's [bearing], ``depth`` that of its grooves."""
    young, poisson = b.rings.young, b.rings.poisson
    if b.width is not None:
        from raceway.core.mesh.ring_mesh import RingSection

        return RingSection.of(b, depth).growth(young, poisson)
    bore, land = 0.5 * (b.bore or 0.0), 0.5 * (b.pitch_diameter - b.ball_diameter) + depth
    return float(land / (4.0 * young) * ((1.0 - poisson) * land**2 + (3.0 + poisson) * bore**2))


def shoulder_height(scene: Scene) -> float:
    """Depth of the grooves [m]: given, or 0.2 D."""
    return groove_depth(scene.bearing)


def groove_depth(bearing: Bearing) -> float:
    """Depth of a bearing's grooves [m]: given, or 0.2 D."""
    return bearing.shoulder_height or 0.2 * bearing.ball_diameter


def load_at_edge(ellipse: Ellipse, ball_radius: float, angle: float) -> float:
    """Load of a ball [N] at which its contact ellipse reaches the groove's edge.

    Parameters
    ----------
    ellipse : of the contact, with ``semi_axes(load)`` [m]
    angle : from the contact to the edge, seen from the ball's centre [rad]

    Notes
    -----
    The semi-major axis grows with the cube root of the load; the edge is reached where a = R angle.
    """
    return float((max(ball_radius * angle, 0.0) / float(ellipse.semi_axes(1.0)[0])) ** 3)


#: Loss of fit [m] that is reported: the finest standard tolerance of any diameter (ISO 286-1, IT01 up to 3 mm).
_FINEST_TOLERANCE = 0.3e-6


@attrs.frozen
class Grooves:
    """Growth of one row's grooves [m].

    Attributes
    ----------
    axial, radial : of the vector from the outer to the inner groove centre, at rest
    inner, outer : of the distance of groove centre and ball centre at the first touch
    """

    axial: float
    radial: float
    inner: float
    outer: float


def grooves(scene: Scene, row: int = 0) -> Grooves:
    """Growth of the grooves of one row.

    Notes
    -----
    A ring whose temperature rises by T grows by a T in all lengths: the circles of the groove centres R_i and R_o, the groove
    radii f D; a ball likewise.  Rings and sleeves between them keep rows apart: the planes of the groove centres, at X of the inner
    and X - s A sin(alpha) of the outer one (side s, distance A), move axially by a T_i X and a T_o (X - s A sin(alpha)).
    At one temperature for all, everything keeps its shape.
    """
    b, (side, position), warm = scene.bearing.of_rows[row], scene.bearing.rows[row], scene.mounting
    angle, half = b.contact_angle, 0.5 * b.ball_diameter
    to_inner, to_outer = ((f - 0.5) * b.ball_diameter for f in (b.conformity_inner, b.conformity_outer))
    by_inner = b.rings.strain("bearing.rings", warm.inner_temperature)
    by_outer = b.rings.strain("bearing.rings", warm.outer_temperature)
    ball = b.balls.strain("bearing.balls", warm.ball_temperature) * half
    if scene.kinematics.ball_growth:
        ball += ball_growth(b, scene.spin_speed)
    circle = 0.5 * b.pitch_diameter + to_inner * cos(angle)
    outer_circle = 0.5 * b.pitch_diameter - to_outer * cos(angle)
    fits = inner_fit(scene, b) - outer_fit(scene, b)
    return Grooves(
        axial=by_outer * (to_inner + to_outer) * sin(angle) + side * (by_inner - by_outer) * position,
        radial=radial_growth(scene, row) + fits + by_inner * circle - by_outer * outer_circle,
        inner=by_inner * (to_inner + half) - ball,
        outer=by_outer * (to_outer + half) - ball,
    )


def ball_growth(bearing: Bearing, spin_speed: float) -> float:
    """Centrifugal growth of a ball's radius at its equator, where it rolls [m].

    Notes
    -----
    A free elastic sphere of the radius R that turns with w_b grows there by
    rho w_b^2 R^3 / E (2 (1 - 2 nu) / 15 + (1 + nu) (2 + nu) / (3 (7 + 5 nu))): the solution of the equations of elasticity in the
    second spherical harmonic.  A ball that rolls on a standing outer ring at the free contact angle has, with g = D cos(alpha)/d_m,
    w_b = w (d_m / (2 D) (1 - g^2) - (1 - g) / 2) about an axis next to the bearing's.

    References
    ----------
    Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed., chapter XI (solid sphere under a body force).
    """
    d, dm, ball = bearing.ball_diameter, bearing.pitch_diameter, bearing.balls
    g = d * cos(bearing.contact_angle) / dm
    speed = spin_speed * (0.5 * dm / d * (1.0 - g**2) - 0.5 * (1.0 - g))
    nu = ball.poisson
    shape = 2.0 * (1.0 - 2.0 * nu) / 15.0 + (1.0 + nu) * (2.0 + nu) / (3.0 * (7.0 + 5.0 * nu))
    return float(shape * ball.density * speed**2 * (0.5 * d) ** 3 / ball.young)


def inner_fit(scene: Scene, bearing: Bearing) -> float:
    """Radial growth of the inner raceway by the interference on the shaft [m].

    Notes
    -----
    Thick-walled cylinders of one material: with bore d, raceway d_1 = d_m - D and hole d_s the raceway grows, on the radius, by
    I/2 (d_1 / d) (d^2 - d_s^2) / (d_1^2 - d_s^2); ``_by_interference`` takes two.  The interference
    falls by as much as the ring's bore grows beyond the shaft, by centrifugal growth and by temperature.

    References
    ----------
    Harris & Kotzalas, Essential Concepts of Bearing Technology, 5th ed., chapter 3 (interference fitting and clearance).
    """
    return _by_interference(scene, bearing, running_interference(scene, bearing))


def speed_growth(scene: Scene) -> tuple[float, float, float]:
    """Radial growth of the inner raceway [m]: by speed, by its fit at standstill, and what speed takes from that fit."""
    b, free = scene.bearing.of_rows[0], radial_growth(scene) - scene.kinematics.radial_expansion
    fit, each = warm_interference(scene, b), _by_interference(scene, b, 1.0)
    return free, each * fit, each * (fit - running_interference(scene, b))


def outer_fit(scene: Scene, bearing: Bearing) -> float:
    """Radial growth of the outer raceway by the interference in the housing [m], negative: as ``inner_fit``, from outside."""
    return _by_interference(scene, bearing, warm_interference(scene, bearing, "housing"), "housing")


def _by_interference(scene: Scene, bearing: Bearing, interference: float, seat: str = "shaft") -> float:
    """Radial growth of a raceway by the interference of its ring [m]: Lamé's thick-walled cylinders, each of its own material
    (Timoshenko & Goodier, section 28)."""
    warm, rings, sign = scene.mounting, bearing.rings, 1.0 if seat == "shaft" else -1.0
    d, far = (bearing.bore, warm.shaft_bore) if seat == "shaft" else (bearing.outer_diameter, warm.housing_diameter)
    if interference <= 0.0 or d is None:
        return 0.0
    core, race = getattr(warm, f"{seat}_material") or rings, bearing.pitch_diameter - sign * bearing.ball_diameter
    around = 1.0 if far is None else abs((far**2 + d**2) / (far**2 - d**2))
    softness = (abs((race**2 + d**2) / (race**2 - d**2)) + sign * rings.poisson) / rings.young
    softness += (around - sign * core.poisson) / core.young
    return interference * d * race / (softness * rings.young * (race**2 - d**2))


def warm_interference(scene: Scene, bearing: Bearing, seat: str = "shaft") -> float:
    """Interference of shaft or housing with its ring at their temperature, at standstill, on the diameter [m]."""
    rings, warm, inside = bearing.rings, scene.mounting, seat == "shaft"
    d, kelvin = (bearing.bore, warm.inner_temperature) if inside else (bearing.outer_diameter, warm.outer_temperature)
    cold, material = (getattr(warm, f"{seat}_{word}") for word in ("interference", "material"))
    if material is None or d is None:
        return float(cold)
    expands = material.strain(f"mounting.{seat}_material", kelvin) - rings.strain("bearing.rings", kelvin)
    return float(cold + (expands if inside else -expands) * d)


def running_interference(scene: Scene, bearing: Bearing, seat: str = "shaft") -> float:
    """Interference of shaft or housing with its ring at speed and temperature, on the diameter [m].

    Notes
    -----
    Of plane-stress annuli: the bore a of a ring up to the radius b grows by rho w^2 a / (4 E) ((1 - nu) a^2 + (3 + nu) b^2), a
    shaft with the hole c by the same with its own numbers and c for b.

    References
    ----------
    Timoshenko & Goodier, Theory of Elasticity, 3rd ed., section 32.
    """
    at_rest, rings = warm_interference(scene, bearing, seat), bearing.rings
    if seat == "housing" or bearing.bore is None or not scene.kinematics.ring_growth:
        return at_rest
    a, c = 0.5 * bearing.bore, 0.5 * scene.mounting.shaft_bore
    b = 0.5 * (bearing.pitch_diameter - bearing.ball_diameter) + groove_depth(bearing)
    ring, core = (
        body.density / (4.0 * body.young) * ((1.0 - body.poisson) * a**2 + (3.0 + body.poisson) * far**2)
        for body, far in ((rings, b), (scene.mounting.shaft_material or rings, c))
    )
    return float(at_rest - 2.0 * scene.spin_speed**2 * a * (ring - core))


def growth_faults(scene: Scene) -> list[Mistake]:
    """Fits that lack a dimension; growth that leaves no bearing."""
    faults, warm = [], scene.mounting
    for seat, dimension in (("shaft", "bore"), ("housing", "outer_diameter")):
        for key in (f"{seat}_interference", f"{seat}_material"):
            if getattr(warm, key) and any(getattr(b, dimension) is None for b in scene.bearing.of_rows):
                value = getattr(warm, key) if key.endswith("interference") else None
                faults.append(Mistake(f"mounting.{key}", value, f"needs the bearing's `{dimension}`"))
    shaft = scene.source.get("mounting", {}).get("shaft_material")
    if scene.kinematics.ring_growth and shaft and "density" not in shaft:
        why = "is required by kinematics.ring_growth: the shaft grows with the speed, too"
        faults.append(Mistake("mounting.shaft_material.density", None, why))
    narrow = min((b.bore for b in scene.bearing.of_rows if b.bore is not None), default=None)
    if narrow is not None and warm.shaft_bore >= narrow:
        faults.append(
            Mistake("mounting.shaft_bore", warm.shaft_bore, f"must be smaller than the bearing's bore, {narrow:g} m")
        )
    wide = max((b.outer_diameter for b in scene.bearing.of_rows if b.outer_diameter is not None), default=None)
    if wide is not None and warm.housing_diameter is not None and warm.housing_diameter <= wide:
        rule = f"must be larger than the bearing's outer diameter, {wide:g} m"
        faults.append(Mistake("mounting.housing_diameter", warm.housing_diameter, rule))
    if faults:
        return faults
    try:
        for row, bearing in enumerate(scene.bearing.of_rows):
            faults = faults or _row_faults(scene, row, bearing)
    except SceneError as error:  # a body that lacks its thermal expansion
        return error.mistakes
    return faults


def _row_faults(scene: Scene, row: int, bearing: Bearing) -> list[Mistake]:
    """Of one row: a bearing that is closed or opened by its growth."""
    if not scene.mounting.changes:
        return []  # what kinematics.radial_expansion does alone is told where the equilibrium is
    grown, angle = grooves(scene, row), bearing.contact_angle
    distance = (bearing.conformity_inner + bearing.conformity_outer - 1.0) * bearing.ball_diameter
    centres, between = distance + grown.inner + grown.outer, distance * cos(angle) + grown.radial
    edge = acos(1.0 - groove_depth(bearing) / (0.5 * bearing.ball_diameter))
    words, key = "temperatures and fits", _cause(scene, row)
    value = getattr(scene.mounting, key)
    if centres <= 0.0 or between >= centres:
        short = 1e6 * (between - max(centres, 0.0))
        rule = (
            f"{words} close the bearing: its grooves leave {short:.3g} µm too little room for the balls, which would be squeezed all "
            "around at a contact angle of 0. Take smaller differences of temperature, a looser fit, or more clearance"
        )
        return [Mistake(f"mounting.{key}", value, rule)]
    if between <= 0.0 or acos(between / centres) >= edge:
        at = 90.0 if between <= 0.0 else degrees(acos(between / centres))
        rule = (
            f"{words} open the bearing: balls would touch at {at:.3g} deg, beyond the groove's edge at {degrees(edge):.3g} deg. "
            "Take smaller differences of temperature"
        )
        return [Mistake(f"mounting.{key}", value, rule)]
    return []


def free_angle(b: Bearing, grown: Grooves) -> float:
    """Free contact angle of a row whose grooves have grown [rad]; 0 where nothing is left of its clearance."""
    distance = (b.conformity_inner + b.conformity_outer - 1.0) * b.ball_diameter
    along = (distance * cos(b.contact_angle) + grown.radial) / (distance + grown.inner + grown.outer)
    return acos(min(max(along, -1.0), 1.0))


def loose_rings(scene: Scene) -> list[str]:
    """A sentence for each ring that its running, warm fit does not hold."""
    warnings = []
    for ring, seat, grown in (
        ("inner ring is loose on its", "shaft", "more"),
        ("outer ring is loose in its", "housing", "less"),
    ):
        least = min(running_interference(scene, b, seat) for b in scene.bearing.of_rows)
        fit = getattr(scene.mounting, f"{seat}_interference")
        if least < -_FINEST_TOLERANCE:
            warnings.append(
                f"the {ring} {seat} by {-1e6 * least:.3g} µm, on the diameter: it has grown {1e6 * (fit - least):.3g} µm {grown}, by speed "
                f"({30.0 * scene.spin_speed / pi:.6g} r/min) and temperature, and `mounting.{seat}_interference` is {1e6 * fit:g} µm. It is "
                "computed as a free ring that stays centred"
            )
    return warnings


def _cause(scene: Scene, row: int) -> str:
    """The key that does most to the grooves' room: the temperature furthest from the others, brought to their mean, or a fit."""
    warm = {name: value for name, value in attrs.asdict(scene.mounting).items() if name.endswith("_temperature")}
    mean = sum(warm.values()) / len(warm)
    furthest = max(warm, key=lambda name: abs(warm[name] - mean))
    mean_of_others = (sum(warm.values()) - warm[furthest]) / (len(warm) - 1)
    without = {furthest: mean_of_others, "shaft_interference": 0.0, "housing_interference": 0.0}

    def room(**changed: Any) -> float:
        grown = grooves(attrs.evolve(scene, mounting=attrs.evolve(scene.mounting, **changed)), row)
        return grown.inner + grown.outer - grown.radial

    now = room()
    return max(without, key=lambda name: abs(room(**{name: without[name]}) - now))
