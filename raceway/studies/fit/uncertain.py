"""Numbers of a scene that a fit takes as known, and by how much they may be off.

Notes
-----
A range of the scene's [tolerances] counts by the root mean square of what an even distribution lies off its number; the relative scatter
that the catalogue has of a preset's inferred numbers is a standard error.  Conformities of a preset are one number that was inferred: they
are off together.  What they move the estimate by is linear: of least squares with residuals r and derivatives J, by -(J' J)^-1 J' dr.
"""

from __future__ import annotations

from collections.abc import Collection

import attrs

from raceway.scene.catalogue import geometry_of
from raceway.scene.continuous import continuous_keys, key_of, with_number
from raceway.scene.given import leaves
from raceway.scene.scene import Scene
from raceway.scene.tolerance import tolerances_of


@attrs.frozen
class Uncertain:
    """Numbers that are off together.  ``cause``: in words;  ``sizes``: path -> standard error, in the unit of the key."""

    cause: str
    sizes: dict[str, float]

    def moved(self, scene: Scene, by: float) -> Scene:
        """The scene with these numbers off by so many standard errors; ``ValueError`` where a key's rule refuses one."""
        for path, size in self.sizes.items():
            scene = with_number(scene, path, key_of(scene, path).value + by * size)
        return scene


def uncertain(scene: Scene, free: Collection[str], measured: Collection[str] = ()) -> tuple[Uncertain, ...]:
    """Uncertain numbers of a scene, but for free ones.

    Parameters
    ----------
    measured : keys that the data state, which no catalogue tells

    Raises
    ------
    SceneError
        A tolerance that reaches what a rule refuses.
    """
    table = dict(leaves(scene.source.get("tolerances", {})))
    sizes = {}
    for one in tolerances_of(scene, table) if table else ():
        above, below = one.high - one.key.value, one.key.value - one.low
        sizes[one.key.path] = ((above**3 + below**3) / 3.0 / (above + below)) ** 0.5
    found = [Uncertain(path, {path: size}) for path, size in sizes.items() if path not in free]
    said = scene.source if scene.given is None else scene.given.merged()
    geometry = geometry_of(scene.source["bearing"], said.get("bearing", {})) or {}
    tables = [("bearing", geometry), *((f"bearing.row[{one['row']}]", one) for one in geometry.get("rows", ()))]
    facts = {f"{name}.{key}": fact["scatter"] for name, one in tables for key, fact in one.get("inferred", {}).items()}
    scatters = {
        key.path: facts[key.path] * abs(key.value)
        for key in continuous_keys(scene)
        if facts.get(key.path) and key.path not in {*sizes, *free, *measured}
    }
    grooves = {path: size for path, size in scatters.items() if ".conformity" in path}
    found += [Uncertain(path, {path: size}) for path, size in scatters.items() if path not in grooves]
    if grooves:
        found.append(Uncertain("groove conformities", grooves))
    return tuple(found)
