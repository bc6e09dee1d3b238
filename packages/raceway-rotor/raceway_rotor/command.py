"""The front of ``raceway export``: the coefficients of a stored sweep in the files of several programs."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from pathlib import Path

import attrs

from raceway import Answer, SceneError
from raceway.extend import Fact, Part, Tables, Words, file_lines, writable
from raceway_rotor.coefficient_file import CoefficientFile, point_rows
from raceway_rotor.export import export_coefficients, export_ross, kind_of
from raceway_rotor.ross_file import check_name, installed_generation


@attrs.frozen(eq=False, repr=False)
class Exports(Answer):
    """Files of one bearing for several programs: what they hold, and their paths."""

    store: str
    exports: list[CoefficientFile]
    files: list[str]

    @property
    def notes(self) -> list[str]:
        """What the readers of the numbers have to know."""
        return list(dict.fromkeys(note for bearing in self.exports for note in bearing.notes))

    @property
    def _title(self) -> str:
        return f"{self.exports[0].tag}, coefficients for {', '.join(bearing.program for bearing in self.exports)}"

    def to_dict(self) -> Tables:
        programs = [bearing.program for bearing in self.exports]
        numbers = self.exports[0].to_dict()
        return {"store": self.store, **numbers, "programs": programs, "notes": self.notes, "files": self.files}

    def _facts(self) -> tuple[str, list[Fact]]:
        return self._title, [("written", "", file) for file in self.files]

    def report(self) -> list[Part]:
        """The points, what is the same at all of them, what the files' reader has to know."""
        rows, constant = point_rows(self.exports[0].coefficients.axes, self.exports[0].coefficients.columns())
        notes = [f"note: {note}" for note in self.notes]
        return [Words(self._title, "bold"), rows, *constant, *notes, *file_lines(self.files)]


def export(
    store: str | Path, ross: str | Path | None = None, nastran: str | Path | None = None,
    ansys: str | Path | None = None, table: str | Path | None = None, at: Iterable[str] = (),
    source: str | None = None, damping: float = 0.0, ross_version: str | None = None, node: int = 0, number: int = 1,
    tag: str | None = None,
) -> Exports:  # fmt: skip
    """Write kyy, kyz, kzy, kzz, cyy, ... over speed, and over speed and frequency, for a rotor program.

    For ROSS (axes X, Y, Z are y, z, x here), Nastran, Ansys, or as a table. The sweep needs 5 or more values of
    excitation.speed_rpm, 2 without ROSS; with kinematics.spin_speed_rpm, too, the table is over speed and frequency (ROSS 3,
    --table). Other axes need --at. Losses of a format are reported on the screen and in the file.

    Parameters
    ----------
    store : the folder of a sweep
    ross : .toml or .json for ross.BearingElement.load
    nastran : bulk data: CBUSH, PBUSH, PBUSHT, TABLED1
    ansys : APDL commands: COMBI214 with tables over OMEGS
    table : .csv or .json of all numbers, with the 5x5 K and C
    at : select a value of an axis
    source : source of the matrix; None: rotating force; tangent in a static sweep
    damping : cyy and czz [N s/m] where the damping of the sweep is below its error
    ross_version : major version of ROSS; None: the installed one, else 3
    node : node of the bearing in ROSS; grid point in Nastran, 0: to complete
    number : Nastran's property (the next 12 are its tables), Ansys' element type
    tag : name of the element in ROSS; None: the bearing's
    """
    paths = [Path(path) for path in (ross, nastran, ansys, table) if path is not None]
    files = {"nastran": nastran, "ansys": ansys, None: table}
    kinds = [kind_of(kind, path) for kind, path in files.items() if path is not None]
    if not paths:
        raise SceneError.at("raceway export", None, "writes nothing: give --ross, --nastran, --ansys or --table with a FILE")
    for path in paths:
        writable(path.parent)
    exports: list[CoefficientFile] = []
    at = tuple(at)
    if ross is not None:
        check_name(paths[0])
        if ross_version is None and installed_generation() is None:
            warnings.warn("ROSS is not installed: written for ROSS 3; --ross-version 2", stacklevel=3)
        exports = [export_ross(store, at=at, source=source, damping=damping, ross_version=ross_version, node=node, tag=tag)]
    exports += [
        export_coefficients(store, kind=kind, at=at, source=source, damping=damping, number=number, node=node, tag=tag)
        for kind in kinds
    ]
    return Exports(str(store), exports, [str(bearing.write(path)) for bearing, path in zip(exports, paths, strict=True)])
