"""Materials of rings and balls by name, in ``raceway/data/materials.toml``, each with its source."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files

import attrs

from raceway.errors import SceneError
from raceway.framework.options import nearest
from raceway.scene.bearing import Material
from raceway.storage.tables import Tables


@attrs.frozen
class NamedMaterial:
    """young [Pa], poisson, density [kg/m3], thermal_expansion [1/K]; title and source."""

    name: str
    title: str
    young: float
    poisson: float
    density: float
    thermal_expansion: float
    source: str


@cache
def materials() -> dict[str, NamedMaterial]:
    """All by name."""
    text = files("raceway").joinpath("data/materials.toml").read_text(encoding="utf-8")
    return {name: NamedMaterial(name, **row) for name, row in tomllib.loads(text).items()}


def with_material(table: Tables, path: str, preset: Tables) -> Tables:
    """A table [bearing.rings] or [bearing.balls] with the numbers of its ``material``; own keys override them, the preset's do not.

    Raises
    ------
    SceneError
        Unknown name, with the nearest one.
    """
    name = table.get("material")
    if name is None:
        return {**preset, **table}
    if not isinstance(name, str) or name not in materials():
        known = ", ".join(materials())
        raise SceneError.at(f"{path}.material", name, f"no such material{nearest(str(name), materials())}; known: {known}")
    one = attrs.asdict(materials()[name])
    return {**{key: one[key] for key in attrs.fields_dict(Material) if key in one}, **table}
