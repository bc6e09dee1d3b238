"""The environment of a machine without libraries for drawing, a browser or CalculiX."""

from pathlib import Path

#: What dlopen finds first, and cannot load: a file without content.
LIBRARIES = ("libEGL", "libGL", "libGLU", "libGLX", "libOpenGL", "libOSMesa")


def hide(folder: Path) -> dict[str, str]:
    """Variables of the environment that hide them; the folders that they name lie in ``folder``."""
    libraries, programs = folder / "libraries", folder / "programs"
    for place in (libraries, programs):
        place.mkdir(exist_ok=True)
    for name in LIBRARIES:
        for end in (".so", ".so.0", ".so.1", ".so.8"):
            (libraries / f"{name}{end}").touch()
    return {"LD_LIBRARY_PATH": str(libraries), "PATH": str(programs), "DISPLAY": ""}
