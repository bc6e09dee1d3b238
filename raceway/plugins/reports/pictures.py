"""Pictures of one run: orbit, spectrum and ball loads as PNG files."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.errors import RacewayError, extra
from raceway.framework.options import between, option
from raceway.plugins.reports.drawing import draw_ball_loads, draw_orbit, draw_spectrum
from raceway.storage.files import write_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from raceway.framework.higher_types import Result


@attrs.frozen
class Pictures:
    """Orbit and 1x spectrum of the displacement, and the ball loads round the bearing.

    Figures are drawn on their own canvas: a caller's backend and settings of matplotlib stay as they are.
    """

    name: ClassVar[str] = "pictures"

    dots_per_inch: int = option(150, help="resolution of the PNG files", rule=between(30, 1200))

    def write(self, result: Result, folder: Path) -> list[Path]:
        """Write the pictures that the result has data for.

        Parameters
        ----------
        result : raceway.pipeline.result.Result
        folder : path, made when it is missing

        Returns
        -------
        list of Path : orbit.png and spectrum.png where motion was recorded, ball-loads.png always

        Raises
        ------
        RacewayError
            matplotlib is missing, or the folder cannot be written.
        """
        figures = {"ball-loads.png": ball_loads(result)}
        if result.simulation is not None:
            figures = {"orbit.png": orbit(result), "spectrum.png": spectrum(result), **figures}
        return [save_figure(figure, Path(folder) / name, self.dots_per_inch) for name, figure in figures.items()]


def new_figure(width: float, height: float) -> Figure:
    """An empty figure [inch] that belongs to no window.

    Raises
    ------
    RacewayError
        Where matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise RacewayError(
            f"pictures need matplotlib, which is not installed: {extra('pictures')}, or leave out --pictures"
        ) from None
    return Figure(figsize=(width, height), layout="constrained")


def given_axes(axes: Axes | None, width: float = 6.4, height: float = 4.8) -> Axes:
    """The axes that a caller gave, or new ones of a figure [inch] that notebooks and ``pyplot.show`` display.

    Raises
    ------
    RacewayError
        Where matplotlib is not installed.
    """
    if axes is not None:
        return axes
    try:
        from matplotlib import pyplot
    except ImportError:
        raise RacewayError(f"plots need matplotlib, which is not installed: {extra('pictures')}") from None
    return pyplot.subplots(figsize=(width, height), layout="constrained")[1]


def save_figure(figure: Figure, path: Path, dots_per_inch: int = 150) -> Path:
    """Write a figure as PNG, whole or not at all.

    Raises
    ------
    RacewayError
        A folder or disk that cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure.set_dpi(dots_per_inch)
    memory = io.BytesIO()
    FigureCanvasAgg(figure).print_png(memory)
    return write_whole(memory.getvalue(), path)


def orbit(result: Result) -> Figure:
    """Path of the inner ring's reference point in the radial plane."""
    figure = new_figure(6.4, 6.8)
    draw_orbit(figure.add_subplot(), result)
    figure.legend(loc="outside lower center", ncols=3, fontsize=9.5, frameon=False)
    return figure


def spectrum(result: Result) -> Figure:
    """Amplitude of the displacement against multiples of the excitation's frequency."""
    figure = new_figure(7.2, 4.6)
    draw_spectrum(figure.add_subplot(), result)
    figure.legend(loc="outside lower center", ncols=3, fontsize=9.5, frameon=False)
    return figure


def ball_loads(result: Result) -> Figure:
    """Inner contact load of each ball: static, and its range over the recorded turns."""
    figure = new_figure(7.0, 6.4)
    draw_ball_loads(figure.add_subplot(projection="polar"), result)
    figure.legend(loc="outside lower center", ncols=2, fontsize=10, frameon=False)
    return figure
