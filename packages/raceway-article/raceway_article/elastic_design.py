"""The runs of the article's own model, and their scenes: elastic bodies at one operating point, beside condensed and rigid ones."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import attrs
from raceway_checks.verify.reference import reference_cases

from raceway import Scene, SceneError, scene_from_dict
from raceway.extend import ReadTables, Registry, Tables, tables_at, with_value
from raceway_article.design import CLAIMED, EXPLICIT, excitation_of, friction_of

SCENE = Path(__file__).resolve().parent / "data" / "article_elastic.toml"
#: Condensed bodies come first: the others are compared with them, and they show in seconds whether the scene is what was meant.
BODIES = ("condensed", "rigid", "elastic")
#: One operating point: turns and steps of a turn.
TURNS, STEPS = 2, 40
#: Stiffness of a contact of elastic or rigid bodies that sticks [N/m]: it gives way by 0.8 um before it slides, a tenth of the orbit.  The
#: default of surface points, as stiff as their penalty, has Newton's method change to and fro between points that stick and slide.
#: C depends on it (rigid, 6 turns, N s/m): 65 with 1e7, 2400 with 3e7, 4860 with Mindlin's; of condensed bodies, which do not take it, 4600.
_STICK = 1e7
#: Residual of a step over the largest force: one solution with factors of elastic bodies reaches it, a second one costs as much.
_TOLERANCE = 1e-5
_CASES = "seed-static-pressures"
#: Tables that scenes at rest do not have.
_OF_MOTION = ("excitation", "integrator", "identifier")


@attrs.frozen
class ElasticRun:
    """One run of the study.

    bodies : of ``BODIES``;  axial, radial : load [N]
    excitation : (direction, amplitude law) of a motion; None at rest
    explicit : a motion by the scene's explicit steps
    """

    bodies: str
    axial: float
    radial: float = 0.0
    excitation: tuple[str, str] | None = None
    explicit: bool = False

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
        return f"{self.phase} {self.case} with {self.bodies} bodies" + (", explicit" if self.explicit else "")

    @property
    def integrator(self) -> str | None:
        return None if self.excitation is None else EXPLICIT if self.explicit else "newmark"


@attrs.frozen
class ElasticDesign:
    """All runs of one scene.

    tables : of the scene;  friction : Coulomb coefficient of the motions;  turns : of a motion, of ``STEPS`` steps each
    """

    tables: ReadTables
    friction: float
    turns: int

    @property
    def speed_rpm(self) -> float:
        return float(self.tables["excitation"]["speed_rpm"])

    @property
    def load_cases(self) -> list[tuple[float, float]]:
        """Axial and radial loads at rest, of the static verification [N]."""
        return [(float(axial), float(radial)) for axial, radial in reference_cases()[_CASES].inputs["loads_n"]]

    def runs(self) -> list[ElasticRun]:
        """Those at rest first, motions last: they cost most."""
        static = [ElasticRun(bodies, axial, radial) for axial, radial in self.load_cases for bodies in BODIES]
        axial, ways = float(self.tables["load"]["axial"]), [(bodies, False) for bodies in BODIES]
        if self.tables.get("integrator", {}).get("kind") == EXPLICIT:
            ways.append(("elastic", True))
        return static + [ElasticRun(bodies, axial, 0.0, pair, explicit) for pair in CLAIMED for bodies, explicit in ways]

    def point(self, run: ElasticRun, registry: Registry) -> Tables:
        """The scene's tables of one run."""
        values: Tables = {
            "bodies.kind": run.bodies,
            "load.axial": run.axial,
            "load.radial": [run.radial, 0.0],
            "supports.tilt": "locked",
            # Of elastic bodies kyy at rest is without sticking: friction would make that of the others another quantity.
            "contact.friction": 0.0 if run.excitation is None else self.friction,
        }
        if run.excitation is not None:
            values |= {
                "kinematics.ball_inertia": True,
                "excitation.kind": run.excitation[0],
                "excitation.amplitude": run.excitation[1],
                "integrator.kind": run.integrator,
                "integrator.turns": self.turns,
            }
            if not run.explicit:
                values |= {"integrator.tolerance": _TOLERANCE, "integrator.steps_per_turn": STEPS}
        if run.excitation is not None and self.friction > 0.0:
            values["contact.stick_stiffness"] = _STICK
        scene = dict(self.tables)
        if run.bodies == "rigid":  # one force a contact, by Hertz's law; no mesh
            scene.pop("mesh")
            values |= {"contact.kind": "hertz", "contact.discretisation": "resultant"}
        tables = tables_at(scene, values, registry)
        return tables if run.excitation is not None else {k: v for k, v in tables.items() if k not in _OF_MOTION}

    def scene(self, run: ElasticRun, registry: Registry) -> Scene:
        return scene_from_dict(self.point(run, registry), registry)


def design(tables: ReadTables, friction: float | None = None, turns: int = TURNS) -> ElasticDesign:
    """The runs for a scene.

    friction : see ``raceway_article.design.friction_of``

    SceneError: A scene without unbalance, axial load, mesh or contacts at surface points; a friction below 0.
    """
    excitation = excitation_of(tables)
    if not isinstance(tables.get("mesh"), Mapping):
        why = "is needed: every node of elastic bodies is an unknown; examples/b7206_article_mesh.toml has the article's"
        raise SceneError.at("mesh", None, why)
    discretisation = tables.get("contact", {}).get("discretisation")
    if discretisation != "nodal":
        why = "must be 'nodal' here: peak pressures are those at surface points"
        raise SceneError.at("contact.discretisation", discretisation, why)
    friction = friction_of(tables, friction)
    axial = tables.get("load", {}).get("axial", 0.0)
    if not axial > 0.0:
        raise SceneError.at("load.axial", axial, "must be above 0: it is the load of the motions, in N")
    if "force" not in excitation and "reference_speed_rpm" not in excitation:
        why = "is needed, or `excitation.force`: one force has a constant amplitude, that at this speed"
        raise SceneError.at("excitation.reference_speed_rpm", None, why)
    return ElasticDesign(with_value(tables, "bodies.kind", "elastic"), friction, turns)
