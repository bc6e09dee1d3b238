"""A foreign kind of bodies that breaks a duty is one message that names it, and nothing is lost."""

import pytest

from checks.validation.command_line import MINIMAL, raceway

KIND = '''
import attrs

from raceway import hookimpl
from raceway.plugins.bodies.rigid import Rigid


@attrs.frozen
class Own(Rigid):
    """Rigid bodies that break a duty."""

    name = "own"

    def {duty}(self, *given):
        {body}


@hookimpl
def raceway_bodies():
    return [Own]
'''


@pytest.mark.slow
@pytest.mark.parametrize(
    ("duty", "body", "words"),
    [
        ("faults", "return None", "faults() returned NoneType; it must be list"),
        ("traits", "raise SystemExit(3)", "traits() raises SystemExit: 3"),
        ("stable_step", "return 'short'", "stable_step() returned str; it must be float or None"),
        ("cost", "raise ValueError('no idea')", "cost() raises ValueError: no idea"),
        ("build", "return 7", "build() returned int; it must be a raceway.extend.BuiltBearing"),
        ("build", "raise KeyError('x')", "build() raises KeyError: 'x'"),
    ],
)
def test_a_broken_duty_names_the_kind(tmp_path, duty, body, words):
    path = tmp_path / "own.py"
    path.write_text(KIND.format(duty=duty, body=body), encoding="utf-8")
    changes = ("--set", "bodies.kind=own", "--set", "integrator.kind=central_difference")
    found = raceway("run", MINIMAL, "--plugin", path, *changes, "--out", tmp_path / "out")
    assert found.returncode == 2 and "Traceback" not in found.stderr
    assert f"error: bodies 'own': {words}" in " ".join(found.stderr.split())
