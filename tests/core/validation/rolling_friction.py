"""Friction of balls term by term, in arrays over points, races and balls: what the compiled loop of the core does in one pass."""

import attrs
import numpy as np

from raceway.core.columns import Number
from raceway.core.quantities.rolling_friction import BallContacts, Lubrication, losses, spin_shape
from raceway.extend import ellipse

_SIDES = np.array([[-1.0], [1.0]])
_AIR, _STEEL = 1.2, 226.4e9


@attrs.frozen(eq=False)
class LoadedContacts:
    """As ``BallContacts``, arrays that broadcast to (n, 2, Z), with semi-axes [m] under the load."""

    load: np.ndarray
    angle: np.ndarray
    semi_major: np.ndarray
    semi_minor: np.ndarray
    ball_diameter: Number
    pitch_diameter: Number
    conformity: Number
    modulus: Number
    inertia: Number

    @property
    def direction(self) -> tuple[np.ndarray, np.ndarray]:
        """Cosine and sine of the angle; of an open contact those of the ball's other one."""
        angle = np.where(np.isnan(self.angle), self.angle[:, ::-1], self.angle)
        return np.cos(angle), np.sin(angle)

    @property
    def along(self) -> np.ndarray:
        """R_x [m]."""
        g = self.ball_diameter / self.pitch_diameter * self.direction[0]
        return np.asarray(0.5 * self.ball_diameter * (1.0 + _SIDES * g))

    def compiled(self, row: np.ndarray | None = None) -> BallContacts:
        """As the core takes them; default: balls of one row."""
        numbers = attrs.asdict(self, recurse=False)
        root = np.cbrt(np.where(self.load > 0.0, self.load, 1.0))
        numbers |= {"semi_major": self.semi_major / root, "semi_minor": self.semi_minor / root}
        return BallContacts(**numbers, row=np.zeros(self.load.shape[2], dtype=int) if row is None else row)


@attrs.frozen(eq=False)
class Rates:
    """Over the shaft's speed: turns of the cage (n, 1, Z); entraining speed [m], rolling, spin (n, 2, Z); gyroscopic (n, 1, Z)."""

    cage: np.ndarray
    entraining: np.ndarray
    rolling: np.ndarray
    spin: np.ndarray
    gyroscopic: np.ndarray


def ball_rates(contacts: LoadedContacts, outer_race: bool = False) -> Rates:
    """Of balls that roll without slip at the centres of both contacts."""
    (cosine, sine), ratio = contacts.direction, contacts.ball_diameter / contacts.pitch_diameter
    width = contacts.along / (0.5 * contacts.ball_diameter)
    axial, radial = (cosine + _SIDES * ratio), sine
    part: Number = 1.0
    if not outer_race:
        level = (cosine[:, :1] * cosine[:, 1:]) + (sine[:, :1] * sine[:, 1:])
        tilt = (sine[:, :1] * cosine[:, 1:]) - (cosine[:, :1] * sine[:, 1:])
        over = (level - _SIDES * ratio * cosine) / width
        loss = contacts.load * contacts.semi_major * np.abs(sine + tilt / (ratio * (1.0 + over)))
        share = loss[:, :1] / np.maximum(loss.sum(axis=1, keepdims=True), 1e-300)
        part = (1.0 - share) ** 8 / (share**8 + (1.0 - share) ** 8)
    x, y = (part * each[:, 1:] + (1.0 - part) * each[:, :1] for each in (axial, radial))
    over = (cosine * x + sine * y) / width
    ball = 1.0 / (ratio * over.sum(axis=1, keepdims=True))
    race = ball * ratio * over
    spin = np.abs(ball * (sine * x - cosine * y) - _SIDES * race * sine)
    return Rates(race[:, 1:], 0.5 * contacts.pitch_diameter * race * width, race / ratio, spin, np.abs(ball * y))


