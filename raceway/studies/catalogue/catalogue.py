"""The catalogue of bearings, for Python: ``raceway.catalogue``."""

from __future__ import annotations

import attrs

from raceway.errors import SceneError
from raceway.framework.doors import door
from raceway.framework.registry import Registry
from raceway.pipeline.equilibrium import ball_pass
from raceway.scene.catalogue import Preset, found_by, geometry_of, materials, no_preset
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables


@door
def catalogue(pattern: str = "*") -> tuple[Preset, ...]:
    """Bearings of the catalogue, which ``preset`` of a scene's [bearing] takes by name.

    Parameters
    ----------
    pattern : as in a shell (``"70*C"``), or a part of the name; in any case

    Returns
    -------
    tuple of Preset
        Each with ``name``, ``title``, ``table`` (the [bearing] table), ``facts`` (value, source, scatter) and ``stiffness_error``

    Raises
    ------
    SceneError
        None has such a name; the nearest five.

    Examples
    --------
    >>> import raceway as rw
    >>> [one.name for one in rw.catalogue("7014*")]
    ['7014C', '7014A5', '7014A']
    >>> rw.catalogue("7014C")[0].table["ball_count"]
    20
    """
    found = tuple(found_by(pattern))
    if not found:
        raise SceneError.at("pattern", pattern, no_preset(pattern))
    return found


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
