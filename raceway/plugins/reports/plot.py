"""``Result.plot``: drawings of one run on axes of the caller, or on new ones."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from raceway.errors import RacewayError, extra
from raceway.framework.options import nearest
from raceway.plugins.reports.drawing import draw_ball_loads, draw_orbit, draw_spectrum

if TYPE_CHECKING:
    from raceway.framework.higher_types import Result

_DRAWINGS = {"orbit": draw_orbit, "spectrum": draw_spectrum, "ball_loads": draw_ball_loads}
_POLAR = ("ball_loads",)


def plot(result: Result, what: str | None, ax: Any) -> Any:
    """Draw one picture, or all that the result has data for.

    Parameters
    ----------
    what : "orbit", "spectrum" or "ball_loads"; None: all, side by side
    ax : axes of matplotlib for one picture, polar ones for the ball loads; None: new ones of pyplot

    Returns
    -------
    Axes, or a tuple of them where ``what`` is None

    Raises
    ------
    RacewayError
        matplotlib is missing; no such picture, or no data for it; axes that it cannot be drawn on.
    """
    there = tuple(_DRAWINGS) if result.simulation is not None else _POLAR
    if what is not None and what not in _DRAWINGS:
        raise RacewayError(f"`what` = {what!r}: must be one of {', '.join(_DRAWINGS)}{nearest(str(what), _DRAWINGS)}")
    if what is not None and what not in there:
        raise RacewayError(f"`what` = {what!r}: no motion was recorded; what can be drawn is {', '.join(there)}")
    if ax is not None and what is None:
        raise RacewayError(f"`ax` is for one picture: say which with `what`, {', '.join(there)}")
    names = there if what is None else (what,)
    axes = _new_axes(names) if ax is None else (ax,)
    for name, one in zip(names, axes, strict=True):
        if name in _POLAR and one.name != "polar":
            raise RacewayError(f"`ax`: {name} needs polar axes: pyplot.subplots(subplot_kw={{'projection': 'polar'}})")
        _DRAWINGS[name](one, result)
        beside = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.08), "ncols": 2} if name in _POLAR else {}
        one.legend(fontsize=9, frameon=False, **beside)
    return axes[0] if what is not None else axes


def _new_axes(names: tuple[str, ...]) -> tuple[Any, ...]:
    try:
        from matplotlib import pyplot
    except ImportError:
        raise RacewayError(f"pictures need matplotlib, which is not installed: {extra('pictures')}") from None
    figure = pyplot.figure(figsize=(6.4 * len(names), 6.0), layout="constrained")
    kinds = ["polar" if name in _POLAR else None for name in names]
    return tuple(figure.add_subplot(1, len(names), at + 1, projection=kind) for at, kind in enumerate(kinds))
