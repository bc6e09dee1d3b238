"""What the study runs: every setting at every axial load over all speeds, made from one scene."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import attrs

from raceway.errors import SceneError
from raceway.registry import Registry
from raceway.scene_file import read_toml, with_value
from raceway.studies.axes import Axis, parse_axis, points
from raceway.studies.points import tables_at

DIRECTIONS = ("unidirectional", "bidirectional")
AMPLITUDES = ("constant", "unbalance")
#: The pairs that the article compares; it changes direction and amplitude law at once.
CLAIMED = (("unidirectional", "constant"), ("bidirectional", "unbalance"))
TILTS = ("locked", "shaft", "free")
BODIES = ("rigid", "condensed")
ARTICLE = Path(__file__).resolve().parents[2] / "data" / "article.toml"
#: The article's ranges: section 4 (speeds) and 3.3 (axial loads); how finely is ours.
SPEEDS = "10980:15000:9"
LOADS = "400:2000:9"
#: The rig's shaft: span between the bearings from section 3.3; the diameter is not printed, 30 mm is the bearing's bore.
SHAFT_DIAMETER, SPAN, YOUNG = 0.030, 0.175, 212e9


@attrs.frozen(order=True)
class Setting:
    """One way to model the bearing; everything else is the scene's."""

    direction: str
    amplitude: str
    tilt: str
    inertia: bool
    bodies: str

    @property
    def name(self) -> str:
        balls = "ball inertia" if self.inertia else "weightless balls"
        return f"{self.direction}, {self.amplitude} amplitude, {TILT_WORDS[self.tilt]}, {balls}, {self.bodies}"


TILT_WORDS = {"locked": "tilt locked", "shaft": "tilt against the shaft", "free": "tilt free"}


@attrs.frozen
class Design:
    """The runs of a study.

    Attributes
    ----------
    tables : the scene's tables;  speeds [r/min], loads [N] : ascending
    shaft : tilt stiffness of the setting "shaft" [N m/rad];  bodies : the kinds that are run
    """

    tables: Mapping[str, Any]
    speeds: tuple[float, ...]
    loads: tuple[float, ...]
    shaft: float
    bodies: tuple[str, ...]

    @property
    def relative_speeds(self) -> list[float]:
        """w* = (w - w_min) / (w_max - w_min)."""
        first, last = self.speeds[0], self.speeds[-1]
        return [(speed - first) / (last - first) for speed in self.speeds]

    def settings(self) -> Iterator[Setting]:
        """All of them for the first kind of bodies; for a second one the pairs of excitation that the claims are about."""
        for bodies, direction, amplitude, tilt, inertia in product(
            self.bodies, DIRECTIONS, AMPLITUDES, TILTS, (True, False)
        ):
            if bodies == self.bodies[0] or (direction, amplitude) in CLAIMED:
                yield Setting(direction, amplitude, tilt, inertia, bodies)

    def point(self, setting: Setting, load: float, speed: float, registry: Registry) -> dict[str, Any]:
        """The scene's tables at one point."""
        chosen = {
            "bodies.kind": setting.bodies,
            "excitation.kind": setting.direction,
            "excitation.amplitude": setting.amplitude,
            "excitation.speed_rpm": speed,
            "supports.tilt": self.shaft if setting.tilt == "shaft" else setting.tilt,
            "kinematics.ball_inertia": setting.inertia,
            "load.axial": load,
            "integrator.kind": "periodic",
        }
        return tables_at(self.tables, chosen, registry)


def shaft_tilt_stiffness(diameter: float = SHAFT_DIAMETER, span: float = SPAN, young: float = YOUNG) -> float:
    """What the rig's shaft opposes to a tilt of the inner ring [N m/rad].

    Notes
    -----
    A uniform shaft between two bearings whose rings tilt by the same angle in opposite senses, which is how a force at
    mid-span bends it: moment over angle 2 E I / L.
    """
    return 2.0 * young * math.pi * diameter**4 / 64.0 / span


def article_tables() -> dict[str, Any]:
    """The article's scene, which the package brings."""
    return read_toml(ARTICLE)


def design(
    tables: Mapping[str, Any], speeds: str = SPEEDS, loads: str = LOADS, shaft: float | None = None,
    bodies: Sequence[str] = BODIES,
) -> Design:  # fmt: skip
    """The runs for a scene.

    Parameters
    ----------
    speeds, loads : "a,b,c" or "start:stop:count" [r/min], [N]
    shaft : tilt stiffness [N m/rad]; the scene's own where it has one, else that of the rig's shaft

    Raises
    ------
    SceneError
        A scene without unbalance, too few speeds or loads, or values that do not ascend.
    """
    excitation = tables.get("excitation")
    if not isinstance(excitation, Mapping) or excitation.get("unbalance") is None:
        message = "is needed: the study compares the force m e w^2 with one of constant amplitude; give it in kg m"
        raise SceneError.at("excitation.unbalance", None, message)
    own = tables.get("supports", {}).get("tilt")
    if shaft is None:
        shaft = float(own) if isinstance(own, int | float) and not isinstance(own, bool) else shaft_tilt_stiffness()
    if not (math.isfinite(shaft) and shaft > 0.0):
        raise SceneError.at("--shaft", shaft, "must be a tilt stiffness above 0 N m/rad")
    found = Design(tables, _values("--speeds", speeds), _values("--axial", loads), shaft, tuple(bodies))
    if "force" not in excitation and "reference_speed_rpm" not in excitation:
        changed = with_value(tables, "excitation.reference_speed_rpm", found.speeds[0])
        found = attrs.evolve(found, tables=changed)
    return found


def _values(option: str, text: str) -> tuple[float, ...]:
    """Ascending positive numbers, at least three: two points have no curvature.

    Raises
    ------
    SceneError
        Naming the option.
    """
    try:
        axis: Axis = parse_axis(f"{option}={text}")
    except SceneError as error:
        raise SceneError.at(option, text, error.mistakes[0].message.replace("table.key=", "")) from None
    values = [point[option] for point in points([axis])]
    if not axis.numeric or any(not value > 0.0 for value in values):
        raise SceneError.at(option, text, "must be numbers above 0, for instance 10980:15000:9 or 400,1000,2000")
    if len(values) < 3 or sorted(set(values)) != values:
        raise SceneError.at(option, text, "must be at least three values in ascending order: a course is judged over them")
    return tuple(float(value) for value in values)
