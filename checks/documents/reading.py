"""How a scene becomes K: the files that ``raceway run examples/minimal.toml`` enters, in their order, as docs/pictures/reading.svg."""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PICTURE = ROOT / "docs" / "pictures" / "reading.svg"
#: First file of each step, and the step; the pages says what happens in them.
STEPS = (
    ("cli/console.py", "Command"), ("scene/inputs.py", "Scene"), ("planning/plan.py", "Plan"), ("bodies/model.py", "Build"),
    ("pipeline/equilibrium.py", "Equilibrium"), ("pipeline/simulate.py", "Motion"), ("plugins/identifiers.py", "Identify"),
    ("pipeline/identified.py", "Error"), ("pipeline/quantities.py", "Quantities"), ("pipeline/uncertainty.py", "Uncertainty"),
    ("pipeline/run_screen.py", "Screen"),
)  # fmt: skip
_COLOURS = {
    "core": "#1b6ca8", "pipeline": "#b3261e", "plugins": "#2e7d32", "contact_laws": "#2e7d32",
    "integrators": "#2e7d32",
}  # fmt: skip
_INK, _ROWS = "#1f2933", 34
_TRACE = """
import contextlib, inspect, io, json, sys
from pathlib import Path
import raceway.cli.main
root, entered = str(Path(raceway.cli.main.__file__).parents[1]), dict()
def enter(frame, event, argument):
    code = frame.f_code
    if event == "call" and code.co_flags & inspect.CO_OPTIMIZED and code.co_filename.startswith(root):
        entered.setdefault(code.co_filename)
sys.argv = ["raceway", "run", "examples/minimal.toml", "--out", sys.argv[1]]
with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):
    sys.setprofile(enter)
    raceway.cli.main.main()
sys.setprofile(None)
print(json.dumps([Path(name).relative_to(root).as_posix() for name in entered]))
"""


def entered() -> list[str]:
    """Files below raceway/ in the order in which a run with warm caches enters them; compiled kernels are not seen."""
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(2):
            words = [sys.executable, "-c", _TRACE, folder]
            done = subprocess.run(words, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
    names: list[str] = json.loads(done.stdout.splitlines()[-1])
    return names


def draw(path: Path = PICTURE) -> None:
    """Write the picture: steps and, below each, the files that are entered first in it."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    files, steps = entered(), dict(STEPS)
    lines: list[tuple[str, str]] = []
    for name in files:
        if name in steps:
            left = -len(lines) % _ROWS  # a step that would begin in a column's last lines begins the next one
            lines += [("", "")] * (left if left < 5 else 1) + [(steps[name], "step")]
        lines.append((name, ""))
    settings = {"svg.hashsalt": "raceway", "svg.fonttype": "none", "font.size": 9, "font.family": "DejaVu Sans"}
    with mpl.rc_context(settings):
        columns = -(-len(lines) // _ROWS)
        figure = Figure(figsize=(3.1 * columns, 0.19 * _ROWS), facecolor="white")
        axes = figure.add_axes((0.01, 0.01, 0.98, 0.98))
        for k, (text, kind) in enumerate(lines):
            column, line = divmod(k, _ROWS)
            colour = _INK if kind else _COLOURS.get(text.partition("/")[0], _INK)
            axes.text(
                column + (0.0 if kind else 0.04), -line, text, color=colour, weight="bold" if kind else "normal", va="center"
            )
        axes.set(xlim=(-0.02, columns), ylim=(-_ROWS + 0.3, 0.7))
        axes.axis("off")
        figure.savefig(path, metadata={"Date": None, "Creator": None})