def hydrodynamic_force(contacts: LoadedContacts, oil: Lubrication, entraining: np.ndarray) -> np.ndarray:
    """2 F_R [N] at entraining speeds [m/s]."""
    along = contacts.along
    a, b, q, e = contacts.semi_major, contacts.semi_minor, contacts.load, contacts.modulus
    r, u = 2.0 * e * a * b**2 / (3.0 * q * along), 2.0 * oil.viscosity * entraining / (e * along)
    starved = 1.8 * u**0.75 / r**0.25
    regime = r**0.25 * (b / a) * q / (e * along**2) / u**0.75
    rigid = 0.77 * (b / a) ** 0.12 * u ** (2.0 / 3.0) / np.cbrt(r)
    force = 4.0 * a * e * along * ((rigid - starved) / (1.0 + regime / 6.6) + starved)
    return np.asarray(force / (1.0 + 0.29 * _loading(oil, entraining) ** 0.78))


def hysteresis_moment(contacts: LoadedContacts) -> np.ndarray:
    """(n, 2, Z) [N m]."""
    k = np.maximum(contacts.semi_major / contacts.semi_minor - 1.0, 0.0)
    moment = 7.48e-7 * (0.5 * contacts.ball_diameter) ** 0.33 * contacts.load**1.33 * (1.0 - 3.519e-3 * k**0.8063)
    return np.asarray(moment * np.cbrt(_STEEL / contacts.modulus))


def mean_slip(spin: np.ndarray, h: np.ndarray) -> np.ndarray:
    """By spin and curvature, of one unit."""
    c = 0.34729635533386066**2 * (1.0 - np.minimum(spin / h, 1.0) ** 2) ** 1.5
    root = spin + np.sqrt(spin**2 + 4.0 * c * h**2)
    upper, lower = 2.0 * h * c / root, np.maximum(-0.5 * root / h, -1.0)

    def below(t: np.ndarray) -> np.ndarray:
        return np.asarray(t**2 * spin * (0.5 - 0.25 * t**2) + t * h * (t**2 * (1.0 / 3.0 - 0.2 * t**2 + c / 3.0) - c))

    return np.asarray(h * (0.2 - c) + 1.5 * (below(lower) - below(upper)))


def traction_coefficient(contacts: LoadedContacts, oil: Lubrication, slip: np.ndarray, entraining: np.ndarray) -> np.ndarray:
    """Mean shear stress over mean pressure at speeds [m/s]."""
    a, b, q, along, e = contacts.semi_major, contacts.semi_minor, contacts.load, contacts.along, contacts.modulus
    pressure, u, w = q / (np.pi * a * b), oil.viscosity * entraining / (e * along), q / (e * along**2)
    film = 2.69 * along * u**0.67 * w**-0.067 * (oil.pressure_viscosity * e) ** 0.53 * (1.0 - 0.61 * np.exp(-0.73 * a / b))
    film /= 1.0 + 0.254 * _loading(oil, entraining) ** 0.62
    ratio = oil.viscosity * np.exp(oil.pressure_viscosity * pressure) * slip / (film * oil.eyring_stress)
    return np.asarray(np.minimum(oil.eyring_stress * np.arcsinh(ratio) / pressure, oil.traction_limit))


def _loading(oil: Lubrication, entraining: np.ndarray) -> np.ndarray:
    return np.asarray(oil.viscosity * oil.temperature_viscosity / oil.conductivity * entraining**2)


def drag_force(contacts: LoadedContacts, oil: Lubrication, cage: np.ndarray) -> np.ndarray:
    """On each ball [N] where the cage turns with ``cage`` [rad/s]."""
    density = oil.oil_fraction * oil.density + (1.0 - oil.oil_fraction) * _AIR
    front = 0.25 * np.pi * contacts.ball_diameter**2
    return np.asarray(0.5 * density * oil.drag_coefficient * front * (0.5 * contacts.pitch_diameter * cage) ** 2)


