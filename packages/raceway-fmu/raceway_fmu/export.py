"""``raceway.export_fmu``: a bearing as an FMU for simulators."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby
from pathlib import Path
from typing import Annotated, ClassVar

import attrs

from raceway import Answer, SceneError, door
from raceway.extend import (
    KEY_VALUES, PATHS, TEXTS, Fact, Part, SceneSource, Tables, Words, as_scene, box, member, radial_note, slug, write_whole,
)  # fmt: skip
from raceway_fmu.map import default_ranges, map_unit
from raceway_fmu.rigid_force import NOTES, SPIN, force_unit
from raceway_fmu.unit import Unit

_VERSIONS = (2, 3)


@attrs.frozen(eq=False, repr=False, slots=False)
class FMU(Answer):
    """A bearing as an FMU of FMI 2.0 and one of FMI 3.0, each for co-simulation and model exchange.

    Attributes
    ----------
    title : of the scene;  unit : what the files hold;  notes : what a user has to know beside

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
    >>> fmu = rw.export_fmu(scene, ranges={"load.axial": (400, 2000)}, outputs=["kyy"])
    >>> fmu.unit.outputs[0].name
    'kyy'
    """

    stem: ClassVar[str] = "fmu"
    title: str
    unit: Unit
    notes: list[str]

    def to_dict(self) -> Tables:
        variables = [{"causality": part, **attrs.asdict(variable)} for variable, part in self.unit.variables]
        named = {"title": self.title, "model": self.unit.name, "description": self.unit.words}
        return {**named, "variables": variables, "notes": self.notes}

    @property
    def rows(self) -> list[dict[str, str]]:
        """Inputs with their ranges, outputs with their errors; entries of one array are a row."""
        rows = []
        for (part, words), group in groupby(self.unit.variables, lambda each: (each[1], each[0].words)):
            members = [variable for variable, _ in group]
            first, last = members[0], members[-1]
            name = first.name if first is last else f"{first.name} ... {last.name}"
            ends = "" if first.high is None else f"{first.low:g} to {first.high:g}"
            first_unit, *others = dict.fromkeys(variable.unit for variable in members)
            units = f"{first_unit} ..." if others else first_unit
            rows.append({"": part, "variable": name, "unit": units, "range": ends, "what": words})
        return [row for row in rows if row[""] != "constant"]

    def _facts(self) -> tuple[str, list[Fact]]:
        return self.unit.words, [(row["variable"], row["unit"], row["what"]) for row in self.rows]

    def report(self) -> Iterator[Part]:
        """Variables with their ranges and errors."""
        yield Words(self.unit.words, "bold")
        yield self.rows
        yield from self.notes

    def save(self, folder: str | Path, pictures: bool | str = False) -> list[Path]:
        """Write both FMUs into a folder.

        Raises
        ------
        RacewayError
            A folder that cannot be written.
        """
        paths = super().save(folder)
        for version in _VERSIONS:
            content, why = self.unit.pack(version)
            paths.append(write_whole(content, Path(folder) / f"{self.unit.name}_fmi{version}.fmu"))
            if why:
                self.notes.append(f"FMI {version}: sources only, which the simulator compiles: {why}")
        return paths


@door
def export_fmu(
    scene: SceneSource,
    *,
    kind: str = "map",
    ranges: Annotated[Mapping[str, object] | Iterable[str], KEY_VALUES] = (),
    outputs: Annotated[Iterable[str], TEXTS] = (),
    tolerance: float = 1e-5,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
) -> FMU:
    """Write a bearing as an FMU for simulators: its map of K, C over load and speed, or its force.

    FMI 2.0 and FMI 3.0, co-simulation and model exchange, as C sources with a binary where a C compiler is found.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    kind : "map": quantities over keys, by Chebyshev series; "force": forces of a rigid bearing by displacements and speed
    ranges : low:high of a key, an input of the map; none: load, speed and unbalance about the scene's
    outputs : quantities of a map; none: K and C, of a static scene stiffness
    tolerance : relative error of a map that terms are added for
    plugins : files of one-off plug-ins that the scene uses

    Returns
    -------
    FMU : ``save(folder)`` writes both files

    Raises
    ------
    SceneError
        A key, an output or a scene that cannot be exported.
    RacewayError
        A point within the ranges that has no answer, or a map of runs for longer than two minutes.

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
    >>> fmu = rw.export_fmu(scene, ranges=["load.axial=400:2000"], outputs=["kyy"])
    >>> [variable.name for variable in fmu.unit.inputs]
    ['load.axial']
    """
    if not 0.0 < tolerance < 1.0:
        raise SceneError.at("tolerance", tolerance, "must lie between 0 and 1, such as 1e-5")
    read = as_scene(scene, plugins=plugins)
    title = "".join(filter(str.isprintable, read.title.partition("\n")[0]))
    name = re.sub(r"\W|^(?=\d)", "_", slug(title), flags=re.ASCII) + f"_{member('kind', kind, ('map', 'force'))}"
    limits, wanted_outputs = box(ranges), list(outputs)
    if kind == "map":
        names = wanted_outputs or (["K", "C"] if read.excitation is not None else ["stiffness"])
        unit = map_unit(read, name, limits or default_ranges(read), names, tolerance)
    elif wanted_outputs or not limits.keys() <= {SPIN} or limits.get(SPIN, (0.0, 0.0))[0]:
        raise SceneError.at("kind", kind, f"has inputs and outputs of its own: no --output, and --range {SPIN}=0:X only")
    else:
        unit = force_unit(read, name, limits[SPIN][1] if limits else None)
    notes = [] if limits else ["ranges are not set (--range): about the scene's own numbers"]
    unit = attrs.evolve(unit, words=f"{title}: {unit.words}")
    return FMU(title, unit, [*(NOTES if kind == "force" else []), *notes, *radial_note(read)])
