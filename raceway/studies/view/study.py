"""The pictures of one result: PNG files, on request an HTML page and an animation.  ``raceway view``."""

from __future__ import annotations

from pathlib import Path
from textwrap import wrap

import attrs

from raceway.pipeline.result import Result
from raceway.pipeline.simulate import OnProgress
from raceway.plugins.reports.pictures import ball_loads, orbit, save_figure
from raceway.storage.files import write_whole
from raceway.storage.tables import Tables
from raceway.studies.many.page import Page
from raceway.studies.view.animation import animate
from raceway.studies.view.bearing import Bearing, State
from raceway.studies.view.contact_stress import write_contact_stress
from raceway.studies.view.contacts import contacts
from raceway.studies.view.fields import write_fields
from raceway.studies.view.page import view_page
from raceway.studies.view.scene import overview
from raceway.studies.view.states import at_peak, at_rest, last_turn


@attrs.frozen
class Wanted:
    """Drawings besides the PNG files.

    Attributes
    ----------
    page : the HTML page;  frames : of the animation, 0 for none;  mesh : a picture of it that stands there already
    """

    page: bool = False
    frames: int = 0
    mesh: Path | None = None


#: A page larger than this [bytes] has its animation beside it; some room is left below the 5 MB that a page may have.
LARGEST_PAGE = 4_900_000

#: File -> its path, what is seen on it, what is told below it.
Pictures = dict[str, tuple[Path, str, str]]


def draw(result: Result, folder: Path, wanted: Wanted, on_progress: OnProgress) -> Tables:
    """Write the pictures of a result; ``files`` and what is shown on them.

    Raises
    ------
    RacewayError
        A package that is missing, a folder that cannot be written; an animation of what does not move.
    """

    turn = last_turn(result, wanted.frames) if wanted.frames else None
    bearing = Bearing.of(result)
    rest = at_rest(result)
    shown, when = rest, "at rest"
    if result.simulation is not None:
        shown, angle = at_peak(result)
        when = f"when a ball carries most, {angle:.0f} deg into the turn"
    pictures = _still(result, bearing, rest, (shown, when), folder, on_progress)
    if turn is not None:
        heading = f"{_short(result.title)}\nmotion x {turn.factor:g}"
        path = animate(
            bearing, turn, heading, folder / "orbit.gif", lambda done, total: on_progress("drawing orbit.gif", done, total)
        )
        told = f"The last turn; motions of ring and balls {turn.factor:g} times as large as they are, the orbit in the bore to fit it"
        pictures["orbit.gif"] = path, "the turning load, ball loads and orbit", told
    if wanted.mesh is not None:
        pictures[wanted.mesh.name] = wanted.mesh, "the mesh of rings and balls", "The finite-element mesh, a sector cut away"
    fields: list[Path] = []
    if result.model.traits.every_node:
        on_progress("drawing stress.png", len(pictures), 0)
        *fields, path = write_fields(result, folder)
        told = "von Mises stress at the elements' centres, in the plane of the axis and the most loaded ball, at rest"
        pictures["stress.png"] = path, "stress in a section of rings and ball", told
        if not result.model.traits.resultants:
            on_progress("drawing stress_contact.png", len(pictures), 0)
            for path in write_contact_stress(result, folder):
                if path.suffix == ".png":
                    told = "Stresses below the most loaded contact of each race, at rest; Hertz's depth of the largest shear stress is marked"
                    pictures[path.name] = path, "stress below the contacts, close up", told
                else:
                    fields.append(path)
    if wanted.page:
        text = {
            "title": result.title, "subtitle": _bearing_words(result), "when": when, "lead": _lead(result, shown),
            "notes": [*_notes(bearing), f"In the drawing {_widened(bearing, shown)}."],
        }  # fmt: skip
        path = _page(bearing, shown, text, pictures).write(folder / "view.html")
        pictures["view.html"] = path, "", ""
    z = result.model.system.ball_count
    return {
        "title": result.title,
        "shown": when,
        "largest_ball_load_n": float(shown.load[:z].max()),
        "largest_pressure_pa": float(shown.peak.max()),
        "exaggeration": None if turn is None else turn.factor,
        "assumed": list(bearing.assumed),
        "warnings": list(result.warnings),
        "files": [str(path) for path in (*(path for path, _, _ in pictures.values()), *fields)],
    }


