"""Runs of the study, made from one scene: every setting at every axial load over all speeds; K and |Z| of them by setting."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path

import attrs
import numpy as np

from raceway import SceneError
from raceway.extend import ReadTables, Registry, Status, Tables, parse_axis, points, read_toml, tables_at, with_value

DIRECTIONS = ("unidirectional", "bidirectional")
AMPLITUDES = ("constant", "unbalance")
#: The pairs that the article compares; it changes direction and amplitude law at once.
CLAIMED = tuple(zip(DIRECTIONS, AMPLITUDES, strict=True))
ONE_WAY, ROTATING = ({"direction": direction, "amplitude": amplitude} for direction, amplitude in CLAIMED)
TILT_WORDS = {"locked": "tilt locked", "shaft": "tilt against the shaft", "free": "tilt free"}
TILTS = tuple(TILT_WORDS)
BODIES = ("rigid", "condensed")
#: The article's coefficient, section 3.1; what a contact that sticks means depends on whether the balls orbit.
_FRICTION = 0.03
FRICTION_WORDS = {
    "none": "without friction",
    "standing": "friction on balls that stand",
    "orbiting": "friction on balls that orbit",
}
FRICTIONS = tuple(FRICTION_WORDS)
#: How runs with friction are integrated: the force grows over two thirds of the turns, the last third counts. Steps that are solved to
#: 1e-4 of the forces move K by at most 5e-7.
FRICTION_TURNS, FRICTION_STEPS, FRICTION_TOLERANCE = 12, 360, 1e-4
#: Least relative error of K with friction: what twice the turns of twice the steps change (``packages/raceway-article/tests/evidence/test_article.py``).
FRICTION_ERROR = 0.005
ARTICLE = Path(__file__).resolve().parent / "data" / "article.toml"
#: The article's ranges: section 4 (speeds) and 3.3 (axial loads); how finely is ours.
SPEEDS = "10980:15000:9"
LOADS = "400:2000:9"
#: Speeds [r/min] of the independent solver's printed digits.
SOLVER_SPEEDS = (10980.0, 12000.0, 13000.0, 14000.0, 15000.0)
#: Tilt stiffness of the shaft [N m/rad], from next to free to next to locked.
STIFFNESSES = tuple(float(f"{10.0 ** (2.0 + 0.25 * k):.4g}") for k in range(17))
RACES = ("inner", "outer")
#: Integrator of explicit steps, which elastic bodies of a scene that has it take beside the implicit ones.
EXPLICIT = "central_difference"
#: The rig's shaft: span between the bearings from section 3.3; the diameter is not printed, 30 mm is the bearing's bore.
_SHAFT_DIAMETER, _SPAN, _YOUNG = 0.030, 0.175, 212e9
#: Status of a run that is neither failed nor refused.
ANSWERED = (Status.COMPLETED, Status.UNSTABLE, Status.UNSTEADY)
#: What may be called k: name -> key of a row.
MEASURES = {"K": "k", "|Z|": "abs_z"}


@attrs.frozen(order=True)
class Setting:
    """One way to model the bearing; everything else is the scene's."""

    direction: str
    amplitude: str
    tilt: str
    inertia: bool
    bodies: str
    friction: str = "none"

    @property
    def name(self) -> str:
        balls = "ball inertia" if self.inertia else "weightless balls"
        friction = "" if self.friction == "none" else f", {FRICTION_WORDS[self.friction]}"
        return f"{self.direction}, {self.amplitude} amplitude, {TILT_WORDS[self.tilt]}, {balls}, {self.bodies}{friction}"

    @property
    def claimed(self) -> bool:
        return (self.direction, self.amplitude) in CLAIMED


