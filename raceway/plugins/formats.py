"""Files of one run and what they see of it: pictures of orbit, spectrum and ball loads; arrays with names, coordinates and units."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol

import attrs

from raceway.answers import quantities
from raceway.answers.picture import COLOURS, MARKERS, given_axes, label_axes, new_figure, save_figure, wrapped
from raceway.answers.quantities import Quantity
from raceway.errors import RacewayError, extra
from raceway.framework.options import between, nearest, option
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from raceway.bodies.model import Equilibrium, Model
    from raceway.core.record import Record
    from raceway.core.signals import Identification


class RecordedMotion(Protocol):
    """The motion of a run: ``whole``, and ``record`` of the turns that are used."""

    @property
    def model(self) -> Model: ...
    @property
    def whole(self) -> Record: ...
    @property
    def record(self) -> Record: ...


class RunResult(Protocol):
    """What formats write of one run: ``raceway.pipeline.result.Result``; no motion or identification where none was asked for."""

    @property
    def title(self) -> str: ...
    @property
    def warnings(self) -> tuple[str, ...]: ...
    @property
    def model(self) -> Model: ...
    @property
    def equilibrium(self) -> Equilibrium: ...
    @property
    def simulation(self) -> RecordedMotion | None: ...
    @property
    def identification(self) -> Identification | None: ...


def labelled_dataset(variables: Tables, coordinates: Any, attributes: Tables) -> Any:
    """An xarray.Dataset; RacewayError where xarray is missing."""
    try:
        import xarray
    except ImportError as why:
        raise RacewayError(f"labelled results need xarray, which is not installed: {extra('results')} ({why})") from None
    return xarray.Dataset(variables, coordinates, attributes)


def labelled(result: RunResult) -> Any:
    """All arrays of a run as an xarray.Dataset.

    ``displacement``, ``stiffness``, ``ball_load`` and ``contact_angle`` of the equilibrium; the ``motion``, ``force`` and
    ``contact_force`` of the turns that are used by ``time``, where motion was recorded; the identified numbers, and ends of the
    intervals of K and kyy.

    RacewayError: xarray is missing.
    """
    import numpy as np

    from raceway.core.ring.ring import COORDINATES

    state, z, names = result.equilibrium, result.model.system.ball_count, list(COORDINATES)
    arrays: list[tuple[Quantity, object]] = [
        (quantities.DISPLACEMENT, state.displacement),
        (quantities.STIFFNESS, state.stiffness),
        (quantities.BALL_LOAD, state.contact_force.reshape(2, z)),
        (quantities.CONTACT_ANGLE, np.degrees([state.angle_inner, state.angle_outer])),
    ]
    coordinates: dict[str, object] = {"dof": names, "dof2": names, "race": ["inner", "outer"], "ball": np.arange(z)}
    azimuth = quantities.AZIMUTH
    coordinates[azimuth.name] = (azimuth.dims, np.degrees(result.model.azimuth) % 360.0, azimuth.labels)
    if result.simulation is not None:
        record = result.simulation.record
        coordinates[quantities.TIME.name] = (quantities.TIME.dims, record.time, quantities.TIME.labels)
        arrays += [
            (quantities.MOTION, record.displacement),
            (quantities.FORCE, record.force),
            (quantities.CONTACT_FORCE, record.contact_force.reshape(len(record.time), 2, z)),
        ]
    if result.identification is not None:
        impedance, stiffness = (quantities.Z_REAL, quantities.Z_IMAG, quantities.SPEED), (quantities.K, quantities.K_ERROR)
        numbers = (
            (quantity, quantity.of(result)) for quantity in (*impedance, *stiffness, quantities.C, quantities.C_ERROR)
        )
        arrays += [(quantity, np.nan if value is None else value) for quantity, value in numbers]
    ends = {quantity: quantity.of(result) for quantity in quantities.ENDS.values()}
    arrays += [(quantity, value) for quantity, value in ends.items() if value is not None]
    variables = {quantity.name: (quantity.dims, values, quantity.labels) for quantity, values in arrays}
    return labelled_dataset(variables, coordinates, {"title": result.title, "warnings": "\n".join(result.warnings)})


_USED, _STATIC = COLOURS[:2]
_OTHER, _GRID = "#b9c4cf", "#d8dee4"
_MICRO = 1e6
#: Lines of a spectrum from which on their tops are joined.
_DENSE = 400


@attrs.frozen
class Pictures:
    """Orbit and 1x spectrum of the displacement, and the ball loads round the bearing.

    Figures are drawn on their own canvas: a caller's backend and settings of matplotlib stay as they are.
    """

    name: ClassVar[str] = "pictures"
    suffixes: ClassVar[tuple[str, ...]] = (".png",)
    of_results: ClassVar[bool] = True

    dots_per_inch: int = option(300, help="resolution of the PNG files", rule=between(30, 1200))

    def write(self, folder: Path, result: RunResult) -> list[Path]:
        """Write the pictures that the result has data for.

        Parameters
        ----------
        folder : path, made when it is missing
        result : raceway.pipeline.result.Result

        Returns
        -------
        list of Path : orbit.png and spectrum.png where motion was recorded, ball-loads.png always

        Raises
        ------
        RacewayError
            matplotlib is missing, or the folder cannot be written.
        """
        figures = drawings(result).items()
        return [save_figure(figure, Path(folder) / f"{name}.png", self.dots_per_inch) for name, figure in figures]


def drawings(result: RunResult) -> dict[str, Figure]:
    """Figures by the names of their files."""
    return {name.replace("_", "-"): picture(result, name) for name in _available(result)}


def picture(result: RunResult, name: str) -> Figure:
    """A figure of one drawing, "orbit", "spectrum" or "ball_loads", with its legend below."""
    drawing = _DRAWINGS[name]
    figure = new_figure(*drawing.size)
    drawing.draw(figure.add_subplot(projection=drawing.projection), result)
    figure.legend(loc="outside lower center", ncols=drawing.columns, fontsize=drawing.legend, frameon=False)
    return figure


def plot(result: RunResult, what: str | None, ax: Axes | None) -> Axes | tuple[Axes, ...]:
    """Draw one picture, or all that the result has data for; its axes, or a tuple of them.

    what : "orbit", "spectrum" or "ball_loads"; None: all, side by side
    ax : axes of matplotlib for one picture, polar ones for the ball loads; None: new ones of pyplot

    RacewayError: matplotlib is missing; no such picture, or no data for it; axes that it cannot be drawn on.
    """
    available = _available(result)
    if what is not None and what not in _DRAWINGS:
        raise RacewayError(f"`what` = {what!r}: must be one of {', '.join(_DRAWINGS)}{nearest(str(what), _DRAWINGS)}")
    if what is not None and what not in available:
        raise RacewayError(f"`what` = {what!r}: no motion was recorded; available: {', '.join(available)}")
    if ax is not None and what is None:
        raise RacewayError(f"`ax` is for one picture: choose it by `what`, {', '.join(available)}")
    names = available if what is None else (what,)
    if ax is None:
        try:
            from matplotlib import pyplot
        except ImportError:
            raise RacewayError(f"pictures need matplotlib, which is not installed: {extra('pictures')}") from None
        figure = pyplot.figure(figsize=(6.4 * len(names), 6.0), layout="constrained")
        frames = [{"projection": _DRAWINGS[name].projection} for name in names]
        axes = tuple(figure.add_subplot(1, len(names), k, **frame) for k, frame in enumerate(frames, 1))
    else:
        axes = (given_axes(ax),)
    for name, frame in zip(names, axes, strict=True):
        polar = _DRAWINGS[name].projection == "polar"
        if polar and frame.name != "polar":
            raise RacewayError(f"`ax`: {name} needs polar axes: pyplot.subplots(subplot_kw={{'projection': 'polar'}})")
        _DRAWINGS[name].draw(frame, result)
        beside: dict[str, Any] = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.08), "ncols": 2} if polar else {}
        frame.legend(fontsize=9, frameon=False, **beside)
    return axes[0] if what is not None else axes


def _available(result: RunResult) -> tuple[str, ...]:
    return tuple(_DRAWINGS) if result.simulation is not None else ("ball_loads",)


def _draw_orbit(axes: Axes, result: RunResult) -> None:
    """Path of the inner ring's reference point in the radial plane."""
    motion = result.simulation
    assert motion is not None
    record, used = motion.whole, motion.record
    shortened = len(record.time) > len(used.time)
    turns = round(len(used.time) * used.schedule.stride / used.schedule.steps_per_turn)
    if shortened:
        label = f"all {_turns(record.schedule.turns)}"
        axes.plot(*(_MICRO * record.displacement[:, 1:3].T), color=_OTHER, linewidth=0.8, label=label)
    import numpy as np

    label, path = f"last {_turns(turns)}, used" if shortened else _turns(turns), used.displacement[:, 1:3]
    if motion.model.problem.integrator.method.steady and not shortened:  # closed
        path = np.vstack([path, path[:1]])
    axes.plot(*(_MICRO * path.T), color=_USED, linewidth=1.4, label=label)
    still = _MICRO * result.equilibrium.displacement[1:3]
    axes.plot(*still, "+", color=_STATIC, markersize=11, label="static equilibrium")
    axes.set_aspect("equal", adjustable="datalim")
    label_axes(axes, f"Orbit of the inner ring\n{wrapped(result.title, 64)}", "displacement y [µm]", "displacement z [µm]")


