"""The exceptions of the package, one class by who must act.

``SceneError``: the user's file; ``PluginError``: a plug-in's author; ``MeshError``: the mesh;
``ConvergenceError`` and ``StabilityError``: the numbers; ``BeyondPlanError``: the time.  The command line
turns the first three into exit code 2 and the others into exit code 1.
"""

from collections.abc import Sequence
from enum import StrEnum
from typing import Any

import attrs


class Status(StrEnum):
    """Whether a point of a study has an answer, and why not; the words of ``status`` in its row."""

    COMPLETED = "completed"
    #: The steady motion is unstable: its row says where a motion that leaves it leads.
    UNSTABLE = "unstable"
    #: No steady motion was found: its row says what the motion from rest does.
    UNSTEADY = "unsteady"
    #: The numbers failed, or took many times the planned time.
    FAILED = "failed"
    #: The scene, a plug-in or the machine does not allow it.
    REFUSED = "refused"


class RacewayError(Exception):
    """Anything that this package refuses or fails at, with a message for a person.

    Attributes
    ----------
    state : the last good arrays of a run, by name
    files : what the command line has written of it, path by name

    Examples
    --------
    >>> import raceway as rw
    >>> try:
    ...     rw.run({"bearing": {"preset": "B7206G"}})
    ... except rw.RacewayError as error:
    ...     print(type(error).__name__, error.exit_code)
    SceneError 2
    """

    exit_code = 2

    def __init__(self, message: str = "", state: dict[str, Any] | None = None) -> None:
        super().__init__(message)
        self.state = state or {}
        self.files: dict[str, str] = {}

    @property
    def status(self) -> Status:
        """Of a point that ended so."""
        return Status.FAILED if self.exit_code == 1 else Status.REFUSED


def extra(*names: str) -> str:
    """What to type for an extra of this package, or for packages "raceway-...", which are installed from their sources."""
    sources = (f"./packages/{name}" if name.startswith("raceway-") else f".[{name}]" for name in names)
    words = " ".join(f"'{source}'" if "[" in source else source for source in sources)
    return f"pip install {words} in a checkout of Raceway"


def lacking(package: str, libraries: Sequence[str]) -> str:
    """That an installed package lacks libraries of the system, and what to type for them on Debian."""
    line = f"apt-get install -y --no-install-recommends {' '.join(libraries)}"
    return f"{package} is installed but lacks system libraries; on Debian, as root: {line}"


@attrs.frozen
class Mistake:
    """One thing wrong in a scene: where, what stood there in the key's unit, the rule, and the way out.

    Examples
    --------
    >>> import raceway as rw
    >>> print(rw.Mistake("rotor.mass", -1.0, "must be at least 0"))
    `rotor.mass` = -1.0: must be at least 0
    """

    path: str
    value: object
    message: str

    def __str__(self) -> str:
        shown = "" if self.value is None else f" = {short(self.value)}"
        return f"`{self.path}`{shown}: {self.message}"


def short(value: object) -> str:
    """In at most 60 characters."""
    try:
        text = repr(value)
    except Exception:  # of a foreign object
        text = object.__repr__(value)
    return text if len(text) <= 60 else text[:57] + "..."


class SceneError(RacewayError):
    """A scene that cannot be used; carries every mistake that was found.

    Parameters
    ----------
    mistakes : sequence of Mistake

    Examples
    --------
    >>> import raceway as rw
    >>> try:
    ...     rw.Scene.from_dict({"bearing": {"preset": "B7206C"}, "rotor": {"mass": -1}})
    ... except rw.SceneError as error:
    ...     print(error.mistakes[0].path)
    rotor.mass
    """

    def __init__(self, mistakes: Sequence[Mistake]) -> None:
        self.mistakes = list(mistakes)
        super().__init__("\n".join(str(m) for m in self.mistakes))

    @classmethod
    def at(cls, path: str, value: object, message: str) -> "SceneError":
        return cls([Mistake(path, value, message)])


class PluginError(RacewayError):
    """A plug-in that cannot be loaded or that breaks its contract.

    Examples
    --------
    >>> import raceway as rw
    >>> try:
    ...     rw.check("examples/b7206.toml", plugins=["no_such_law.py"])
    ... except rw.PluginError as error:
    ...     print("no_such_law.py" in str(error))
    True
    """


class MeshError(RacewayError):
    """A mesh that cannot be read, built or used; ``mistake`` names the key of the scene where one is to blame.

    Examples
    --------
    >>> import raceway as rw
    >>> rw.MeshError.at("mesh.file", "ring.inp", "has no hexahedra").mistake.path
    'mesh.file'
    """

    mistake: Mistake | None = None

    @classmethod
    def at(cls, path: str, value: object, message: str) -> "MeshError":
        mistake = Mistake(path, value, message)
        error = cls(str(mistake))
        error.mistake = mistake
        return error


class ConvergenceError(RacewayError):
    """A solver that found no solution; ``state`` holds the last good arrays.

    Examples
    --------
    >>> import raceway as rw
    >>> try:
    ...     rw.run({"bearing": {"preset": "B7206C"}})  # nothing seats the balls
    ... except rw.ConvergenceError as error:
    ...     print(error.exit_code)
    1
    """

    exit_code = 1


class BeyondPlanError(RacewayError):
    """A run that was stopped because it took many times its plan; no search takes it for a solution that was not found.

    Examples
    --------
    >>> import raceway as rw
    >>> rw.BeyondPlanError("stopped after 20 s", {"time_s": 0.01}).state
    {'time_s': 0.01}
    """

    exit_code = 1


class StabilityError(ConvergenceError):
    """A step above the stable limit, or a motion that grew without bound.

    Examples
    --------
    >>> import raceway as rw
    >>> issubclass(rw.StabilityError, rw.ConvergenceError)
    True
    """
