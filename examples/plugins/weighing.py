"""An ability from nothing: a command, a public name, a quantity, a table of the scene and a picture, in one module of a package."""

from collections.abc import Iterable
from typing import Any

import attrs

import raceway as rw


@attrs.frozen
class Weighing:
    """The table [weighing] of a scene."""

    gravity: float = rw.option(9.80665, unit="m/s2", help="acceleration", rule=rw.positive())


@attrs.frozen
class PressureOverYoung:
    """Largest contact pressure over 200 GPa."""

    name = "pressure_over_young"
    numbers = (rw.Quantity("pressure_over_young", "1", "largest pressure over 200 GPa", "pressure_over_young.largest"),)

    def why_not(self, problem: Any) -> str:
        return ""

    def compute(self, points: Any) -> dict[str, Any]:
        return {"pressure_over_young": points.peak_pressure.max(axis=(1, 2)) / 200e9}


@attrs.frozen(eq=False, repr=False)
class Weights(rw.Answer):
    """Weight of all balls [N] for several numbers of balls."""

    stem = "weights"
    title: str
    counts: list[int]
    newtons: list[float]

    def to_dict(self) -> dict[str, Any]:
        return {"title": self.title, "balls": self.counts, "weight_n": self.newtons}

    def report(self) -> list[Any]:
        return [[{"balls": n, "weight N": f"{weight:.4g}"} for n, weight in zip(self.counts, self.newtons, strict=True)]]

    def draw(self) -> Any:
        from raceway.extend import new_figure

        figure = new_figure(5.0, 3.6)
        figure.subplots(subplot_kw={"xlabel": "balls", "ylabel": "weight  [N]"}).plot(self.counts, self.newtons)
        return figure


def weigh(scene: Any, counts: Iterable[int] = (8, 16)) -> Weights:
    """Weigh the balls of a bearing.

    Parameters
    ----------
    scene : a scene, a path or tables
    counts : numbers of balls
    """
    from raceway.extend import as_scene, structure

    scene, mistakes = as_scene(scene), list[rw.Mistake]()
    gravity = structure(scene.source.get("weighing", {}), Weighing, "weighing", mistakes).gravity
    one = gravity * scene.bearing.balls.density * scene.bearing.ball_diameter**3 * 3.141592653589793 / 6.0
    return Weights(scene.title, list(counts), [n * one for n in counts])


@rw.hookimpl
def raceway_commands() -> dict[str, tuple[rw.Command, ...]]:
    return {
        "Answers": (rw.Command("weigh", weigh, "Weigh the balls.", "raceway weigh SCENE --counts 8", folder="-weighed"),)
    }


@rw.hookimpl
def raceway_names() -> dict[str, str]:
    return {"weigh": __name__}


@rw.hookimpl
def raceway_tables() -> dict[str, str]:
    return {"weighing": f"{__name__}:Weighing"}


@rw.hookimpl
def raceway_quantities() -> list[type]:
    return [PressureOverYoung]