def _draw_spectrum(axes: Axes, result: RunResult) -> None:
    """Amplitude of the displacement against multiples of the excitation's frequency."""
    import numpy as np

    assert result.simulation is not None
    record, z = result.simulation.record, result.identification
    frequency = result.model.excitation.frequency_hz if z is None else z.frequency_hz
    motion = record.displacement[:, 1:3] - record.displacement[:, 1:3].mean(axis=0)
    lines = 2.0 * np.abs(np.fft.rfft(motion, axis=0)) / len(motion) * _MICRO
    order = np.fft.rfftfreq(len(motion), record.time[1] - record.time[0]) / frequency
    shown = (order > 0.0) & (order <= 10.05)
    peak = max(lines[shown].max(), 1e-12)
    apart, width = (0.4 * order[1], 1.0) if order[1] < 0.2 else (0.06, 2.0)
    for lane, (name, colour, dashes) in enumerate((("y", _USED, "-"), ("z", _STATIC, (0, (3, 1))))):
        # Beside each other, since both directions of a turning force have the same line.
        x = order[shown] + (lane - 0.5) * apart
        tops = np.maximum(lines[shown, lane], peak * 1e-9)
        if len(x) > _DENSE:
            axes.plot(x, tops, color=colour, linestyle=dashes, linewidth=width, label=f"displacement {name}")
        else:
            axes.vlines(x, peak * 1e-9, tops, color=colour, linestyle=dashes, linewidth=width, label=f"displacement {name}")
    first = float(lines[shown].max(axis=1)[np.argmin(np.abs(order[shown] - 1.0))])
    text = f"1x: {first:.4g} µm at {frequency:.4g} Hz"
    axes.annotate(text, (1.0, first), xytext=(12, 2), textcoords="offset points", fontsize=10)
    axes.set(yscale="log", xlim=(0.0, 10.4), ylim=(peak * 1e-9, peak * 10.0), xticks=range(11))
    title = f"Spectrum of the displacement, mean removed\n{wrapped(result.title, 64)}"
    label_axes(axes, title, "frequency / excitation frequency [-]", "amplitude [µm]")