@attrs.frozen
class Design:
    """The runs of a study.

    tables : the scene's tables;  speeds [r/min], loads [N] : ascending
    shaft : tilt stiffness of the setting "shaft" [N m/rad];  bodies : the kinds that are run
    friction : Coulomb coefficient of the settings with friction, which are run with rigid bodies; 0 leaves them out
    """

    tables: ReadTables
    speeds: tuple[float, ...]
    loads: tuple[float, ...]
    shaft: float
    bodies: tuple[str, ...]
    friction: float = 0.0

    @property
    def frictions(self) -> tuple[str, ...]:
        """Of ``FRICTIONS`` those that are run."""
        return FRICTIONS if self.friction > 0.0 and "rigid" in self.bodies else FRICTIONS[:1]

    @property
    def scene_load(self) -> float:
        """The scene's axial load, or the load of the study that lies next to it [N]."""
        axial = self.tables.get("load", {}).get("axial", 0.0)
        return min(self.loads, key=lambda load: abs(load - axial))

    def speeds_of(self, setting: Setting) -> tuple[float, ...]:
        """All of them, with friction every other one: those runs go through time."""
        return self.speeds if setting.friction == "none" else _every_other(self.speeds)

    def loads_of(self, setting: Setting) -> tuple[float, ...]:
        """With friction as the speeds; of the pairs that no claim is about the lightest, the scene's and the heaviest."""
        if not setting.claimed:
            return tuple(sorted({self.loads[0], self.scene_load, self.loads[-1]}))
        return self.loads if setting.friction == "none" else _every_other(self.loads)

    def relative(self, speeds: Sequence[float]) -> list[float]:
        """w* = (w - w_min) / (w_max - w_min)."""
        first, last = self.speeds[0], self.speeds[-1]
        return [(speed - first) / (last - first) for speed in speeds]

    def models(self) -> Iterator[Tables]:
        """Every way to model the bearing, apart from its excitation, in the order of the tables."""
        for friction, tilt, inertia, bodies in product(self.frictions, TILTS, (True, False), BODIES):
            if bodies in self.bodies and (friction == "none" or (inertia and bodies == "rigid")):
                yield {"friction": friction, "tilt": tilt, "inertia": inertia, "bodies": bodies}

    def settings(self) -> Iterator[Setting]:
        """All of them for the first kind of bodies; for a second one, and with friction, the pairs that the claims are about."""
        for bodies, direction, law, tilt, inertia in product(self.bodies, DIRECTIONS, AMPLITUDES, TILTS, (True, False)):
            setting = Setting(direction, law, tilt, inertia, bodies)
            if bodies == self.bodies[0] or setting.claimed:
                yield setting
        for friction, (direction, amplitude), tilt in product(self.frictions[1:], CLAIMED, TILTS):
            yield Setting(direction, amplitude, tilt, True, "rigid", friction)

    def curves(self) -> list[list[tuple[Setting, float]]]:
        """Every setting at each of its axial loads [N]: a curve over speed; together what differs in friction alone, first without."""
        groups = dict[tuple[Setting, float], list[tuple[Setting, float]]]()
        for setting in self.settings():
            for load in self.loads_of(setting):
                groups.setdefault((attrs.evolve(setting, friction="none"), load), []).append((setting, load))
        return list(groups.values())

    def point(self, setting: Setting, load: float, speed: float, registry: Registry) -> Tables:
        """The scene's tables at one point."""
        values = {
            "bodies.kind": setting.bodies,
            "excitation.kind": setting.direction,
            "excitation.amplitude": setting.amplitude,
            "excitation.speed_rpm": speed,
            "supports.tilt": self.shaft if setting.tilt == "shaft" else setting.tilt,
            "kinematics.ball_inertia": setting.inertia,
            "load.axial": load,
            "contact.friction": 0.0 if setting.friction == "none" else self.friction,
            "integrator.kind": "periodic",
        }
        if setting.friction != "none":
            values |= {
                "kinematics.orbiting": setting.friction == "orbiting",
                "integrator.kind": "newmark",
                "integrator.start": "ramp",
                "integrator.turns": FRICTION_TURNS,
                "integrator.steps_per_turn": FRICTION_STEPS,
                "integrator.tolerance": FRICTION_TOLERANCE,
            }
        return tables_at(self.tables, values, registry)


