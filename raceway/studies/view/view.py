"""The pictures of a bearing, for Python and the command line alike: ``raceway.view``."""

from __future__ import annotations

import base64
import io
import tempfile
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.bodies.mesh import mesh_scene
from raceway.errors import RacewayError, SceneError, extra
from raceway.framework.doors import door
from raceway.framework.duties import traits_of
from raceway.framework.registry import registry_with
from raceway.framework.shown import Fact, Shown, largest_facts, race_words
from raceway.out.progress import ShowProgress, telling
from raceway.pipeline.equilibrium import equilibrium_table, largest_contacts
from raceway.pipeline.result import Result
from raceway.pipeline.run import run
from raceway.pipeline.simulate import OnProgress
from raceway.plugins.pictures import given_axes, picture, save_figure
from raceway.plugins.system_libraries import refuse_pictures
from raceway.scene.inputs import as_scene
from raceway.storage.files import writable, write_whole
from raceway.storage.tables import Tables
from raceway.studies.view.bodies import Bearing, State
from raceway.studies.view.mesh import draw as draw_mesh
from raceway.studies.view.page import view_page
from raceway.studies.view.pictures import contacts, overview, png
from raceway.studies.view.stress import contacts_left_out, write_contact_stress, write_fields

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from raceway.bodies.model import Model


@attrs.frozen(eq=False, repr=False, slots=False)
class View(Shown):
    """Pictures of one bearing.

    Attributes
    ----------
    content : what is shown: the largest load [N] and pressure [Pa], warnings
    pictures : name -> content of the file

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.view({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}})
    >>> found.pictures["bearing.png"][:4], found.files
    (b'\\x89PNG', [])
    """

    content: Tables
    pictures: dict[str, bytes]

    @property
    def files(self) -> list[Path]:
        """What was written; empty where no folder was given."""
        return [Path(name) for name in self.content["files"]]

    def save(self, folder: str | Path) -> list[Path]:
        """Write all pictures into a folder.

        Raises
        ------
        RacewayError
            A folder that cannot be written.
        """
        return [write_whole(content, Path(folder) / name) for name, content in self.pictures.items()]

    def to_dict(self) -> Tables:
        """What is shown, as plain tables; the pictures by their files."""
        return dict(self.content)

    def plot(self, name: str = "bearing.png", ax: Axes | None = None) -> Axes:
        """Put one picture on matplotlib axes.

        Parameters
        ----------
        name : of a PNG file among ``pictures``
        ax : axes; new ones without

        Raises
        ------
        SceneError
            No such picture.
        """
        known = [one for one in self.pictures if one.endswith(".png")]
        if name not in known:
            raise SceneError.at("name", name, f"must be one of {', '.join(known)}")
        from matplotlib.image import imread

        axes = given_axes(ax, 8.0, 6.0)
        axes.imshow(imread(io.BytesIO(self.pictures[name])))
        axes.set_axis_off()
        return axes

    def _shown(self) -> tuple[str, list[Fact]]:
        shown = self.content
        facts = [*largest_facts(shown, shown["shown"]), ("pictures", "", ", ".join(self.pictures))]
        where = [("written", "", str(path)) for path in self.files] or [("in memory", "", "save(folder) writes them")]
        return shown["title"], [*facts, *where, *(("warning", "", text) for text in shown["warnings"])]

    def _repr_html_(self) -> str:
        image = base64.b64encode(self.pictures["bearing.png"]).decode()
        picture = f'<img style="max-width:100%" alt="the bearing cut open" src="data:image/png;base64,{image}"/>'
        return f"{picture}{super()._repr_html_()}"


#: Moments of a turn among which the peak is looked for.
_EVERY = 360


def at_rest(result: Result) -> State:
    """The static state, with the numbers of result.json."""
    found, model = result.equilibrium, result.model
    balls = equilibrium_table(model, found)["balls"]

    def column(name: str) -> np.ndarray:
        return np.array([ball[name.format(race)] for race in ("inner", "outer") for ball in balls])

    half = np.column_stack([column("semi_major_{}_m"), column("semi_minor_{}_m")])
    angle = np.r_[found.angle_inner, found.angle_outer]
    return State(model.azimuth, column("load_{}_n"), angle, half, column("peak_pressure_{}_pa"), np.zeros(5))


