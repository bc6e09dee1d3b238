"""What stays out of memory until it is needed."""

from __future__ import annotations

import json
import resource

import pytest

from validation.command_line import ARTICLE, python

HEAVY = ("numba", "scipy", "meshio", "gmsh", "pyvista", "matplotlib")

LOOK = """
import json, sys
try:
    {code}
except SystemExit as end:
    assert not end.code, end.code
sys.stderr.write(json.dumps(sorted({{name.partition(".")[0] for name in sys.modules}})))
"""

#: What reading a scene needs not either.
HEAVIER = (*HEAVY, "numpy", "pandas", "xarray", "pluggy", "attrs", "click", "rich")

LIGHT = {
    "import": "import raceway; raceway.load_scene; raceway.RacewayError",
    "scene": f"import raceway as rw; rw.Scene.from_toml({ARTICLE!r}).with_(load={{'axial': '1 kN'}}); rw.positive",
    "check and plan": f"import raceway as rw; rw.check({ARTICLE!r}); rw.plan({ARTICLE!r})",
    "help": "from raceway.cli import main; main(['--help'])",
    "help of a command": "from raceway.cli import main; main(['run', '--help'])",
    "check": f"from raceway.cli import main; main(['check', {ARTICLE!r}])",
    "plan": f"from raceway.cli import main; main(['plan', {ARTICLE!r}])",
    "plugins": "from raceway.cli import main; main(['plugins'])",
    "schema": "from raceway.cli import main; main(['schema'])",
    "cache": "from raceway.cli import main; main(['cache'])",
}


@pytest.mark.parametrize("case", LIGHT)
def test_heavy_packages_stay_out(case):
    found = python("-c", LOOK.format(code=LIGHT[case]))
    assert found.returncode == 0, found.stderr
    loaded = set(json.loads(found.stderr))
    assert "raceway" in loaded
    assert not loaded & set(HEAVY)


def test_the_import_alone_loads_nothing_else():
    found = python("-c", LOOK.format(code="import raceway as rw; dir(rw)"))
    assert found.returncode == 0, found.stderr
    assert not set(json.loads(found.stderr)) & set(HEAVIER)


def test_the_list_of_commands_loads_none_of_them():
    found = python("-c", LOOK.format(code=LIGHT["help"]))
    assert found.returncode == 0, found.stderr
    assert not set(json.loads(found.stderr.splitlines()[-1])) & {*HEAVY, "numpy", "rich", "cattrs"}


def least_seconds(*words, runs=9):
    """Processor time of a process, the least of several: what others do on the machine only adds."""

    def spent():
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime

    taken = []
    for _ in range(runs):
        before = spent()
        assert python(*words).returncode == 0
        taken.append(spent() - before)
    return min(taken)


def test_the_import_takes_a_tenth_of_a_second_at_most():
    assert least_seconds("-c", "import raceway") - least_seconds("-c", "pass") <= 0.1


def test_a_run_without_pictures_loads_no_package_for_pictures_or_meshes(tmp_path):
    code = f"from raceway.cli import main; main(['run', {ARTICLE!r}, '--out', {str(tmp_path)!r}])"
    found = python("-c", LOOK.format(code=code))
    assert found.returncode == 0, found.stderr
    assert not set(json.loads(found.stderr)) & {"meshio", "gmsh", "pyvista", "matplotlib"}


@pytest.mark.parametrize("words", [["precision", ARTICLE, "--vary", "no.key=1,2"], ["stability", "--only", "no such case"]])
def test_a_mistake_in_a_study_is_told_before_the_compiler_is_loaded(words):
    code = LOOK.replace("assert not end.code", "assert end.code == 2").format(
        code=f"from raceway.cli import main; main({words!r})"
    )
    found = python("-c", code)
    assert found.returncode == 0, found.stderr
    assert not set(json.loads(found.stderr.splitlines()[-1])) & set(HEAVY)


def test_help_takes_little_more_than_its_libraries():
    assert least_seconds("-m", "raceway", "--help") - least_seconds("-c", "import attrs, click") <= 0.15
