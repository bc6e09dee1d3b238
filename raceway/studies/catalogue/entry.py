"""What is told of one bearing of the catalogue."""

from __future__ import annotations

import attrs

from raceway.framework.registry import Registry
from raceway.pipeline.settle import ball_pass
from raceway.scene.catalogue import Preset, geometry_of
from raceway.scene.materials import materials
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables


def scene_of(one: Preset) -> Scene:
    """A scene with the bearing alone."""
    return scene_from_dict({"title": one.name, "bearing": {"preset": one.name}}, Registry(third_party=False))


def line(one: Preset) -> Tables:
    """A line of the list: name, main dimensions [m], balls, contact angle."""
    table = one.table
    keys = "bore", "outer_diameter", "width", "contact_angle_deg", "ball_count", "ball_diameter", "pitch_diameter"
    return {
        "name": one.name,
        **{key: table.get(key) for key in keys},
        "stiffness_error": one.stiffness_error,
        "radial_stiffness_error": one.radial_stiffness_error,
    }


def entry(one: Preset) -> Tables:
    """All of one bearing: numbers with source and scatter, ball-pass frequencies at the free contact angle, what is inferred."""
    b = scene_of(one).bearing
    return {
        "name": one.name,
        "title": one.title,
        "bearing": one.table,
        "facts": [attrs.asdict(fact) for fact in one.facts],
        "printed": one.printed,
        "geometry": geometry_of({"preset": one.name}, {}),
        "ball_pass": {
            "contact_angle_deg": b.contact_angle_deg,
            **ball_pass(b.ball_count, b.ball_diameter, b.pitch_diameter, b.contact_angle),
        },
    }


def material_rows() -> list[Tables]:
    """The materials of rings and balls, in SI units, with their sources."""
    return [attrs.asdict(one) for one in materials().values()]
