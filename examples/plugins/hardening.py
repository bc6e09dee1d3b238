"""A study: how a bearing stiffens under axial load."""

from collections.abc import Iterable
from typing import Any

import attrs

import raceway as rw
from raceway.extend import new_figure


@attrs.frozen(eq=False, repr=False)
class Stiffening(rw.Answer):
    """Radial stiffness kyy [N/m] under axial loads [N]."""

    stem = "hardening"
    title: str
    axial: list[float]
    kyy: list[float]

    def to_dict(self) -> dict[str, Any]:
        return {"title": self.title, "axial_n": self.axial, "kyy_n_per_m": self.kyy}

    def report(self) -> list[Any]:
        return [
            [{"axial N": f"{load:g}", "kyy N/µm": f"{1e-6 * k:.4g}"} for load, k in zip(self.axial, self.kyy, strict=True)]
        ]

    def draw(self) -> Any:
        figure = new_figure(5.0, 3.6)
        axes = figure.subplots(subplot_kw={"xlabel": "axial load  [N]", "ylabel": "kyy  [N/µm]"})
        axes.plot(self.axial, [1e-6 * k for k in self.kyy])
        return figure


def hardening(scene: Any, factors: Iterable[float] = (0.5, 1.0, 2.0), *, progress: Any = None) -> Stiffening:
    """Compute the radial stiffness of a scene under multiples of its axial load.

    Parameters
    ----------
    factors : of the axial load
    """
    axial = [factor * scene.load.axial for factor in factors]
    swept = rw.sweep(scene, {"load.axial": axial}, progress=progress)
    return Stiffening(scene.title, axial, swept.stiffness.sel(dof="y", dof2="y").values.tolist())


@attrs.frozen
class Hardening:
    """Its entry in the registry."""

    name = "hardening"
    help = "The radial stiffness under multiples of the axial load."

    def command(self) -> Any:
        return rw.Command(self.name, hardening, self.help, "raceway study hardening SCENE --factors 1 --factors 3").click()


@rw.hookimpl
def raceway_studies() -> list[type]:
    return [Hardening]
