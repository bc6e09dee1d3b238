"""The files of an FMU: description of its variables, C sources, and a binary where a compiler exists.

References
----------
Functional Mock-up Interface for Model Exchange and Co-Simulation 2.0.4; Functional Mock-up Interface 3.0.2 (Modelica Association).
"""

from __future__ import annotations

import hashlib
import io
import json
import platform
import shutil
import subprocess
import sys
import tempfile
import textwrap
import zipfile
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from xml.etree import ElementTree as ET

import attrs
import numpy as np

from raceway import __version__

#: Exponents of base units, and the factor to them, of units that variables have.
_UNITS: dict[str, dict[str, float]] = {
    "m": {"m": 1}, "rad": {"rad": 1}, "kg": {"kg": 1}, "s": {"s": 1}, "N": {"kg": 1, "m": 1, "s": -2}, "Pa": {"kg": 1, "m": -1, "s": -2},
    "N m": {"kg": 1, "m": 2, "s": -2}, "N/m": {"kg": 1, "s": -2}, "N/rad": {"kg": 1, "m": 1, "s": -2, "rad": -1},
    "N m/m": {"kg": 1, "m": 1, "s": -2}, "N m/rad": {"kg": 1, "m": 2, "s": -2, "rad": -1}, "N s/m": {"kg": 1, "s": -1},
    "kg m": {"kg": 1, "m": 1}, "kg m2": {"kg": 1, "m": 2}, "m/s": {"m": 1, "s": -1}, "rad/s": {"rad": 1, "s": -1},
    "r/min": {"rad": 1, "s": -1, "factor": np.pi / 30.0}, "deg": {"rad": 1, "factor": np.pi / 180.0},
}  # fmt: skip
#: System and machine -> the folders of binaries of FMI 2.0 and 3.0, and the ending of a library.
_PLATFORMS = {
    ("linux", "x86_64"): ("linux64", "x86_64-linux", ".so"),
    ("linux", "aarch64"): ("", "aarch64-linux", ".so"),
    ("darwin", "x86_64"): ("darwin64", "x86_64-darwin", ".dylib"),
    ("darwin", "arm64"): ("", "aarch64-darwin", ".dylib"),
}
_COMPILERS = ("cc", "gcc", "clang")
_FLAGS = ("-std=c99", "-O3", "-fPIC", "-shared")
_TAGS = {"ModelExchange": {}, "CoSimulation": {"canHandleVariableCommunicationStepSize": "true"}}
#: Characters of a line of C, of which the standard guarantees 4095.
_LINE = 4000
#: Of all files, so that the same bearing gives the same bytes.
_DATE = (1980, 1, 1, 0, 0, 0)


@attrs.frozen
class Variable:
    """A real variable; ``low``, ``high`` : what an input is made for."""

    name: str
    unit: str
    words: str
    start: float | None = None
    low: float | None = None
    high: float | None = None

    @property
    def attributes(self) -> dict[str, str]:
        """Of its element, but for name and words."""
        numbers = {
            "unit": self.unit if self.unit in _UNITS else None,
            "min": self.low,
            "max": self.high,
            "start": self.start,
        }
        return {
            name: value if isinstance(value, str) else repr(float(value))
            for name, value in numbers.items()
            if value is not None
        }


