"""System libraries of pyvista: what to install where it is there and they are not.

Without them it ends the whole process at the first picture, which is therefore tried in a process of its own.
"""

import subprocess
import sys
from functools import cache

from raceway import RacewayError
from raceway.extend import lacking

#: Debian's packages that pyvista lacks; the Makefile's APT_PACKAGES contain them all.
DEBIAN = ("libegl1", "libgl1")

#: The smallest picture that VTK draws without a display.
_PICTURE = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkCommonCore import vtkLogger
from vtkmodules.vtkRenderingCore import vtkRenderWindow
vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
window = vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetSize(16, 16)
window.Render()
"""
#: Seconds after which a trial counts as failed; it takes about one.
_PATIENCE = 60.0


def refuse_pictures(otherwise: str = "") -> None:
    """Refuse to draw with pyvista where that would end the process.

    RacewayError: What installs the system libraries, and ``otherwise``.
    """
    fault = _fault_of_pictures()
    if fault:
        raise RacewayError(f"pictures cannot be drawn: {lacking('pyvista', DEBIAN)}{otherwise} ({fault})")


@cache
def _fault_of_pictures() -> str:
    """How drawing fails in a process of its own; "" where it does not."""
    try:
        trial = subprocess.run([sys.executable, "-c", _PICTURE], capture_output=True, text=True, timeout=_PATIENCE)
    except subprocess.TimeoutExpired:
        return f"a trial took more than {_PATIENCE:g} s"
    if trial.returncode == 0:
        return ""
    if trial.returncode < 0:
        return f"a trial ended by signal {-trial.returncode}"
    return (trial.stderr.strip().splitlines() or [f"a trial ended with {trial.returncode}"])[-1]