def torques(
    contacts: LoadedContacts, oil: Lubrication, speed: np.ndarray, outer_race: bool = False
) -> dict[str, np.ndarray]:
    """By the names of ``raceway.core.quantities.rolling_friction.Losses``, of each contact (n, 2, Z) and ball (n, Z), at speeds (n,) above 0."""
    rates, w, f = ball_rates(contacts, outer_race), speed[:, None, None], contacts.conformity
    q, a, diameter = contacts.load, contacts.semi_major, contacts.ball_diameter
    across = 2.0 * f * diameter / (2.0 * f + 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):  # of open contacts
        slip = mean_slip(rates.spin * a * spin_shape(a / contacts.semi_minor), rates.rolling * a**2 / (2.0 * across))
        sliding = traction_coefficient(contacts, oil, slip * w, rates.entraining * w) * q * slip
        rolling = rates.entraining * hydrodynamic_force(contacts, oil, rates.entraining * w)
    able = oil.traction_limit * q
    held = able[:, 1:] if outer_race else able.sum(axis=1, keepdims=True)
    sideways = 2.0 * contacts.inertia * rates.gyroscopic * rates.cage * w**2 / (diameter * held)
    across = 1.0 / np.sqrt(1.0 - np.minimum(sideways, 0.9) ** 2)
    sliding = sliding * (np.concatenate([np.ones_like(across), across], axis=1) if outer_race else across)
    closed = {"rolling": rolling, "elastic_rolling": rates.rolling * hysteresis_moment(contacts), "sliding": sliding}
    drag = drag_force(contacts, oil, rates.cage * w) * 0.5 * contacts.pitch_diameter * rates.cage
    balls = {"drag": drag[:, 0], "gyroscopic": sideways[:, 0]}
    return {name: np.where(q > 0.0, part, 0.0) for name, part in closed.items()} | balls


OIL = Lubrication(0.03, 2e-8, 0.04, 0.14, 870.0, 0.05, 5e6, 0.01, 0.44)
#: A ball of 4.365 mm between grooves as the open program D-BRAIN tests it: 136 N, 10 000 r/min, angle 0.
D, RACE, GROOVE = 4.3650e-3, 40.635e-3, 2.3571e-3
PITCH = 2.0 * RACE + D
SPEED = 0.25 * (PITCH**2 - D**2) / PITCH * 10_000.0 * np.pi / 30.0


def contacts(
    load: tuple[float, float] = (200.0, 200.0), angle: tuple[float, float] = (0.26, 0.26), diameter: float = 9.525e-3,
    pitch: float = 46e-3, conformity: float = 0.52, modulus: float = 2.26e11,
) -> LoadedContacts:  # fmt: skip
    """One ball."""
    sign, g = np.array([-1.0, 1.0]), diameter * np.cos(angle) / pitch
    along, across = 2.0 / (diameter * (1.0 + sign * g)), (2.0 - 1.0 / conformity) / diameter
    axes = [
        ellipse(rx + across, (rx - across) / (rx + across), 0.5 * modulus).semi_axes(q)
        for rx, q in zip(along, load, strict=True)
    ]
    major, minor = np.array(axes).T[:, None, :, None]
    column = np.array([load, angle])[:, None, :, None]
    return LoadedContacts(*column, major, minor, diameter, pitch, conformity, modulus, 0.0)


def brain() -> LoadedContacts:
    """That ball's contact with the inner race, at both places."""
    axes = (np.full((1, 2, 1), half) for half in (429.5e-6, 76.762e-6))
    return LoadedContacts(np.full((1, 2, 1), 136.0), np.zeros((1, 2, 1)), *axes, D, PITCH, GROOVE / D, 207e9 / 0.91, 0.0)


#: Of that contact against the ball's rolling [N m]: ``RollingResistance0`` of D-BRAIN's tests, which states pi and lengths to other digits.
INLET_MOMENT = 0.7780845243544707e-3


