"""A bearing's coefficients as a file, for programs that read text."""

from __future__ import annotations

from pathlib import Path

import attrs

from raceway.framework.shown import Fact, Shown
from raceway.storage.files import write_whole
from raceway.storage.tables import Tables
from raceway.studies.ross.coefficients import Coefficients


@attrs.frozen(eq=False, repr=False)
class CoefficientFile(Shown):
    """Coefficients of one bearing, written for one program.

    Attributes
    ----------
    kind : "nastran", "ansys", "csv" or "json"
    coefficients : ``speed``, ``frequency`` (n,) [rad/s], ``stiffness`` (..., 2, 2) [N/m], ``damping`` (..., 2, 2) [N s/m] over y, z,
        and ``tangent``, ``tangent_damping`` (..., 5, 5) of the equilibria
    tag : the bearing's name
    notes : what the reader of the numbers has to know, a sentence each; the file begins with them
    text : the file

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
    >>> found = rw.export_coefficients(rw.sweep(scene, {"kinematics.spin_speed_rpm": "0:20000:5"}), kind="ansys", number=3)
    >>> [line for line in found.text.splitlines() if line.startswith(("ET", "KEYOPT", "R,"))]
    ['ET,3,COMBI214', 'KEYOPT,3,2,1', 'R,3,%K11_3%,%K22_3%,0,0,0,0']
    """

    kind: str
    coefficients: Coefficients
    tag: str
    notes: tuple[str, ...]
    text: str

    @property
    def program(self) -> str:
        """Whom the file is for."""
        return {"nastran": "Nastran", "ansys": "Ansys"}.get(self.kind, self.kind.upper())

    def to_dict(self) -> Tables:
        """The numbers by our names, and the notes, as plain tables."""
        return {"programs": [self.program], "tag": self.tag, **self.coefficients.to_dict(), "notes": list(self.notes)}

    def write(self, path: str | Path) -> Path:
        """Write the file, whole or not at all.

        Raises
        ------
        RacewayError
            A folder that cannot be written.
        """
        return write_whole(self.text.encode(), Path(path))

    def _shown(self) -> tuple[str, list[Fact]]:
        lines = self.text.count("\n")
        return f"{self.tag}, coefficients for {self.program}\n{lines} lines", [("note", "", note) for note in self.notes]
