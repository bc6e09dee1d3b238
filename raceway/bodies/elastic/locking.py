"""Bodies whose elements lock: nearly incompressible materials under contacts at surface points."""

from __future__ import annotations

from raceway.scene.scene import Scene

#: Poisson's ratio from which contacts at surface points are too stiff by percents: measured with B7206C, which does not
#: change with the mesh: 2 % at 0.49, 20 % at 0.499, 75 % at 0.4999.  One-point elements with hourglass control: 20 % at 0.45.
_FROM, _ONE_POINT = 0.49, 0.4


def locking(scene: Scene) -> list[str]:
    """A warning for each material that is nearly incompressible."""
    one_point = scene.bodies.name == "elastic" and scene.bodies.formulation == "one_point"
    least = _ONE_POINT if one_point else _FROM
    found = []
    for part in ("rings", "balls"):
        poisson = getattr(scene.bearing, part).poisson
        if poisson >= least:
            found.append(
                f"bearing.{part}.poisson = {poisson:g}: elements lock near 0.5, contacts at surface points are too stiff by "
                f"{'tens of percent' if one_point or poisson > 0.495 else 'percents'} whatever the mesh; take bodies.kind = "
                "'condensed' with contact.discretisation = 'resultant', or rigid bodies, whose contacts are Hertz's"
            )
    return found
