"""Pages that the program writes, made as cheaply as they come: name -> a function that writes it into a folder."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from checks.validation.command_line import ARTICLE, EXAMPLES, invoke


def _command(file: str, *words: Any) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        found = invoke(*words, "--out", folder)
        assert found.exit_code == 0, found.output
        return folder / file

    return write


_POINT = ("rig.speeds_rpm=[13000.0]", "rig.axial_loads=[2000.0]", "rig.signals.duration=0.25")
PAGES: dict[str, Callable[[Path], Path]] = {
    "view": _command("view.html", "view", ARTICLE, "--html"),
    "study rig": _command(
        "rig.html", "study", "rig", EXAMPLES / "test_rig.toml", *(w for p in _POINT for w in ("--set", p))
    ),
}