def at_peak(result: Result) -> tuple[State, float]:
    """The moment of the last turn when a ball carries most on either race, and how far the turn is by then [deg].

    Raises
    ------
    SceneError
        A result without motion.
    """
    if result.simulation is None:
        message = "nothing moves in this scene: give it the table [excitation], and an identifier that looks at motion"
        raise SceneError.at("excitation", None, message)
    record, model = result.simulation.record, result.model
    per_turn = max(record.schedule.steps_per_turn // record.schedule.stride, 1)
    first = max(len(record.time) - per_turn, 0)
    chosen = first + np.unique(np.linspace(0, len(record.time) - first, _EVERY, endpoint=False).astype(int))
    k = int(chosen[np.argmax(record.contact_force[chosen].max(axis=1))])
    z, load, t = model.system.ball_count, record.contact_force[k], float(record.time[k])
    now = attrs.evolve(model, system=model.system.at_speed(t))
    angle = np.concatenate(now.bearing.contact_angles(now, record.displacement[k], record.ball[k], load, t))
    halves, peaks = zip(*(_ellipse(now, race, part) for race, part in enumerate((load[:z], load[z:]))), strict=True)
    direction = now.system.centre_vectors(record.displacement[k], t)[1]
    azimuth = np.arctan2(direction[:, 1], direction[:, 0])
    state = State(azimuth, load, angle, np.concatenate(halves), np.concatenate(peaks), np.zeros(5))
    return state, 360.0 * (k - first) / per_turn


def _ellipse(model: Model, race: int, load: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Semi-axes (n, 2) [m] and largest pressure (n,) [Pa]."""
    pressure, major, minor = model.bearing.contact_ellipse(model, race, load)
    return np.column_stack([major, minor]), pressure


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
    shown, when = peak
    states = {"bearing.png": (rest, "at rest")} | ({"bearing-peak.png": (shown, when)} if shown is not rest else {})
    pictures: Pictures = {}
    for name, (state, words) in states.items():
        on_progress(f"drawing {name}", len(pictures), 0)
        path = write_whole(
            png(overview(bearing, state, f"{_short(result.title)}\n{words}: {_loads(state)}\n{_widened(bearing, state)}")),
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
    path = save_figure(picture(result, "ball_loads"), folder / "ball-loads.png", 110)
    pictures["ball-loads.png"] = path, "ball loads by azimuth", "Ball loads on the inner race by azimuth"
    if result.simulation is not None:
        path = save_figure(picture(result, "orbit"), folder / "orbit.png", 110)
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


@door
def view(
    scene: Any,
    out: str | Path | None = None,
    *,
    page: bool = False,
    plugins: Iterable[str | Path] = (),
    progress: ShowProgress = None,
) -> View:
    """Draw a bearing: cut open with its ball loads, contact ellipses, ball loads by azimuth, the orbit, the mesh.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables, which is run first; or the Result of a run
    out : folder of the pictures; None: they are kept in memory
    page : also view.html, the bearing to turn about with all pictures, which opens without a network
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    View
        ``pictures`` by name, the ``files`` where a folder is given; a notebook shows the bearing

    Raises
    ------
    SceneError
        A mistake in the scene.
    RacewayError
        pyvista or matplotlib is missing, or a system library of theirs; a folder that cannot be written.

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.view({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}})
    >>> sorted(found.pictures)
    ['ball-loads.png', 'bearing.png', 'contacts.png']
    """
    given = scene if isinstance(scene, Result) else as_scene(scene, plugins=plugins)
    read = given.model.scene if isinstance(given, Result) else given
    folder = None if out is None else writable(Path(out))
    for package in ("pyvista", "matplotlib"):
        if find_spec(package) is None:
            raise RacewayError(f"pictures need {package}: {extra('view')}")
    refuse_pictures()
    with tempfile.TemporaryDirectory(prefix="raceway-view-") as temporary, telling(progress) as told:
        result = given if isinstance(given, Result) else run(given, registry_with(plugins), told)
        place = Path(temporary) if folder is None else folder
        mesh = None
        if traits_of(read).every_node:
            mesh = draw_mesh(mesh_scene(read), f"{read.title}\nthe mesh", place / "mesh.png")
        content = draw(result, place, page, mesh, told)
        pictures = {Path(name).name: Path(name).read_bytes() for name in content["files"]}
        return View(content if folder is not None else {**content, "files": []}, pictures)
