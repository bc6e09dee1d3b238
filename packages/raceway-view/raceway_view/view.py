"""The pictures of a bearing, for Python and the command line alike: ``raceway.view``."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import attrs
import numpy as np

from raceway import Answer, Result, SceneError, door
from raceway.extend import (
    PATH, PATHS, Fact, K, OnProgress, Part, ShowProgress, Tables, Words, X, as_scene, equilibrium_table, figure_png,
    given_axes, largest_contacts, largest_facts, mesh_bodies, picture, quantity_rows, race_words,
    registry_with, run, sections, stated, telling, wrapped, writable, write_whole,
)  # fmt: skip
from raceway_view.bodies import BearingSolids, Snapshot
from raceway_view.mesh import mesh_picture
from raceway_view.page import view_page
from raceway_view.pictures import contacts, overview
from raceway_view.stress import contact_stress_files, contacts_left_out, field_files
from raceway_view.system_libraries import refuse_pictures

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@attrs.frozen(eq=False, repr=False, slots=False)
class View(Answer):
    """Pictures of one bearing.

    Attributes
    ----------
    content : what is shown: the largest load [N] and pressure [Pa], warnings; the files that ``save`` wrote
    pictures : name -> content of the file

    Examples
    --------
    >>> import raceway as rw
    >>> view = rw.view({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}})
    >>> view.pictures["bearing.png"][:4], view.files
    (b'\\x89PNG', [])
    """

    stem: ClassVar[str] = "view"

    content: Tables
    pictures: dict[str, bytes]

    @property
    def files(self) -> list[Path]:
        """What was written; empty where no folder was given."""
        return [Path(name) for name in self.content["files"]]

    @door
    def save(self, folder: Annotated[str | Path, PATH], pictures: bool | str = True) -> list[Path]:
        """Write all pictures into a folder, and nothing else.

        Raises
        ------
        RacewayError
            A folder that cannot be written.
        """
        files = [write_whole(content, Path(folder) / name) for name, content in self.pictures.items()]
        self.content["files"] = [str(file) for file in files]
        return files

    def to_dict(self) -> Tables:
        """What is shown, as plain tables; the pictures by their files."""
        return dict(self.content)

    @door
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
        names = [file for file in self.pictures if file.endswith(".png")]
        if name not in names:
            raise SceneError.at("name", name, f"must be one of {', '.join(names)}")
        from matplotlib.image import imread

        axes = given_axes(ax, 8.0, 6.0)
        axes.imshow(imread(io.BytesIO(self.pictures[name])))
        axes.set_axis_off()
        return axes

    def _facts(self) -> tuple[str, list[Fact]]:
        content = self.content
        facts = [*largest_facts(content, content["shown"]), ("pictures", "", ", ".join(self.pictures))]
        where = [("written", "", str(path)) for path in self.files] or [("in memory", "", "save(folder) writes them")]
        return content["title"], [*facts, *where, *(("warning", "", text) for text in content["warnings"])]

    def report(self) -> Iterator[Part]:
        content = self.content
        rows: list[Fact] = [(f"Pictures {content['shown']}", "", ""), *largest_facts(content, content["shown"])]
        if content["assumed"]:
            rows.append(("rings drawn with usual", "", f"{', '.join(content['assumed'])}: the scene does not say"))
        yield Words(content["title"], "bold")
        yield sections(rows)
        yield from (Words(f"note: {text}", "yellow") for text in content["warnings"])

    def _repr_html_(self) -> str:
        image = base64.b64encode(self.pictures["bearing.png"]).decode()
        picture = f'<img style="max-width:100%" alt="the bearing cut open" src="data:image/png;base64,{image}"/>'
        return f"{picture}{super()._repr_html_()}"


#: Resolution of the PNG files.
_DOTS_PER_INCH = 110
#: Moments of a turn among which the peak is looked for.
_EVERY = 360


def at_rest(result: Result) -> Snapshot:
    """The static state, with the numbers of result.json."""
    equilibrium, model = result.equilibrium, result.model
    balls = equilibrium_table(model, equilibrium)["balls"]

    def column(name: str) -> np.ndarray:
        return np.array([ball[name.format(race)] for race in ("inner", "outer") for ball in balls])

    half = np.column_stack([column("semi_major_{}_m"), column("semi_minor_{}_m")])
    angle = np.r_[equilibrium.angle_inner, equilibrium.angle_outer]
    return Snapshot(model.azimuth, column("load_{}_n"), angle, half, column("peak_pressure_{}_pa"), np.zeros(5))


def at_peak(result: Result) -> tuple[Snapshot, float]:
    """The moment of the last turn when a ball carries most on either race, and how far the turn is by then [deg].

    SceneError: a result without motion.
    """
    if result.simulation is None:
        message = "no motion in this scene: add a table [excitation], and an identifier of motions"
        raise SceneError.at("excitation", None, message)
    record, model = result.simulation.record, result.model
    per_turn = max(record.schedule.steps_per_turn // record.schedule.stride, 1)
    first = max(len(record.time) - per_turn, 0)
    samples = first + np.unique(np.linspace(0, len(record.time) - first, _EVERY, endpoint=False).astype(int))
    k = int(samples[np.argmax(record.contact_force[samples].max(axis=1))])
    z, load, t = model.system.ball_count, record.contact_force[k], float(record.time[k])
    now = attrs.evolve(model, system=model.system.at_speed(t))
    angle = np.concatenate(now.bearing.contact_angles(now, record.displacement[k], record.ball[k], load, t))
    ellipses = [now.bearing.contact_ellipse(now, race, part) for race, part in enumerate((load[:z], load[z:]))]
    peaks, *axes = map(np.concatenate, zip(*ellipses, strict=True))
    direction = now.system.centre_vectors(record.displacement[k], t)[1]
    azimuth = np.arctan2(direction[:, 1], direction[:, 0])
    state = Snapshot(azimuth, load, angle, np.column_stack(axes), peaks, np.zeros(5))
    return state, 360.0 * (k - first) / per_turn


@attrs.frozen
class _Image:
    """Content of a PNG file, what is seen on it, and its caption."""

    content: bytes
    alternative: str
    caption: str


def _draw(result: Result, page: bool, on_progress: OnProgress) -> tuple[Tables, dict[str, bytes]]:
    """What is shown of a result, and the files by name: pictures, on request the HTML page, fields of elastic bodies.

    RacewayError: a package that is missing.
    """
    bearing = BearingSolids.of(result)
    moments = {"bearing.png": (at_rest(result), "at rest")}
    if result.simulation is not None:
        state, angle = at_peak(result)
        moments["bearing-peak.png"] = state, f"when a ball carries most, {angle:.0f} deg into the turn"
    state, when = list(moments.values())[-1]
    images = dict(_images(result, bearing, moments, on_progress))
    fields: dict[str, bytes] = {}
    if result.model.traits.every_node:
        mesh = mesh_picture(mesh_bodies(result.model.problem), f"{result.title}\nthe mesh")
        images["mesh.png"] = _Image(mesh, "the mesh of rings and balls", "The finite-element mesh, a sector cut away")
        fields = _stresses(result, images, on_progress)
    files = {name: image.content for name, image in images.items()}
    if page:
        b, problem = result.model.problem.bearing, result.model.problem
        subtitle = (
            f"{f'{b.preset}: ' if b.preset else ''}{b.ball_count} balls of {1e3 * b.ball_diameter:.4g} mm on {1e3 * b.pitch_diameter:.4g} mm, "
            f"contact angle {b.contact_angle * 57.29577951308232:.4g} deg; {problem.bodies.name} bodies, tilt {problem.supports.tilt}"
        )
        load, identification = result.model.problem.load, result.identification
        lead = [f"Axial load {load.axial:.4g} N"]
        if any(load.radial):
            lead.append(f"radial load {load.radial[0]:.4g}, {load.radial[1]:.4g} N along y, z")
        if identification is not None:
            _, value, interval = stated(K, {"uncertainty": result.uncertainty})
            lead.append(
                f"{result.model.excitation.name} force of {identification.force_amplitude:.4g} N at {60.0 * identification.frequency_hz:.6g} r/min, "
                f"K = {value} {interval.partition(':')[0]}".rstrip()
            )
        lead.append(f"axial displacement {X.text(X.of(result), 4)}")
        lead.append(_loads(state))
        words = {
            "title": result.title, "subtitle": subtitle, "when": when, "lead": f"{'; '.join(lead)}.",
            "notes": [*_notes(bearing), f"In the drawing {_scale_words(bearing, state)}."], "quantities": quantity_rows(result.to_dict()),
        }  # fmt: skip
        pictures = [(image.content, image.alternative, image.caption) for image in images.values()]
        files["view.html"] = view_page(bearing, state, words, pictures).html().encode()
    content: Tables = {
        "title": result.title,
        "shown": when,
        **largest_contacts(state.load, state.peak, "largest"),
        "assumed": list(bearing.assumed),
        "warnings": list(result.warnings),
        "files": [],
    }
    return content, files | fields


def _images(
    result: Result, bearing: BearingSolids, moments: dict[str, tuple[Snapshot, str]], on_progress: OnProgress
) -> Iterator[tuple[str, _Image]]:
    """The bearing at rest and when a ball carries most, the contacts then, and what the whole record draws."""
    title = wrapped(result.title, 70)
    for name, (state, when) in moments.items():
        on_progress(f"drawing {name}", 0, 0)
        loads, scale_words = _loads(state), _scale_words(bearing, state)
        content = overview(bearing, state, wrapped(f"{result.title}\n{when}: {loads}\n{scale_words}", 72))
        alternative = f"the bearing cut open, balls coloured by their load, {when}"
        yield name, _Image(content, alternative, f"Loads {when}: {loads}; {scale_words}")
    on_progress("drawing contacts.png", 0, 0)
    state, when = list(moments.values())[-1]
    content = figure_png(contacts(bearing, state, f"{title}, {when}"), _DOTS_PER_INCH)
    alternative = "section of the rings with the ball, and its two contact ellipses"
    caption = f"Section and contact ellipses of the most loaded ball {when}; Hertz's pressure"
    yield "contacts.png", _Image(content, alternative, caption)
    for name, alternative, caption in (
        ("ball_loads", "ball loads by azimuth", "Ball loads on the inner race by azimuth"),
        ("orbit", "orbit of the inner ring", "Orbit of the inner ring's reference point"),
    )[: len(moments)]:  # at rest there is no orbit
        content = figure_png(picture(result, name), _DOTS_PER_INCH)
        yield f"{name.replace('_', '-')}.png", _Image(content, alternative, caption)


def _stresses(result: Result, images: dict[str, _Image], on_progress: OnProgress) -> dict[str, bytes]:
    """Files of the fields of elastic bodies; their pictures are added to the images."""
    on_progress("drawing stress.png", 0, 0)
    files = field_files(result)
    caption = "von Mises stress at the elements' centres, in the plane of the axis and the most loaded ball, at rest"
    caption = "; ".join(filter(None, (caption, contacts_left_out(result))))
    images["stress.png"] = _Image(files.pop("stress.png"), "stress in a section of rings and ball", caption)
    if result.model.traits.resultants:
        return files
    on_progress("drawing stress_contact.png", 0, 0)
    files |= contact_stress_files(result)
    if "stress_contact.png" in files:
        caption = "Stresses below the most loaded contact of each race, at rest; Hertz's depth of the largest shear stress is marked"
        content = files.pop("stress_contact.png")
        images["stress_contact.png"] = _Image(content, "stress below the contacts, close up", caption)
    return files


def _loads(state: Snapshot) -> str:
    loads = [f"{race.min():.4g} to {race.max():.4g} N" for race in np.split(state.load, 2)]
    most = largest_contacts(state.load, state.peak, "largest")
    where = race_words(most["largest_pressure_race"])
    return f"inner race {loads[0]}, outer race {loads[1]}, pressure up to {1e-6 * most['largest_pressure_pa']:.4g} MPa ({where})"


def _scale_words(bearing: BearingSolids, state: Snapshot) -> str:
    factor = bearing.widening(state)
    return "contact ellipses are to scale" if factor == 1 else f"contact ellipses are enlarged {factor} times"


def _notes(bearing: BearingSolids) -> list[str]:
    notes = [f"{text[0].upper()}{text[1:]}." for text in bearing.result.warnings]
    if bearing.assumed:
        notes.append(f"The scene does not give {', '.join(bearing.assumed)} of the rings: usual proportions are drawn.")
    return notes


@door
def view(
    scene: Any,
    out: Annotated[str | Path | None, PATH] = None,
    *,
    page: bool = False,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
    progress: ShowProgress = None,
) -> View:
    """Compute one scene and draw it: ball loads on the bearing cut open, contact ellipses with pressure, ball loads over
    azimuth, orbit, mesh of elastic bodies. Needs no display.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables, which is run first; or the Result of a run
    out : folder of the pictures; None: they stay in memory
    page : also write view.html, which works offline: the bearing in 3D, tables, all pictures
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
    >>> view = rw.view({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}})
    >>> sorted(view.pictures)
    ['ball-loads.png', 'bearing.png', 'contacts.png']
    """
    source = scene if isinstance(scene, Result) else as_scene(scene, plugins=plugins)
    folder = None if out is None else writable(Path(out))
    refuse_pictures()
    with telling(progress) as on_progress:
        result = source if isinstance(source, Result) else run(source, registry_with(plugins), on_progress)
        content, pictures = _draw(result, page, on_progress)
        answer = View(content, pictures)
        if folder is not None:
            answer.save(folder)
        return answer
