"""The package as a user installs it: names, extras, data files; folders of the repository: what they import, what they list."""

import json
import re
import subprocess
import sys
import tomllib
import zipfile
from importlib.metadata import distribution, requires
from pathlib import Path

import numpy as np
import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

import raceway
from checks.validation.command_line import install, python, several

ROOT = Path(__file__).resolve().parents[1]
PROJECT, *DISTRIBUTIONS = (
    tomllib.loads(path.read_text(encoding="utf-8"))["project"]
    for path in (ROOT / "pyproject.toml", *sorted(ROOT.glob("packages/*/pyproject.toml")))
)


def test_one_version_everywhere():
    assert PROJECT["version"] == raceway.__version__ == distribution("raceway").version
    assert f"## {raceway.__version__}" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    for package in DISTRIBUTIONS:
        own = [text for text in package["dependencies"] if text.startswith("raceway")]
        assert package["version"] == raceway.__version__ == distribution(package["name"]).version
        assert own and all(text.endswith(f"=={raceway.__version__}") for text in own)


def test_what_is_in_a_package_that_is_missing_is_told():
    rows = [
        (["fit", "k.csv"], "no command 'fit' (in raceway-measure, which RACEWAY_DISABLE leaves out"),
        (["export", "--fmu", "x.toml"], "`raceway export --fmu` is in raceway-fmu, which RACEWAY_DISABLE leaves out"),
        (["plan", "examples/minimal.toml", "--set", "mesh.kind=gmsh"], "mesher 'gmsh' is in raceway-meshing, which"),
        (["study", "rig", "x.toml"], "no command 'rig' (in raceway-measure, which RACEWAY_DISABLE leaves out"),
        (["dev", "law", "hertz"], "no command 'law' (in raceway-checks, which RACEWAY_DISABLE leaves out"),
    ]
    found = several([words for words, _ in rows], RACEWAY_DISABLE="measure,fmu,meshing,checks")
    for (_, told), (code, _, errors) in zip(rows, found, strict=True):
        assert code == 2 and told in errors


def test_a_name_of_a_package_that_is_missing_is_told():
    code = "import raceway, sys; sys.modules['raceway_measure'] = None\ntry: raceway.fit\nexcept AttributeError as why: print(why)"
    assert python("-c", code).stdout.startswith(
        "raceway.fit is in raceway-measure: pip install ./packages/raceway-rotor ./packages/raceway-measure"
    )


def test_the_base_installation_draws_and_meshes_nothing():
    base = [line for line in requires("raceway") or [] if "extra ==" not in line]
    heavy = {"matplotlib", "pyvista", "gmsh", "meshio", "xarray", "dask", "pyamg", "trame"}
    assert not {re.split(r"[<>=!~ \[;]", line)[0].lower() for line in base} & heavy


def test_every_version_of_the_constraints_is_one_that_the_project_allows():
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pins = {}
    for line in lines:
        if not line.startswith("#"):
            found = re.fullmatch(r"([a-z0-9-]+)==([0-9][\w.]*)( ; .*)?", line)
            assert found, f"not NAME==VERSION: {line}"
            pins[found[1]] = found[2]
    extras = PROJECT["optional-dependencies"]
    asked = [text for name in extras for text in (*PROJECT["dependencies"], *extras[name])]
    asked += [text for package in DISTRIBUTIONS for text in package["dependencies"]]
    for requirement in map(Requirement, asked):
        if not requirement.name.startswith("raceway"):
            assert requirement.specifier.contains(pins[canonicalize_name(requirement.name)]), requirement


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """Names of the files of a wheel built from this checkout."""
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return zipfile.ZipFile(next(folder.glob("*.whl"))).namelist()


def test_the_wheel_holds_code_data_and_licence(wheel):
    here = {
        str(path.relative_to(ROOT))
        for path in (ROOT / "raceway").rglob("*")
        if path.suffix in (".py", ".toml", ".json", ".css", ".js", ".html")
    }
    assert here <= set(wheel)
    assert any(name.endswith("licenses/LICENSE") for name in wheel)
    assert not [name for name in wheel if name.startswith(("tests/", "checks/", "docs/"))]


def test_the_readme_scene_runs():
    scene = tomllib.loads((ROOT / "README.md").read_text(encoding="utf-8").partition("```toml\n")[2].partition("```")[0])
    assert scene == tomllib.loads((ROOT / "examples" / "minimal.toml").read_text(encoding="utf-8"))
    raceway.scene_from_dict(scene)


#: Folders -> which of `checks` and `tests` their modules may import.
MAY_IMPORT = {
    "raceway": "", "packages/*/raceway_*": "", "checks": "checks", "packages/*/tests": "checks", "tests": "checks tests",
}  # fmt: skip


def imported(path):
    """First words of the modules that a file imports, also in the programs that it writes."""
    for source, names in re.findall(
        r"^ *(?:from (\w+)[\w.]* import |import (.+))", path.read_text(encoding="utf-8"), re.MULTILINE
    ):
        yield from [source] if source else re.findall(r"(?:^|, *)(\w+)", names)


@pytest.mark.parametrize("folders", MAY_IMPORT)
def test_folders_import_one_way(folders):
    forbidden = {"checks", "tests"} - set(MAY_IMPORT[folders].split())
    files = sorted(ROOT.glob(f"{folders}/**/*.py"))
    assert files
    assert [(str(path.relative_to(ROOT)), word) for path in files for word in imported(path) if word in forbidden] == []


#: The package's command, name and number, the list of commands, and a mistake in its table.
WEIGHED = """
import json, sys
import raceway as rw
from click.testing import CliRunner
from raceway.cli.main import main
done = CliRunner().invoke(main, ["weigh", sys.argv[1], "--counts", "1", "--out", sys.argv[2]])
result = rw.run(sys.argv[1])
listed = CliRunner().invoke(main, ["--help"])
wrong = CliRunner().invoke(main, ["plan", sys.argv[1], "--set", "weighing.gravity=-1"])
weight = rw.weigh(result.model.scene, [1]).newtons[0]
ratio = result.to_dict()["pressure_over_young"]
print(json.dumps([done.exit_code, weight, ratio, listed.stdout, wrong.exit_code, wrong.stderr]))
"""


def test_an_ability_comes_from_a_package_alone(tmp_path):
    """Its command, public name, table of the scene, quantity and picture, by ``raceway_commands``, ``raceway_names``, ``raceway_tables``."""
    install(tmp_path, "weighing", (ROOT / "examples" / "plugins" / "weighing.py").read_text(encoding="utf-8"))
    scene = tmp_path / "scene.toml"
    scene.write_text(
        'title = "w"\n[bearing]\npreset = "B7206C"\n[load]\naxial = 400.0\n[weighing]\ngravity = 1.62\n', encoding="utf-8"
    )
    found = python("-c", WEIGHED, scene, tmp_path / "out", PYTHONPATH=tmp_path)
    done, weight, ratio, listed, code, wrong = json.loads(found.stdout)
    assert done == 0 and {path.name for path in (tmp_path / "out").iterdir()} == {"weights.json", "weights.png"}
    assert weight == pytest.approx(1.62 * 7850.0 * np.pi / 6.0 * 9.525e-3**3, rel=0.01) and "largest" in ratio
    assert "weigh" in listed and code == 2 and "weighing.gravity" in wrong