def shaft_tilt_stiffness(diameter: float = _SHAFT_DIAMETER, span: float = _SPAN, young: float = _YOUNG) -> float:
    """Tilt stiffness of the rig's shaft at the inner ring [N m/rad].

    A uniform shaft between two bearings whose rings tilt by the same angle in opposite senses, which is how a force at
    mid-span bends it: moment over angle 2 E I / L.
    """
    return 2.0 * young * math.pi * diameter**4 / 64.0 / span


def article_tables() -> Tables:
    """The article's scene, which the package brings."""
    return read_toml(ARTICLE)


def design(
    tables: ReadTables, speeds: str = SPEEDS, loads: str = LOADS, shaft: float | None = None,
    bodies: Sequence[str] = BODIES, friction: float | None = None,
) -> Design:  # fmt: skip
    """The runs for a scene.

    speeds, loads : "a,b,c" or "start:stop:count" [r/min], [N]
    shaft : tilt stiffness [N m/rad]; the scene's where it has one, else that of the rig's shaft
    friction : see ``friction_of``

    SceneError: A scene without unbalance, too few speeds or loads, or values that do not ascend.
    """
    excitation, tilt = excitation_of(tables), tables.get("supports", {}).get("tilt")
    if shaft is None:
        shaft = float(tilt) if isinstance(tilt, int | float) and not isinstance(tilt, bool) else shaft_tilt_stiffness()
    if not (math.isfinite(shaft) and shaft > 0.0):
        raise SceneError.at("--shaft", shaft, "must be a tilt stiffness above 0 N m/rad")
    friction = friction_of(tables, friction)
    ascending = _ascending("--speeds", speeds)
    if "force" not in excitation and "reference_speed_rpm" not in excitation:
        tables = with_value(tables, "excitation.reference_speed_rpm", ascending[0])
    return Design(tables, ascending, _ascending("--axial", loads), shaft, tuple(bodies), friction)


def excitation_of(tables: ReadTables) -> ReadTables:
    """The scene's excitation; SceneError where it has no unbalance."""
    excitation = tables.get("excitation")
    if not isinstance(excitation, Mapping) or excitation.get("unbalance") is None:
        why = "is needed: the study compares the force m e w^2 with one of constant amplitude; give it in kg m"
        raise SceneError.at("excitation.unbalance", None, why)
    return excitation


def friction_of(tables: ReadTables, friction: float | None) -> float:
    """Coulomb coefficient: the one of ``--friction``, else the scene's, else the article's; SceneError below 0."""
    if friction is None:
        friction = float(tables.get("contact", {}).get("friction", 0.0)) or _FRICTION
    if not (math.isfinite(friction) and friction >= 0.0):
        raise SceneError.at("--friction", friction, "must be a coefficient of friction of at least 0")
    return friction


def _every_other(values: tuple[float, ...]) -> tuple[float, ...]:
    """Every other value with both ends, where at least five are left: an exponent with its interval needs them."""
    return values[::2] if len(values) % 2 and len(values) >= 9 else values


def _ascending(option: str, text: str) -> tuple[float, ...]:
    """Ascending positive numbers, at least three (two points have no curvature); else a SceneError that names the option."""
    try:
        axis = parse_axis(f"{option}={text}")
    except SceneError as error:
        raise SceneError.at(option, text, error.mistakes[0].message.replace("table.key=", "")) from None
    values = [point[option] for point in points([axis])]
    if not axis.numeric or any(not value > 0.0 for value in values):
        raise SceneError.at(option, text, "must be numbers above 0, for instance 10980:15000:9 or 400,1000,2000")
    if len(values) < 3 or sorted(set(values)) != values:
        raise SceneError.at(option, text, "must be at least three values in ascending order: a course is judged over them")
    return tuple(float(value) for value in values)


