"""The pictures of one result: PNG files, on request an HTML page.  ``raceway view``."""

from __future__ import annotations

from pathlib import Path
from textwrap import wrap

import numpy as np

from raceway.framework.shown import race_words
from raceway.pipeline.result import Result
from raceway.pipeline.settle import largest_contacts
from raceway.pipeline.simulate import OnProgress
from raceway.plugins.pictures import ball_loads, orbit, save_figure
from raceway.storage.files import write_whole
from raceway.storage.tables import Tables
from raceway.studies.view.bearing import Bearing, State
from raceway.studies.view.contact_stress import write_contact_stress
from raceway.studies.view.contacts import contacts
from raceway.studies.view.fields import contacts_left_out, write_fields
from raceway.studies.view.page import view_page
from raceway.studies.view.scene import overview
from raceway.studies.view.states import at_peak, at_rest

#: File -> its path, what is seen on it, what is told below it.
Pictures = dict[str, tuple[Path, str, str]]


def draw(result: Result, folder: Path, page: bool, mesh: Path | None, on_progress: OnProgress) -> Tables:
    """Write the pictures of a result, on request its HTML page; ``files`` and what is shown on them.

    Parameters
    ----------
    mesh : a picture of it that stands there already

    Raises
    ------
    RacewayError
        A package that is missing, a folder that cannot be written.
    """

    bearing = Bearing.of(result)
    rest = at_rest(result)
    shown, when = rest, "at rest"
    if result.simulation is not None:
        shown, angle = at_peak(result)
        when = f"when a ball carries most, {angle:.0f} deg into the turn"
    pictures = _still(result, bearing, rest, (shown, when), folder, on_progress)
    if mesh is not None:
        pictures[mesh.name] = mesh, "the mesh of rings and balls", "The finite-element mesh, a sector cut away"
    fields: list[Path] = []
    if result.model.traits.every_node:
        on_progress("drawing stress.png", len(pictures), 0)
        *fields, path = write_fields(result, folder)
        told = "von Mises stress at the elements' centres, in the plane of the axis and the most loaded ball, at rest"
        told = "; ".join(filter(None, (told, contacts_left_out(result))))
        pictures["stress.png"] = path, "stress in a section of rings and ball", told
        if not result.model.traits.resultants:
            on_progress("drawing stress_contact.png", len(pictures), 0)
            for path in write_contact_stress(result, folder):
                if path.suffix == ".png":
                    told = "Stresses below the most loaded contact of each race, at rest; Hertz's depth of the largest shear stress is marked"
                    pictures[path.name] = path, "stress below the contacts, close up", told
                else:
                    fields.append(path)
    if page:
        text = {
            "title": result.title, "subtitle": _bearing_words(result), "when": when, "lead": _lead(result, shown),
            "notes": [*_notes(bearing), f"In the drawing {_widened(bearing, shown)}."],
        }  # fmt: skip
        images = [(path.read_bytes(), seen, told) for path, seen, told in pictures.values()]
        path = view_page(bearing, shown, text, images).write(folder / "view.html")
        pictures["view.html"] = path, "", ""
    return {
        "title": result.title,
        "shown": when,
        **largest_contacts(shown.load, shown.peak, "largest"),
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


def _loads(state: State) -> str:
    loads = [f"{some.min():.4g} to {some.max():.4g} N" for some in np.split(state.load, 2)]
    most = largest_contacts(state.load, state.peak, "largest")
    where = race_words(most["largest_pressure_race"])
    return f"inner race {loads[0]}, outer race {loads[1]}, pressure up to {1e-6 * most['largest_pressure_pa']:.4g} MPa ({where})"


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