@attrs.frozen
class Unit:
    """An FMU of a bearing.

    Attributes
    ----------
    name : identifier in C;  words : what it is, with its error
    source : file of the model in ``raceway/data/fmu``;  numbers : C text of its numbers;  beyond : what is logged out of range
    inputs, outputs, constants : real variables, in this order by their value references
    """

    name: str
    words: str
    source: str
    numbers: str
    beyond: str
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    constants: tuple[Variable, ...]

    @property
    def variables(self) -> list[tuple[Variable, str]]:
        """All, with what they are."""
        parts = {"input": self.inputs, "output": self.outputs, "constant": self.constants}
        return [(variable, part) for part, variables in parts.items() for variable in variables]

    @property
    def computed(self) -> list[int]:
        """Value references of the outputs, ``in_range`` at last."""
        first = len(self.inputs)
        return [*range(first, first + len(self.outputs)), len(self.variables)]

    @property
    def token(self) -> str:
        """Names exactly these variables and numbers."""
        return hashlib.sha256(f"{self!r}{__version__}".encode()).hexdigest()[:32]

    def header(self) -> str:
        """numbers.h."""
        defined = {
            "MODEL": self.name,
            "MODEL_SOURCE": f'"{self.source}"',
            "TOKEN": f'"{self.token}"',
            "BEYOND": f'"{self.beyond}"',
            "INPUTS": len(self.inputs),
            "OUTPUTS": len(self.outputs),
            "CONSTANTS": len(self.constants),
        }
        lines = [
            f"/* {self.words}  Raceway {__version__}. */",
            *(f"#define {name} {value}" for name, value in defined.items()),
        ]
        lines += [f"int {self.name}_outputs(const double *inputs, double *outputs);"]
        lines += [c_array("start", np.array([v.start for v in self.inputs]))]
        lines += [c_array("constants", np.array([v.start for v in self.constants]))]
        return "\n".join([*lines, self.numbers, ""])

    def sources(self, version: int) -> dict[str, str]:
        """C files by their names; fmi2.c or fmi3.c includes the others."""
        folder = files("raceway") / "data" / "fmu"
        names = (f"fmi{version}.c", "component.h", self.source)
        return {name: (folder / name).read_text() for name in names} | {"numbers.h": self.header()}

    def pack(self, version: int) -> tuple[bytes, str]:
        """The FMU, and why it has no binary; empty where it has one."""
        sources = self.sources(version)
        content = {f"sources/{name}": text.encode() for name, text in sources.items()}
        content["modelDescription.xml"] = _xml(_description2(self) if version == 2 else _description3(self))
        if version == 3:
            content["sources/buildDescription.xml"] = _xml(_build(self))
        folder, why = _folder(version)
        if folder:
            library, why = _compiled(sources, f"fmi{version}.c")
            if library:
                content[f"binaries/{folder}/{self.name}{_PLATFORMS[_machine()][2]}"] = library
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
            for name in sorted(content):
                archive.writestr(zipfile.ZipInfo(name, _DATE), content[name], zipfile.ZIP_DEFLATED)
        return packed.getvalue(), why


def c_array(name: str, numbers: np.ndarray) -> str:
    """An array (n,) or (n, k) of doubles in C, exact, in lines that every compiler takes."""
    text = json.dumps(numbers.tolist()).translate(str.maketrans("[]", "{}"))
    sizes = "".join(f"[{size}]" for size in numbers.shape)
    return textwrap.fill(
        f"static const double {name}{sizes} = {text};", _LINE, break_long_words=False, break_on_hyphens=False
    )


def _machine() -> tuple[str, str]:
    return sys.platform, platform.machine()


def _folder(version: int) -> tuple[str, str]:
    """Of the binaries on this machine, or why there is none."""
    folder = _PLATFORMS.get(_machine(), ("", "", ""))[version - 2]
    return folder, "" if folder else f"FMI {version} has no binaries of {platform.machine()} under {sys.platform} here"