def inlet_moment() -> float:
    """The same, from the torque on the shaft: moment over radius is the oil's shear on one surface, half of the loss over the speed."""
    oil, turns = attrs.evolve(OIL, viscosity=43.691e-3, temperature_viscosity=1e-30), 10_000.0 * np.pi / 30.0
    force = losses(brain().compiled(), oil, np.array([turns])).rolling[0, 0, 0] * turns / SPEED
    return float(0.5 * force * 0.5 * D * (1.0 - D / PITCH))


def hysteresis_loss(load: float) -> float:
    """Part of the elastic work that a rolling ball on a plane loses: Johnson, Contact Mechanics, 9.2, M = 3/16 c a Q; 1 to 3 % of steel."""
    radius, e = 4.7625e-3, 226.4e9
    a = np.cbrt(1.5 * load * radius / e)
    ball = LoadedContacts(*(np.full((1, 2, 1), v) for v in (load, 0.0, a, a)), 2.0 * radius, 1.0, 0.52, e, 0.0)
    rolling = losses(ball.compiled(), OIL, np.array([1.0])).elastic_rolling[0, 0, 0] / ball_rates(ball).rolling[0, 0, 0]
    return float(rolling / (3.0 / 16.0 * a * load))


def rolling_without_oil() -> float:
    """Largest torque [N m] of balls at angle 0 that roll without oil on bodies that do not deform."""
    small = np.full((1, 2, 1), 1e-12)
    rolling = attrs.evolve(contacts(angle=(0.0, 0.0)), semi_major=small, semi_minor=small)
    dry = attrs.evolve(OIL, viscosity=1e-30, oil_fraction=0.0, drag_coefficient=0.0)
    lost = losses(rolling.compiled(), dry, np.array([1000.0]))
    return float((lost.rolling + lost.sliding + lost.drag.sum()).max())


def drag_over_sphere() -> float:
    """Of a ball whose cage turns with 500 rad/s, by hand: 0.01 870 + 0.99 1.2 = 9.888 kg/m3, 0.5 9.888 0.44 pi/4 0.009525^2 11.5^2 N."""
    cage = 0.5 * (1.0 - 9.525e-3 / 46e-3 * np.cos(0.26))  # over the shaft's
    force = losses(contacts().compiled(), OIL, np.array([500.0 / cage])).drag[0, 0] / (23e-3 * cage)
    return float(force / (0.5 * 9.888 * 0.44 * 0.25 * np.pi * 9.525e-3**2 * 11.5**2))


#: Torque of three balls in a 51205 by spin-down, Balan et al. (2015), tables 1 and 2: K n of K w^n [N m] from r/min down, by ball's
#: diameter [m] and load of each ball [N].
SPIN_DOWN = {
    (6.35e-3, 0.125): {60: (4.208e-5, 0.652), 90: (3.839e-5, 0.647), 120: (3.943e-5, 0.620), 150: (3.779e-5, 0.654),
                       180: (3.457e-5, 0.622), 210: (3.354e-5, 0.649)},
    (3e-3, 0.633): {60: (4.001e-5, 0.116), 90: (3.287e-5, 0.277), 120: (2.864e-5, 0.318), 150: (2.796e-5, 0.366),
                    180: (3.210e-5, 0.344), 210: (3.213e-5, 0.339)},
}  # fmt: skip


def spin_down() -> list[tuple[float, float, float]]:
    """Speed [rad/s], measured torque and that of the inlets' shear [N m]; pitch circle of 36 mm, grooves of 4.16 mm, 0.05 Pa s."""
    out = []
    for (diameter, load), runs in SPIN_DOWN.items():
        one = contacts((load, load), (0.5 * np.pi, 0.5 * np.pi), diameter, 36e-3, 4.16e-3 / diameter).compiled()
        for rpm, (factor, power) in runs.items():
            speed = rpm * np.pi / 30.0
            lost = losses(one, attrs.evolve(OIL, viscosity=0.05), np.array([speed]))
            out.append((speed, factor * speed**power, 3.0 * float(lost.rolling.sum())))
    return out
