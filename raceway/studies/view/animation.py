"""A turn of the bearing as a GIF: balls by their load, the ring's motion and orbit exaggerated by a factor that it says."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from raceway.storage.files import write_whole
from raceway.studies.view import scene, surfaces
from raceway.studies.view.bearing import Bearing, Part

if TYPE_CHECKING:
    from types import ModuleType

    from raceway.studies.view.bearing import State
    from raceway.studies.view.states import Turn

_SIZE = (640, 640)
_SECONDS = 4.0
_INK, _ORBIT, _FORCE = "#20262c", "#c8501e", "#0b5fa5"


def animate(
    bearing: Bearing, turn: Turn, heading: str, path: Path, on_frame: Callable[[int, int], None] | None = None
) -> Path:
    """Write a GIF that repeats itself.

    Parameters
    ----------
    turn : raceway.view.Turn
    on_frame : called with the frames done and in all

    Raises
    ------
    RacewayError
        pyvista or Pillow is missing, or the file cannot be written.
    """
    pyvista = scene.pyvista_of(", or leave out --animate")
    frames = []
    z = len(turn.states[0].azimuth)
    loads = np.array([state.load[:z] for state in turn.states])
    top = max(float(loads.max()), 1e-12)
    peak = 1e-6 * max(float(state.peak.max()) for state in turn.states)
    strongest = max(float(np.hypot(*turn.force.T).max()), 1e-12)
    for k, state in enumerate(turn.states):
        if on_frame is not None:
            on_frame(k, len(turn.states))
        words = (
            f"{np.degrees(turn.angle[k]):3.0f} deg of the turn; balls {loads[k].min():.0f} to {loads[k].max():.0f} N; "
            f"force {np.hypot(*turn.force[k]):.4g} N"
        )
        moving = [
            *_rings(bearing, state),
            *bearing.balls(state),
            *bearing.arrows(state, top),
            *_inside(bearing, turn, k, strongest),
        ]
        frames.append(scene.quietly(pyvista, _frame, pyvista, moving, heading, words, top, peak))
    return write_whole(_gif(frames), path)


def _rings(bearing: Bearing, state: State) -> list[Part]:
    """The outer ring, seen through, where it is, and the inner one where its motion takes it."""
    import attrs

    parts = []
    for part in bearing.rings(cut=None):
        if part.name.startswith("inner"):
            moved = 1e3 * bearing.moved(1e-3 * part.surface.points, state)
            part = attrs.evolve(part, surface=attrs.evolve(part.surface, points=moved))
        else:
            part = attrs.evolve(part, opacity=0.15)
        parts.append(part)
    return parts


def _inside(bearing: Bearing, turn: Turn, k: int, strongest: float) -> list[Part]:
    """In the bore: the orbit as it is drawn, the ring's centre on it, the force as an arrow."""
    size, front = bearing.diameter, 500.0 * bearing.shape.width
    # As large as fits the bore, whatever the factor of the bodies is.
    largest = max(float(np.hypot(*turn.orbit.T).max()), 1e-12)
    path = turn.orbit / largest * 0.28 * 1e3 * bearing.shape.bore
    now = turn.states[k].motion[1:3] / turn.factor / largest * 0.28 * 1e3 * bearing.shape.bore
    dots = [surfaces.ball(0.06 * size, 6, 8).moved(np.array([front, *point])) for point in path[:: max(len(path) // 90, 1)]]
    parts = [Part("orbit", surfaces.joined(dots), _ORBIT)]
    parts.append(Part("centre", surfaces.ball(0.25 * size).moved(np.array([front, *now])), _ORBIT))
    pull = np.array([0.0, *turn.force[k]])
    length = 0.3 * 1e3 * bearing.shape.bore * float(np.linalg.norm(pull)) / strongest
    if length > 0.02 * size:
        arrow = surfaces.arrow(np.array([front, *now]), pull / np.linalg.norm(pull), length, 0.18 * size)
        parts.append(Part("force", arrow, _FORCE))
    return parts


def _frame(pyvista: ModuleType, parts: list[Part], heading: str, words: str, top: float, peak: float) -> np.ndarray:
    plotter = scene.new_plotter(pyvista, _SIZE)
    scene.add_parts(pyvista, plotter, parts, top, peak)
    scene.colour_bar(pyvista, plotter, "ball load, N", scene.LOADS, top, (0.075, 0.05))
    plotter.add_text(heading, position="upper_edge", font_size=8, color=_INK)
    plotter.add_text(words, position="lower_edge", font_size=8, color=_INK)
    plotter.enable_anti_aliasing("ssaa")
    plotter.camera_position = [(1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    plotter.enable_parallel_projection()
    plotter.reset_camera()
    # One scale for all frames: what is farthest out, the arrows, changes its length.
    plotter.camera.parallel_scale = 1.0
    reach = max(float(np.abs(part.surface.points[:, 1:]).max()) for part in parts if part.name == "outer ring")
    plotter.camera.parallel_scale = 1.5 * reach
    image = np.asarray(plotter.screenshot(return_img=True))
    plotter.close()
    return image


def _gif(frames: list[np.ndarray]) -> bytes:
    from PIL import Image

    # One palette for all frames, from some of them side by side: colours then do not flicker.
    chosen = np.concatenate(frames[:: max(len(frames) // 4, 1)], axis=1)
    palette = Image.fromarray(chosen).quantize(colors=160, method=Image.Quantize.MEDIANCUT)
    pages = [Image.fromarray(frame).quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    memory = io.BytesIO()
    duration = int(1e3 * _SECONDS / len(frames))
    pages[0].save(memory, format="GIF", save_all=True, append_images=pages[1:], duration=duration, loop=0, optimize=False)
    return memory.getvalue()
