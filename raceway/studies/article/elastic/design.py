"""The runs: load cases and operating point of the article with elastic, condensed and rigid bodies, made from one scene."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import attrs

from raceway.errors import SceneError
from raceway.framework.registry import Registry
from raceway.scene.changes import with_value
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.article.design import CLAIMED, FRICTION
from raceway.studies.many.points import tables_at
from raceway.studies.many.reference import reference_cases

SCENE = Path(__file__).resolve().parents[3] / "data" / "article_elastic.toml"
#: Condensed bodies come first: the others are held against them, and they show in seconds whether the scene is what was meant.
BODIES = ("condensed", "rigid", "elastic")
#: One operating point: turns and steps of a turn.
TURNS, STEPS = 2, 40
#: Stiffness of a contact that sticks [N/m], for all bodies alike: it gives way by 0.8 um before it slides, a tenth of the orbit.  The
#: default of surface points, as stiff as their penalty, has Newton's method change to and fro between points that stick and slide.
STICK = 1e7
#: Residual of a step over the largest force: one solution with factors of elastic bodies reaches it, a second one costs as much.
TOLERANCE = 1e-5
_CASES = "seed-static-pressures"
#: Tables that scenes at rest do not have.
_OF_MOTION = ("excitation", "integrator", "identifier")


@attrs.frozen
class Run:
    """One run of the study.

    Attributes
    ----------
    bodies : of ``BODIES``;  axial, radial : load [N]
    excitation : (direction, amplitude law) of a motion; None at rest
    """

    bodies: str
    axial: float
    radial: float = 0.0
    excitation: tuple[str, str] | None = None

    @property
    def phase(self) -> str:
        return "static" if self.excitation is None else "motion"

    @property
    def case(self) -> str:
        """Load case or excitation, in words; the same for the three kinds of bodies."""
        if self.excitation is not None:
            return f"{self.excitation[0]} {self.excitation[1]} force"
        return f"{self.axial:g} N axial" + (f" + {self.radial:g} N radial" if self.radial else "")

    @property
    def name(self) -> str:
        return f"{self.phase} {self.case} with {self.bodies} bodies"


@attrs.frozen
class Design:
    """All runs of one scene.

    Attributes
    ----------
    tables : of the scene;  friction : Coulomb coefficient of the motions;  turns : of a motion, of ``STEPS`` steps each
    """

    tables: ReadTables
    friction: float
    turns: int

    @property
    def load_cases(self) -> list[tuple[float, float]]:
        """Axial and radial loads at rest [N]: those of the static verification."""
        return [(float(axial), float(radial)) for axial, radial in reference_cases()[_CASES].inputs["loads_n"]]

    @property
    def speed_rpm(self) -> float:
        return float(self.tables["excitation"]["speed_rpm"])

    def runs(self) -> list[Run]:
        """Rest first, motions last: they are the dearest."""
        rest = [Run(bodies, *loads) for loads in self.load_cases for bodies in BODIES]
        axial = float(self.tables["load"]["axial"])
        return rest + [Run(bodies, axial, excitation=pair) for pair in CLAIMED for bodies in BODIES]

    def point(self, run: Run, registry: Registry) -> Tables:
        """The scene's tables of one run."""
        chosen: Tables = {
            "bodies.kind": run.bodies,
            "load.axial": run.axial,
            "load.radial": [run.radial, 0.0],
            "supports.tilt": "locked",
            # Of elastic bodies kyy at rest is without sticking: friction would make that of the others another quantity.
            "contact.friction": 0.0 if run.excitation is None else self.friction,
        }
        if run.excitation is not None:
            chosen |= {
                "kinematics.ball_inertia": True,
                "excitation.kind": run.excitation[0],
                "excitation.amplitude": run.excitation[1],
                "integrator.kind": "newmark",
                "integrator.tolerance": TOLERANCE,
                "integrator.turns": self.turns,
                "integrator.steps_per_turn": STEPS,
            }
        if run.excitation is not None and self.friction > 0.0:
            chosen["contact.stick_stiffness"] = STICK
        given = dict(self.tables)
        if run.bodies == "rigid":  # one force a contact, by Hertz's law; no mesh
            given.pop("mesh")
            chosen |= {"contact.kind": "hertz", "contact.discretisation": "resultant"}
        tables = tables_at(given, chosen, registry)
        return tables if run.excitation is not None else {k: v for k, v in tables.items() if k not in _OF_MOTION}

    def scene(self, run: Run, registry: Registry) -> Scene:
        return scene_from_dict(self.point(run, registry), registry)


def design(tables: ReadTables, friction: float | None = None, turns: int = TURNS) -> Design:
    """The runs for a scene.

    Parameters
    ----------
    friction : Coulomb coefficient; the scene's own where it has one, else the article's

    Raises
    ------
    SceneError
        A scene without unbalance, axial load, mesh or contacts at surface points; a friction below 0.
    """
    excitation = tables.get("excitation")
    if not isinstance(excitation, Mapping) or excitation.get("unbalance") is None:
        why = "is needed: the study compares the force m e w^2 with one of constant amplitude; give it in kg m"
        raise SceneError.at("excitation.unbalance", None, why)
    if not isinstance(tables.get("mesh"), Mapping):
        why = "is needed: every node of elastic bodies is an unknown; examples/b7206_article_mesh.toml has the article's"
        raise SceneError.at("mesh", None, why)
    contact = tables.get("contact", {})
    if contact.get("discretisation") != "nodal":
        why = "must be 'nodal' here: peak pressures are those at surface points"
        raise SceneError.at("contact.discretisation", contact.get("discretisation"), why)
    if friction is None:
        friction = float(contact.get("friction", 0.0)) or FRICTION
    if not (math.isfinite(friction) and friction >= 0.0):
        raise SceneError.at("--friction", friction, "must be a coefficient of friction of at least 0")
    axial = tables.get("load", {}).get("axial", 0.0)
    if not axial > 0.0:
        raise SceneError.at("load.axial", axial, "must be above 0: it is the load of the motions, in N")
    if "force" not in excitation and "reference_speed_rpm" not in excitation:
        why = "is needed, or `excitation.force`: one force has a constant amplitude, that at this speed"
        raise SceneError.at("excitation.reference_speed_rpm", None, why)
    return Design(with_value(tables, "bodies.kind", "elastic"), friction, turns)