@attrs.frozen(eq=False)
class Curve:
    """Runs of one setting at one axial load [N], a row per speed; arrays are (speeds,)."""

    setting: Setting
    load: float
    rows: list[Tables]

    def values(self, measure: str = "K", status: str = "completed") -> np.ndarray:
        """K or |Z| [N/m] of runs with this status; nan elsewhere."""
        key = MEASURES[measure]
        return np.array([row[key] if row["status"] == status else np.nan for row in self.rows])

    def normalised(self, measure: str = "K") -> np.ndarray:
        """k* = k / k(w_min)."""
        values = self.values(measure)
        return np.asarray(values / values[0])

    @property
    def errors(self) -> np.ndarray:
        """Each run's relative error, its mesh's apart: that is the same at all speeds.

        With friction at least ``FRICTION_ERROR``: where contacts stick depends on how the motion began.
        """
        least = 0.0 if self.setting.friction == "none" else FRICTION_ERROR
        return np.array([max(row.get("error") or 0.0, least) for row in self.rows])

    @property
    def failed(self) -> np.ndarray:
        """Where the run failed or was refused, so that nobody knows what a ring does."""
        return np.array([row["status"] not in ANSWERED for row in self.rows])

    @property
    def missing(self) -> str:
        """Runs without a number, counted by status, with the first reason of each; "" where there is none."""
        missing = [row for row in self.rows if row["status"] != "completed"]
        parts = []
        for status, count in Counter(row["status"] for row in missing).items():
            rows = [row for row in missing if row["status"] == status]
            speeds = ", ".join(dict.fromkeys(f"{row['speed_rpm']:g}" for row in rows))
            parts.append(f"{count} {status} ({speeds} r/min: {rows[0]['reason']})")
        return "; ".join(parts)


@attrs.frozen(eq=False)
class _Surface:
    """Curves of one setting at all of its axial loads; arrays are (loads, speeds)."""

    loads: tuple[float, ...]
    speeds: tuple[float, ...]
    curves: list[Curve]

    def values(self, measure: str = "K") -> np.ndarray:
        """[N/m]; nan where the run failed or its motion is unstable."""
        return np.array([curve.values(measure) for curve in self.curves])

    @property
    def errors(self) -> np.ndarray:
        return np.array([curve.errors for curve in self.curves])

    @property
    def failed(self) -> np.ndarray:
        return np.array([curve.failed for curve in self.curves])

    @property
    def missing(self) -> str:
        return "; ".join(filter(None, (curve.missing for curve in self.curves)))


@attrs.frozen(eq=False)
class Curves:
    """All rows: (setting, axial load) -> one row a speed, in the design's order."""

    design: Design
    rows: dict[tuple[Setting, float], list[Tables]]

    def curve(self, setting: Setting, load: float) -> Curve:
        return Curve(setting, load, self.rows[setting, load])

    def surface(self, setting: Setting) -> _Surface:
        loads = self.design.loads_of(setting)
        return _Surface(loads, self.design.speeds_of(setting), [self.curve(setting, load) for load in loads])

    def surfaces(self, excitation: ReadTables) -> Iterator[tuple[Tables, _Surface]]:
        """Every way to model the bearing under an excitation, and its curves."""
        return ((model, self.surface(Setting(**excitation, **model))) for model in self.design.models())

    def faults(self) -> Iterator[Tables]:
        """Every run that gave no number to judge with."""
        for (setting, _), rows in self.rows.items():
            yield from ({**attrs.asdict(setting), **row} for row in rows if row["status"] != "completed")


def hardening(rows: list[Tables]) -> np.ndarray:
    """k*(1) over the stiffnesses (n,); nan where a run failed."""
    k = np.array([row["k"] if row["status"] == "completed" else np.nan for row in rows]).reshape(-1, 2)
    return np.asarray(k[:, 1] / k[:, 0])