def _draw_ball_loads(axes: Any, result: RunResult) -> None:
    """Inner contact load of each ball on polar axes: static, and its range over the recorded turns."""
    import numpy as np

    azimuth, row = result.model.azimuth, result.model.basis.row
    count, z = result.model.geometry.ball_count, len(azimuth)
    static = result.equilibrium.contact_force[:z]
    top, rows = max(static.max(), 1e-12) * 1.2, row[-1] + 1
    for k in range(rows):
        # Equal rows lie upon each other: each is narrower than the one below.
        balls, of_row, below = np.flatnonzero(row == k), f", row {k + 1}" if rows > 1 else "", rows - 1 - k
        colour = COLOURS[(k + 1) % len(COLOURS)]
        if result.simulation is not None:
            loads = result.simulation.record.contact_force[:, balls]
            low, high, style = loads.min(axis=0), loads.max(axis=0), {"color": colour, "alpha": 0.4}
            axes.vlines(
                azimuth[balls], low, high, linewidth=5.0 + 4.0 * below, label=f"range over the orbit{of_row}", **style
            )
            top = max(top, high.max() * 1.2)
        closed, line = np.append(balls, balls[0]), f"{MARKERS[k % len(MARKERS)]}{('-', '--', ':', '-.')[k % 4]}"
        size = {"linewidth": 1.3 + 2.6 * below, "markersize": 4.5 + 5.5 * below}
        axes.plot(azimuth[closed], static[closed], line, color=colour, label=f"static{of_row}", **size)
    for k in range(count):
        axes.text(azimuth[k], top * 0.94, str(k), ha="center", va="center", fontsize=9, color="#5a6570")
    axes.set_ylim(0.0, top)
    axes.set_rlabel_position(90.0 + 180.0 / max(count, 1))
    axes.set_xticks(np.radians(np.arange(0, 360, 30)))
    axes.set_xticklabels(["0° (+y)", "30°", "60°", "90° (+z)", *(f"{a}°" for a in range(120, 360, 30))])
    axes.tick_params(labelsize=10, pad=6)
    title = f"Ball loads on the inner race [N] by azimuth; grey: ball number\n{wrapped(result.title, 64)}"
    axes.set_title(title, fontsize=12, pad=14)
    axes.grid(color=_GRID, linewidth=0.7)


def _turns(count: int) -> str:
    return f"{count} turn{'' if count == 1 else 's'}"


class _Drawing(NamedTuple):
    """What draws on axes of a projection, the figure's size [inch], columns and font size of its legend."""

    draw: Callable[[Any, RunResult], None]
    projection: str | None
    size: tuple[float, float]
    columns: int
    legend: float


_DRAWINGS = {
    "orbit": _Drawing(_draw_orbit, None, (6.4, 6.8), 3, 9.5),
    "spectrum": _Drawing(_draw_spectrum, None, (7.2, 4.6), 3, 9.5),
    "ball_loads": _Drawing(_draw_ball_loads, "polar", (7.0, 6.4), 2, 10.0),
}
