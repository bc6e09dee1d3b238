"""What editors and type checkers see of the package: pyright on a user's script, completion and signatures by jedi.

Needs ``pip install "pyright[nodejs]" jedi``, which no extra installs.
"""

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import raceway as rw
from checks.robustness import Row, below
from raceway.answers.quantities import IDENTIFIED

ROOT = Path(__file__).parents[2]

HEAD = """
import numpy as np

import raceway as rw

scene = rw.load_scene("examples/b7206.toml", ["load.axial=500"])
tables = {"bearing": {"preset": "B7206C"}, "load": {"axial": "1 kN"}}
result = rw.run(scene)
f = rw.function(tables, ["load.axial"], ["K", "C"])
loads = {"load.axial": np.linspace(200.0, 1000.0, 5)}
bearing = rw.infer("7206 C", outer_diameter=62e-3, ratings={15.0: (24200.0, 16000.0)})
"""
#: Each is revealed; none may be Any, nor unknown.
EXPRESSIONS = """
scene
scene.load.axial
scene.bearing.ball_count
result
result.K
result.C
result.Z
result.equivalent_stiffness_error
result.stiffness
result.ball_loads
result.warnings
result.gradient("load.axial")
result.to_xarray()
result.plot("orbit")
rw.plan(scene).predicted_wall_s
rw.sweep(scene, {"excitation.speed_rpm": [6000.0, 9000.0]})
rw.compare(scene, {"excitation.kind": ["rotating", "unidirectional"]})
rw.band(scene)
f(**loads)
f.jacobian(**loads)
bearing
rw.check(tables).mistakes
rw.Quantity("ratio", "1", "a ratio").unit
"""
#: A wrong type and two wrong names: an error each.
WRONG = """
rw.run(3)
print(result.equivalent_stifness)
rw.rum(scene)
"""


def rows() -> Iterator[Row]:
    """Expressions without a type, errors found in wrong lines, names that completion lacks."""
    expressions = EXPRESSIONS.split("\n")[1:-1]
    script = HEAD + "".join(f"reveal_type({expression})\n" for expression in expressions) + WRONG.lstrip("\n")
    first_wrong = script.count("\n") - WRONG.count("\n") + 1
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "script.py"
        path.write_text(script)
        command = [sys.executable, "-m", "pyright", "--outputjson", "--pythonpath", sys.executable, str(path)]
        answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if not answer.stdout.startswith("{"):
        sys.exit(f'pyright does not run: pip install "pyright[nodejs]" jedi\n{answer.stderr}')
    found = json.loads(answer.stdout)["generalDiagnostics"]
    revealed = [row["message"].rpartition(' is "')[2].rstrip('"') for row in found if row["severity"] == "information"]
    errors = [row for row in found if row["severity"] == "error"]
    unknown = [text for text in revealed if text in ("Any", "Unknown")]
    shown = f"{len(revealed)} revealed: {'; '.join(dict.fromkeys(revealed))}"
    yield below("expressions of a user's script whose type is Any or unknown", len(unknown), 0, shown)
    early = [row["message"] for row in errors if row["range"]["start"]["line"] + 1 < first_wrong]
    yield below("errors in lines that are right", len(early), 0, "; ".join(early))
    late = len(errors) - len(early)
    yield Row("errors in three wrong lines: a type, two names", late, "3", late == 3)
    yield from _completion()


def _completion() -> Iterator[Row]:
    import jedi

    project = jedi.Project(str(ROOT), sys_path=[str(ROOT), *sys.path])

    def names(code: str) -> set[str]:
        return {completion.name for completion in jedi.Script(HEAD + code, project=project).complete()}

    missing = [
        sorted(set(rw.__all__) - names("rw.")),
        sorted({"K", "C", "Z", *(q.name for q in IDENTIFIED)} - names("result.")),
    ]
    yield below("public names that jedi does not offer after `rw.`", len(missing[0]), 0, ", ".join(missing[0]))
    yield below("symbols of identified quantities not offered after `result.`", len(missing[1]), 0, ", ".join(missing[1]))
    code = HEAD + "rw.run("
    signatures = jedi.Script(code, project=project).get_signatures()
    shown = signatures[0].to_string() if signatures else "none"
    yield Row("signature of `rw.run(` by jedi", shown, "names `scene` and `out`", "scene" in shown and "out" in shown)