def _compiled(sources: dict[str, str], face: str) -> tuple[bytes, str]:
    """The library, or why there is none."""
    compiler = next(filter(None, map(shutil.which, _COMPILERS)), None)
    if compiler is None:
        return b"", f"no C compiler ({', '.join(_COMPILERS)}) was found"
    with tempfile.TemporaryDirectory(prefix="raceway-fmu-") as folder:
        for name, text in sources.items():
            (Path(folder) / name).write_text(text)
        library = Path(folder) / "library"
        command = [compiler, *_FLAGS, face, "-o", library.name, "-lm"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            return b"", f"{compiler} failed: {done.stderr.strip()[:200]}"
        return library.read_bytes(), ""


def _element(parent: ET.Element, tag: str, **attributes: str) -> ET.Element:
    return ET.SubElement(parent, tag, attributes)


def _xml(root: ET.Element) -> bytes:
    ET.indent(root)
    return bytes(ET.tostring(root, encoding="UTF-8", xml_declaration=True))


def _root(unit: Unit, version: str, token: str) -> ET.Element:
    attributes = {
        "fmiVersion": version, "modelName": unit.name, token: unit.token, "description": unit.words, "version": __version__,
        "generationTool": f"Raceway {__version__}", "variableNamingConvention": "structured",
    }  # fmt: skip
    return ET.Element("fmiModelDescription", attributes)


def _add_units(root: ET.Element, variables: Sequence[tuple[Variable, str]]) -> None:
    definitions = _element(root, "UnitDefinitions")
    for name in dict.fromkeys(variable.unit for variable, _ in variables if variable.unit in _UNITS):
        exponents = {
            base: str(exponent) if base == "factor" else str(int(exponent)) for base, exponent in _UNITS[name].items()
        }
        _element(_element(definitions, "Unit", name=name), "BaseUnit", **exponents)


_FLAG = {
    "name": "in_range",
    "description": "whether all inputs lie where the model is made for",
    "causality": "output",
    "variability": "discrete",
}
_KINDS = {
    "input": {"causality": "input", "variability": "continuous"},
    "output": {"causality": "output", "variability": "continuous", "initial": "calculated"},
    "constant": {"causality": "local", "variability": "constant", "initial": "exact"},
}


def _description2(unit: Unit) -> ET.Element:
    root, variables = _root(unit, "2.0", "guid"), unit.variables
    can = {"modelIdentifier": unit.name, "canGetAndSetFMUstate": "true", "providesDirectionalDerivative": "true"}
    for tag, further in _TAGS.items():
        _element(_element(_element(root, tag, **can, **further), "SourceFiles"), "File", name="fmi2.c")
    _add_units(root, variables)
    _element(root, "DefaultExperiment", startTime="0.0", stopTime="1.0")
    listed = _element(root, "ModelVariables")
    for reference, (variable, part) in enumerate(variables):
        about = {"name": variable.name, "description": variable.words, "valueReference": str(reference)}
        _element(_element(listed, "ScalarVariable", **about, **_KINDS[part]), "Real", **variable.attributes)
    flag = _element(listed, "ScalarVariable", valueReference=str(len(variables)), initial="calculated", **_FLAG)
    _element(flag, "Boolean")
    structure, inputs = _element(root, "ModelStructure"), len(unit.inputs)
    for tag in ("Outputs", "InitialUnknowns"):
        unknowns = _element(structure, tag)
        for k in unit.computed:
            _element(unknowns, "Unknown", index=str(k + 1), dependencies=" ".join(str(j + 1) for j in range(inputs)))
    return root


def _description3(unit: Unit) -> ET.Element:
    root, variables = _root(unit, "3.0", "instantiationToken"), unit.variables
    can = {"modelIdentifier": unit.name, "canGetAndSetFMUState": "true", "providesDirectionalDerivatives": "true"}
    for tag, further in _TAGS.items():
        _element(root, tag, **can, **further)
    _add_units(root, variables)
    _element(root, "DefaultExperiment", startTime="0.0", stopTime="1.0")
    listed = _element(root, "ModelVariables")
    time = {
        "name": "time",
        "valueReference": str(len(variables) + 1),
        "causality": "independent",
        "variability": "continuous",
    }
    _element(listed, "Float64", **time)
    for reference, (variable, part) in enumerate(variables):
        about = {"name": variable.name, "description": variable.words, "valueReference": str(reference)}
        kinds = {name: word for name, word in _KINDS[part].items() if part != "constant" or name != "initial"}
        _element(listed, "Float64", **about, **kinds, **variable.attributes)
    _element(listed, "Boolean", valueReference=str(len(variables)), **_FLAG)
    structure, inputs = _element(root, "ModelStructure"), " ".join(map(str, range(len(unit.inputs))))
    for tag in ("Output", "InitialUnknown"):
        for k in unit.computed:
            _element(structure, tag, valueReference=str(k), dependencies=inputs)
    return root


def _build(unit: Unit) -> ET.Element:
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    sources = _element(_element(root, "BuildConfiguration", modelIdentifier=unit.name), "SourceFileSet", language="C99")
    _element(sources, "SourceFile", name="fmi3.c")
    return root