def _still(
    result: Result, bearing: Bearing, rest: State, peak: tuple[State, str], folder: Path, on_progress: OnProgress
) -> Pictures:
    """Pictures of single states, at rest and when a ball carries most, and of the whole record."""
    from raceway.studies.view.mesh_picture import _png

    shown, when = peak
    states = {"bearing.png": (rest, "at rest")} | ({"bearing-peak.png": (shown, when)} if shown is not rest else {})
    pictures: Pictures = {}
    for name, (state, words) in states.items():
        on_progress(f"drawing {name}", len(pictures), 0)
        path = write_whole(
            _png(overview(bearing, state, f"{_short(result.title)}\n{words}: {_loads(state)}\n{_widened(bearing, state)}")),
            folder / name,
        )
        pictures[name] = (
            path,
            f"the bearing cut open, balls coloured by their load, {words}",
            f"Loads {words}: {_loads(state)}; {_widened(bearing, state)}",
        )
    on_progress("drawing contacts.png", len(pictures), 0)
    path = save_figure(contacts(bearing, shown, f"{_short(result.title)}, {when}"), folder / "contacts.png", 110)
    told = f"Section and contact ellipses of the most loaded ball {when}; Hertz's pressure"
    pictures["contacts.png"] = path, "section of the rings with the ball, and its two contact ellipses", told
    path = save_figure(ball_loads(result), folder / "ball-loads.png", 110)
    pictures["ball-loads.png"] = path, "ball loads by azimuth", "Ball loads on the inner race by azimuth"
    if result.simulation is not None:
        path = save_figure(orbit(result), folder / "orbit.png", 110)
        pictures["orbit.png"] = path, "orbit of the inner ring", "Orbit of the inner ring's reference point"
    return pictures


def _page(bearing: Bearing, state: State, text: Tables, pictures: Pictures) -> Page:
    """The page with all pictures, the animation among them where it has room."""
    images = {name: (path.read_bytes(), seen, told) for name, (path, seen, told) in pictures.items()}
    page = view_page(bearing, state, text, list(images.values()))
    if "orbit.gif" not in images or len(page.html().encode()) <= LARGEST_PAGE:
        return page
    note = f"orbit.gif, {1e-6 * len(images.pop('orbit.gif')[0]):.1f} MB, is too large for this page and lies beside it; fewer `--frames` bring it in."
    return view_page(bearing, state, {**text, "notes": [*text["notes"], note]}, list(images.values()))


def _loads(state: State) -> str:
    inner = state.load[: len(state.azimuth)]
    return f"balls {inner.min():.4g} to {inner.max():.4g} N, pressure up to {1e-6 * state.peak.max():.4g} MPa"


def _widened(bearing: Bearing, state: State) -> str:
    factor = bearing.widening(state)
    return "contact ellipses are to scale" if factor == 1 else f"contact ellipses are {factor} times as large as they are"


def _bearing_words(result: Result) -> str:
    b, scene = result.model.scene.bearing, result.model.scene
    name = f"{b.preset}: " if b.preset else ""
    return (
        f"{name}{b.ball_count} balls of {1e3 * b.ball_diameter:.4g} mm on {1e3 * b.pitch_diameter:.4g} mm, contact angle "
        f"{scene.bearing.contact_angle * 57.29577951308232:.4g} deg; {scene.bodies.name} bodies, tilt {scene.supports.tilt}"
    )


def _lead(result: Result, state: State) -> str:
    load, found = result.model.scene.load, result.identification
    words = [f"Axial load {load.axial:.4g} N"]
    if any(load.radial):
        words.append(f"radial load {load.radial[0]:.4g}, {load.radial[1]:.4g} N along y, z")
    if found is not None:
        words.append(
            f"{result.model.excitation.name} force of {found.force_amplitude:.4g} N at {60.0 * found.frequency_hz:.6g} r/min, "
            f"K = {1e-6 * found.equivalent_stiffness:.4g} N/µm"
        )
    words.append(f"axial displacement {1e6 * result.equilibrium.displacement[0]:.4g} µm")
    words.append(_loads(state))
    return f"{'; '.join(words)}."


def _notes(bearing: Bearing) -> list[str]:
    notes = [f"{text[0].upper()}{text[1:]}." for text in bearing.result.warnings]
    if bearing.assumed:
        notes.append(f"The scene does not give {', '.join(bearing.assumed)} of the rings: usual proportions are drawn.")
    return notes


def _short(title: str) -> str:
    return "\n".join(part for line in title.splitlines() for part in wrap(line, 70))
