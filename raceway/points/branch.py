"""A branch of steady orbits over a key: each orbit in numbers, special points, and the curve as tables and files."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np

from raceway.answers.answer import Answer, Part
from raceway.answers.picture import Plot
from raceway.answers.quantities import read_in
from raceway.answers.table import Words
from raceway.core.periodic.branch import Branch, Point
from raceway.core.periodic.collocation import Solved
from raceway.core.periodic.intervals import Change, spread
from raceway.core.periodic.refinement import displacements, states
from raceway.core.periodic.steady import synchronous_response
from raceway.core.ring.kernels.layout import DAMPING, TIME_CONSTANT
from raceway.core.ring.orbit import States, responses
from raceway.errors import ConvergenceError
from raceway.framework.shown import Fact
from raceway.points.attractor import Attractor
from raceway.points.axes import axis_label
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from matplotlib.figure import Figure


#: Samples a turn: harmonics up to this order alias nothing.
_SAMPLES = 360
#: Samples of a span at which contacts are looked at.
_CONTACTS = 72
#: Special points and peaks that a screen shows at most; all are in the file.
_SHOWN = 24
#: Step of the difference quotient along the branch, over the motion's size.
_ALONG = 1e-4
#: Multipliers are outside the unit circle from here on.
_OUTSIDE = 1.0 + 1e-6
#: Kinds of labels beside the special points: a local maximum of the swing, a first contact that opens on the way.
PEAK, OPENS = "peak", "contact opens"

#: Kind of a label -> mark.
_MARKS = {"fold": "s", "branch point": "D", "period doubling": "^", "Neimark-Sacker": "o", OPENS: "x", PEAK: "+"}
#: Numbers that are drawn: name -> label.
_DRAWN = {"swing": "amplitude [µm]", "stiffness": "K [N/µm]"}
#: Sections that are drawn, and peaks that are labelled, the highest, at most.
_SECTIONS, _PEAKS = 4, 6

#: Name of a number -> (unit, words).
_COLUMNS: dict[str, tuple[str, str]] = {
    "parameter": ("", "value of the key"),
    "arc": ("1", "length along the branch, in tenths of the range and sizes of the first orbit"),
    "speed": ("rad/s", "of the force"),
    "z_real": ("N/m", "real part of Z = F/x of the 1x component"),
    "z_imag": ("N/m", "imaginary part of Z"),
    "stiffness": ("N/m", "K = Re Z + m w^2"),
    "damping": ("N s/m", "C = Im Z / w"),
    "amplitude": ("m", "major semi-axis of the 1x orbit"),
    "phase_deg": ("deg", "lag of the displacement behind the force"),
    "swing": ("m", "sqrt 2 times the rms of the displacement about its mean: the amplitude of all harmonics together"),
    "multiplier": ("1", "growth of the least damped disturbance per turn"),
    "unstable": ("1", "number of multipliers outside the unit circle"),
    "lost": ("1", "largest number of inner contacts open at once"),
    "error": ("1", "estimated error of the orbit over its size"),
}


@attrs.frozen
class Orbit:
    """Numbers of ``_COLUMNS``, the verdict "stable", "neutral" or "unstable", and how the orbit is left: "", "+1", "-1", "pair".

    z : dynamic stiffness F/x of the 1x component [N/m];  mass : m of K = Re Z + m w^2 [kg]
    """

    parameter: float
    arc: float
    speed: float
    z: complex
    mass: float
    amplitude: float
    swing: float
    multiplier: float
    unstable: int
    lost: int
    error: float
    verdict: str
    leaves_by: str

    @property
    def stiffness(self) -> float:
        """K [N/m]."""
        return self.z.real + self.mass * self.speed**2

    @property
    def damping(self) -> float:
        """C [N s/m]."""
        return self.z.imag / self.speed

    @property
    def phase_deg(self) -> float:
        """Lag of the displacement behind the force [deg]."""
        return float(np.degrees(np.angle(self.z)))

    def to_dict(self) -> Tables:
        parts = {"z_real": self.z.real, "z_imag": self.z.imag}
        names = (*_COLUMNS, "verdict", "leaves_by")
        return {name: parts[name] if name in parts else getattr(self, name) for name in names}


@attrs.frozen
class Label:
    """A special point or a peak: its kind and its orbit.

    kind : "fold", "branch point", "period doubling", "Neimark-Sacker", PEAK or OPENS
    angle : of the critical pair over a span [rad];  point : of the branch, of special points
    """

    kind: str
    row: Orbit
    angle: float | None = None
    point: Point | None = attrs.field(default=None, eq=False, repr=False)

    def to_dict(self) -> Tables:
        return {"kind": self.kind, "angle_rad": self.angle, **self.row.to_dict()}


@attrs.define(eq=False, repr=False)
class Followed(Answer):
    """The branch of steady orbits over a key of a scene.

    Attributes
    ----------
    key : of the scene, followed from ``first`` towards ``last``;  span_deg : that the orbits repeat themselves after
    rows : orbits in the order of the branch;  labels : special points and peaks
    end : why it ends before ``last``; "" where it reaches it
    notes : what a user should know;  worst : the most unstable orbit of each unstable stretch
    doubled : branches of twice the period;  attractors : motions reached from beside the orbits ``worst``;  unit : of the key

    Examples
    --------
    >>> import raceway as rw
    >>> curve = rw.follow("examples/folds.toml", "excitation.speed_rpm=19000:20000")
    >>> curve.labels[0].kind, round(curve.labels[0].row.parameter)
    ('fold', 19574)
    """

    stem: ClassVar[str] = "follow"

    key: str
    first: float
    last: float
    span_deg: float
    title: str
    rows: list[Orbit] = attrs.field(factory=list)
    labels: list[Label] = attrs.field(factory=list)
    end: str = ""
    notes: list[str] = attrs.field(factory=list)
    worst: list[Point] = attrs.field(factory=list, repr=False)
    doubled: list[Followed] = attrs.field(factory=list)
    attractors: list[Attractor] = attrs.field(factory=list)
    unit: str = ""

    @property
    def unstable(self) -> list[tuple[Orbit, Orbit]]:
        """Ends of the stretches of unstable orbits in the order of the branch, at special points where such are known."""
        stretches: list[tuple[Orbit, Orbit]] = []
        special = [label.row for label in self.labels if label.kind not in (PEAK, OPENS)]
        before: Orbit | None = None
        for row in self.rows:
            between = [point for point in special if before is not None and before.arc < point.arc < row.arc]
            was = before is not None and before.verdict == "unstable"
            if row.verdict == "unstable":
                first = stretches.pop()[0] if was else (between or [row])[0]
                stretches.append((first, row))
            elif was and between:
                stretches[-1] = (stretches[-1][0], between[-1])
            before = row
        return stretches

    def to_dict(self) -> Tables:
        """Everything, as plain tables for JSON."""
        return {
            **{name: getattr(self, name) for name in ("title", "key", "first", "last", "span_deg")},
            "columns": {name: {"unit": unit, "what": words} for name, (unit, words) in _COLUMNS.items()},
            "rows": [row.to_dict() for row in self.rows],
            "labels": [label.to_dict() for label in self.labels],
            "unstable": [[first.parameter, last.parameter] for first, last in self.unstable],
            "end": self.end,
            "notes": self.notes,
            "instead": [attractor.to_dict() for attractor in self.attractors],
            "doubled": [branch.to_dict() for branch in self.doubled],
        }

    def texts(self, pictures: bool) -> dict[str, str]:
        """follow.csv, a line an orbit."""
        content, text = self.to_dict(), io.StringIO()
        rows = [{"branch": k, **row} for k, branch in enumerate((content, *content["doubled"])) for row in branch["rows"]]
        table = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
        return {"csv": text.getvalue()}

    def draw(self) -> Figure:
        """Amplitude and K over the key, special points and peaks; below them sections of what is met beside unstable orbits."""
        from raceway.answers.picture import GREY, label_axes, new_figure, wrapped

        branches = (self, *self.doubled)
        sections = [one for branch in branches for one in branch.attractors if len(one.section)][:_SECTIONS]
        figure = new_figure(9.0, 10.0 if sections else 7.4)
        places = figure.add_gridspec(3 if sections else 2, max(len(sections), 1))
        upper = figure.add_subplot(places[0, :])
        lower = figure.add_subplot(places[1, :], sharex=upper)
        for axes, (name, label) in zip((upper, lower), _DRAWN.items(), strict=True):
            _panel(branches, name, label, axis_label(self.key, self.unit) if axes is lower else "").draw(axes)
        peaks = sorted((label.row for label in self.labels if label.kind == PEAK), key=lambda row: -row.swing)[:_PEAKS]
        for row in peaks:
            words = f"{row.parameter:.6g}\n{1e6 * row.swing:.4g} µm"
            upper.annotate(
                words, (row.parameter, 1e6 * row.swing), (0, 6), textcoords="offset points", ha="center", fontsize=9
            )
        for k, one in enumerate(sections):
            panel, (y, velocity) = figure.add_subplot(places[2, k]), 1e6 * np.array(one.section).T
            panel.plot(y, velocity, ".", markersize=3, color=GREY)
            label_axes(panel, f"{one.parameter:.6g}: {one.kind}", "y once per turn [µm]", "velocity / w [µm]", 9.5)
        handles = dict(zip(*reversed(upper.get_legend_handles_labels()), strict=True))
        figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=4, frameon=False, fontsize=9.5)
        figure.suptitle(wrapped(self.title.partition("\n")[0]), fontsize=11)
        return figure

    def _facts(self) -> tuple[str, list[Fact]]:
        ends = [
            (word, f"{row.parameter:.6g}", f"K {1e-6 * row.stiffness:.4g} N/µm")
            for word, row in zip(("begins", "ends"), (*self.rows[:1], *self.rows[-1:]), strict=False)
        ]
        special = [(label.kind, f"{label.row.parameter:.6g}", "") for label in self.labels]
        return f"{len(self.rows)} steady orbits over {self.key}\n{self.title.splitlines()[0]}", [*ends, *special]

    def report(self) -> Iterator[Part]:
        """What was followed, the special points and peaks, the stretches of unstable orbits, how it ends."""
        yield Words(f"{len(self.rows)} steady orbits over {self.key}, {_range(self)}", "bold")
        yield Words(self.title, "dim")
        labels = ((label.kind, label.row) for label in self.labels[:_SHOWN])
        points = [("begins", self.rows[0]), *labels, ("ends", self.rows[-1])]
        yield [_line(what, row) for what, row in points]
        if len(self.labels) > _SHOWN:
            yield f"{len(self.labels) - _SHOWN} more special points and peaks are in the file"
        for first, last in self.unstable:
            yield f"unstable from {first.parameter:.6g} to {last.parameter:.6g} along the branch"
        for k, branch in enumerate(self.doubled, 1):
            yield f"branch {k} of twice the period: {len(branch.rows)} orbits, {_range(branch)}"
        for attractor in (a for branch in (self, *self.doubled) for a in branch.attractors):
            yield f"beside the unstable orbit at {attractor.parameter:.6g}: {attractor.words}"
        yield from self.notes
        if self.end:
            yield Words(self.end, "bold")


def _panel(branches: Sequence[Followed], name: str, label: str, x: str) -> Plot:
    """A quantity over the key, each branch in pieces of one verdict, up to the first point of the next one, and its labels."""
    from raceway.answers.picture import COLOURS, Line, Plot

    def curve(rows: Sequence[Orbit], words: str, **style: object) -> Line:
        factor, numbers = read_in(1.0, _COLUMNS[name][0])[0], [(row.parameter, getattr(row, name)) for row in rows]
        x, y = np.array(numbers).T
        return Line(x, factor * y, words, style=style)

    curves, labels = list[Line](), [label for branch in branches for label in branch.labels]
    for doubled, branch in enumerate(branches):
        first, rows = 0, branch.rows
        for k in range(1, len(rows) + 1):
            bad = rows[first].verdict == "unstable"
            if k == len(rows) or (rows[k].verdict == "unstable") != bad:
                words = ("unstable" if bad else "stable") + (", twice the period" if doubled else "")
                tone, line = COLOURS[1 if bad else 0] if not doubled else COLOURS[3 if bad else 2], "--" if bad else "-"
                curves.append(curve(rows[first : k + 1], words, color=tone, linestyle=line, marker=""))
                first = k
    for kind, mark in _MARKS.items():
        if rows := [label.row for label in labels if label.kind == kind]:
            curves.append(curve(rows, kind, color="black", linestyle="", marker=mark, markerfacecolor="white", markersize=6))
    return Plot(tuple(curves), x, label)


def _range(branch: Followed) -> str:
    return f"{branch.rows[0].parameter:.6g} to {branch.rows[-1].parameter:.6g}"


def _line(label: str, row: Orbit) -> dict[str, str]:
    return {
        "": label,
        "value": f"{row.parameter:.7g}",
        "K\nN/µm": f"{1e-6 * row.stiffness:.4g}",
        "C\nN s/m": f"{row.damping:.4g}",
        "1x\nµm": f"{1e6 * row.amplitude:.4g}",
        "all harmonics\nµm": f"{1e6 * row.swing:.4g}",
        "lag\ndeg": f"{row.phase_deg:.4g}",
        "growth\na turn": f"{row.multiplier:.4g}",
        "open\nballs": f"{row.lost}" if row.lost else "",
    }


def orbit_of(point: Point, arc: float, mass: float) -> Orbit:
    """Numbers of one point; ``mass`` m of K = Re Z + m w^2 [kg]."""
    solution, stability = point.solved, point.floquet
    z, amplitude = synchronous_response(solution, _angles(solution))
    return Orbit(
        point.parameter, arc, solution.problem.speed, z, mass, amplitude, swing(solution), stability.largest,
        int((np.abs(stability.multipliers) > _OUTSIDE).sum()), open_contacts(solution)[1], point.error, stability.verdict, stability.leaves_by,
    )  # fmt: skip


def swing(solution: Solved) -> float:
    """sqrt 2 times the rms of the displacement about its mean [m], over all turns of the span."""
    q = displacements(solution, _angles(solution))[:, :3]
    return float(np.sqrt(2.0 * ((q - q.mean(axis=0)) ** 2).sum(axis=1).mean()))


def growth_of_swing(branch: Branch, point: Point) -> float:
    """Derivative of the amplitude along the branch [m], by a difference quotient along its tangent."""
    solution = point.solved
    path, problem = solution.path, solution.problem
    change = Change(*(np.zeros_like(part) for part in (path.q, path.v, path.a)))
    spread(problem.free, solution.eliminated, branch.displacement(point), branch.unit * point.tangent[-1], change)
    step = _ALONG * solution.size / max(float(np.abs(change.q / problem.weight).max()), 1e-300)
    paths = (
        attrs.evolve(path, q=path.q + h * change.q, v=path.v + h * change.v, a=path.a + h * change.a) for h in (-step, step)
    )
    low, high = (swing(attrs.evolve(solution, path=neighbour)) for neighbour in paths)
    return (high - low) / (2.0 * step)


def resonance(solution: Solved) -> str:
    """What outweighs the response to the force: a harmonic of it at which the ring vibrates by itself; empty where none does."""
    motion = displacements(solution, _angles(solution)) / solution.problem.weight
    sizes = np.linalg.norm(np.fft.rfft(motion, axis=0)[1:], axis=1)
    order = (1 + int(sizes.argmax())) / _turns(solution)
    if order == 1.0:
        return ""
    return (
        f"; its {order:g}x harmonic outweighs the synchronous (1x) component, an internal resonance with a vibration near "
        f"{order * solution.problem.speed * 30.0 / np.pi:.5g} r/min"
    )


def open_contacts(solution: Solved) -> tuple[float, int]:
    """Largest gap of an inner contact [m], negative where all carry at all times, and most of them that are open at once."""
    problem, system = solution.problem, solution.problem.system
    angles = problem.symmetry.span * np.arange(_CONTACTS) / _CONTACTS
    q, v, _, ball, rate = states(solution, angles)
    at = States(angles / problem.speed, q, v * problem.speed, ball, rate)
    # A ball that grazes a race may have no equilibrium with a dashpot that must not pull, which hardly changes which contacts are open.
    try:
        gap = responses(system, at).gap
    except ConvergenceError:
        gap = responses(system.without(DAMPING, TIME_CONSTANT), at).gap
    inner = gap[:, : system.ball_count]
    return float(inner.max()), int((inner >= 0.0).sum(axis=1).max())


def _turns(solution: Solved) -> int:
    """Whole turns of the force in a span that is longer than one, else 1."""
    return max(1, round(solution.problem.symmetry.span / (2.0 * np.pi)))


def _angles(solution: Solved) -> np.ndarray:
    return 2.0 * np.pi * np.arange(_SAMPLES * _turns(solution)) / _SAMPLES
