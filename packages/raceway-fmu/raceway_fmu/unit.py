"""The files of an FMU: description of its variables, C sources, and a library where a compiler exists.

Functional Mock-up Interface for Model Exchange and Co-Simulation 2.0.4; Functional Mock-up Interface 3.0.2 (Modelica Association).
"""

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
from collections.abc import Mapping
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
#: System and machine -> the folders of libraries of FMI 2.0 and 3.0, and a library's ending.
_PLATFORMS = {
    ("linux", "x86_64"): ("linux64", "x86_64-linux", ".so"),
    ("linux", "aarch64"): ("", "aarch64-linux", ".so"),
    ("darwin", "x86_64"): ("darwin64", "x86_64-darwin", ".dylib"),
    ("darwin", "arm64"): ("", "aarch64-darwin", ".dylib"),
}
_COMPILERS, _FLAGS = ("cc", "gcc", "clang"), ("-std=c99", "-O3", "-fPIC", "-shared")
#: Characters of a line of C, of which the standard guarantees 4095.
_LINE = 4000
#: Of all files, so that the same bearing gives the same bytes.
_DATE = (1980, 1, 1, 0, 0, 0)
_IN_RANGE = {"name": "in_range", "description": "whether all inputs lie where the model is made for"}


@attrs.frozen
class Variable:
    """A real variable; ``low``, ``high`` : what an input is made for."""

    name: str
    unit: str
    words: str
    start: float | None = None
    low: float | None = None
    high: float | None = None


@attrs.frozen(eq=False)
class Unit:
    """An FMU of a bearing."""

    name: str  # identifier in C
    words: str  # what it is, with its error
    source: str  # file of the model in ``raceway/data/fmu``
    numbers: Mapping[str, np.ndarray | float]  # of the model, by their names in C: arrays, or constants
    beyond: str  # what is logged out of range
    #: inputs, outputs, constants : real variables, in this order by their value references
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    constants: tuple[Variable, ...]

    @property
    def variables(self) -> list[tuple[Variable, str]]:
        """All, with what they are."""
        parts = {"input": self.inputs, "output": self.outputs, "constant": self.constants}
        return [(variable, part) for part, variables in parts.items() for variable in variables]

    @property
    def _body(self) -> str:
        """numbers.h without the token, which is its hash."""
        words = {"MODEL": self.name, "MODEL_SOURCE": f'"{self.source}"', "BEYOND": f'"{self.beyond}"'}
        counts = {"INPUTS": len(self.inputs), "OUTPUTS": len(self.outputs), "CONSTANTS": len(self.constants)}
        starts = {part: np.array([v.start for v in getattr(self, part)]) for part in ("inputs", "constants")}
        numbers = {"start": starts["inputs"], "constants": starts["constants"], **self.numbers}
        return "\n".join([
            f"/* {self.name} by Raceway {__version__}. */",
            *(f"#define {name} {word}" for name, word in {**words, **counts}.items()),
            f"int {self.name}_outputs(const double *inputs, double *outputs);",
            *(_in_c(name, np.asarray(number)) for name, number in numbers.items()),
        ])  # fmt: skip

    @property
    def token(self) -> str:
        """Names exactly these variables and numbers."""
        return hashlib.sha256(f"{self._body}{self.words}{self.variables}".encode()).hexdigest()[:32]

    def sources(self, version: int) -> dict[str, str]:
        """C files by their names; fmi2.c or fmi3.c includes the others."""
        folder = files("raceway_fmu") / "data"
        texts = {name: (folder / name).read_text() for name in (f"fmi{version}.c", "component.h", self.source)}
        return texts | {"numbers.h": f'{self._body}\n#define TOKEN "{self.token}"\n'}

    def pack(self, version: int) -> tuple[bytes, str]:
        """The FMU, and why it has no library; empty where it has one."""
        sources = self.sources(version)
        content = {f"sources/{name}": text.encode() for name, text in sources.items()}
        content["modelDescription.xml"] = _xml(_description(self, version))
        if version == 3:
            root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
            build = _add(root, "BuildConfiguration", modelIdentifier=self.name)
            _add(_add(build, "SourceFileSet", language="C99"), "SourceFile", name="fmi3.c")
            content["sources/buildDescription.xml"] = _xml(root)
        *folders, ending = _PLATFORMS.get((sys.platform, platform.machine()), ("", "", ""))
        library, why = b"", f"no folder is defined for {platform.machine()} under {sys.platform}"
        if folder := folders[version - 2]:
            library, why = _compiled(sources, f"fmi{version}.c")
        if library:
            content[f"binaries/{folder}/{self.name}{ending}"] = library
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w") as archive:
            for name in sorted(content):
                archive.writestr(zipfile.ZipInfo(name, _DATE), content[name], zipfile.ZIP_DEFLATED)
        return buffer.getvalue(), why


def _in_c(name: str, number: np.ndarray) -> str:
    """A constant, or an array, exact, in lines that every compiler takes."""
    if not number.ndim:
        return f"#define {name} {number.item()!r}"
    kind, sizes = "double" if number.dtype.kind == "f" else "int", "".join(f"[{size}]" for size in number.shape)
    text = json.dumps(number.tolist()).translate(str.maketrans("[]", "{}"))
    line = f"static const {kind} {name}{sizes} = {text};"
    return textwrap.fill(line, _LINE, break_long_words=False, break_on_hyphens=False)


def _compiled(sources: Mapping[str, str], face: str) -> tuple[bytes, str]:
    """The library, or why there is none."""
    compiler = next(filter(None, map(shutil.which, _COMPILERS)), None)
    if compiler is None:
        return b"", f"no C compiler ({', '.join(_COMPILERS)}) was found"
    try:
        with tempfile.TemporaryDirectory(prefix="raceway-fmu-") as folder:
            for name, text in sources.items():
                (Path(folder) / name).write_text(text)
            command = [compiler, *_FLAGS, face, "-o", "library", "-lm"]
            subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
            return (Path(folder) / "library").read_bytes(), ""
    except subprocess.CalledProcessError as why:
        return b"", f"{compiler} failed: {why.stderr.strip()[:200]}"
    except OSError as why:
        return b"", f"{compiler} cannot be used: {why.strerror}"


def _xml(root: ET.Element) -> bytes:
    ET.indent(root)
    return bytes(ET.tostring(root, encoding="UTF-8", xml_declaration=True))


def _add(parent: ET.Element, tag: str, **attributes: object) -> ET.Element:
    """An element with those attributes that are not None."""
    texts = {name: v if isinstance(v, str) else repr(v) for name, v in attributes.items() if v is not None}
    return ET.SubElement(parent, tag, texts)


def _description(unit: Unit, version: int) -> ET.Element:
    """modelDescription.xml, which both versions spell otherwise."""
    second, token = version == 2, "guid" if version == 2 else "instantiationToken"
    root = ET.Element("fmiModelDescription", {"fmiVersion": f"{version}.0", "modelName": unit.name, token: unit.token})
    root.attrib |= {"description": unit.words, "version": __version__, "generationTool": f"Raceway {__version__}"}
    root.set("variableNamingConvention", "structured")
    derivatives = f"providesDirectionalDerivative{'' if second else 's'}"
    can = "canGetAndSetFMUstate" if second else "canGetAndSetFMUState", derivatives
    for tag, further in {"ModelExchange": (), "CoSimulation": ("canHandleVariableCommunicationStepSize",)}.items():
        kind = _add(root, tag, modelIdentifier=unit.name, **dict.fromkeys((*can, *further), "true"))
        if second:
            _add(_add(kind, "SourceFiles"), "File", name="fmi2.c")
    units, unit_names = _add(root, "UnitDefinitions"), dict.fromkeys(variable.unit for variable, _ in unit.variables)
    for name in filter(_UNITS.__contains__, unit_names):
        _add(_add(units, "Unit", name=name), "BaseUnit", **_UNITS[name])
    _add(root, "DefaultExperiment", startTime="0.0", stopTime="1.0")
    variables, flag = _add(root, "ModelVariables"), len(unit.variables)
    for reference, (v, part) in enumerate(unit.variables):
        kinds = ("local", "constant") if part == "constant" else (part, "continuous")
        about = {"name": v.name, "valueReference": reference, "description": v.words}
        about |= {"causality": kinds[0], "variability": kinds[1]}
        numbers = {"unit": v.unit if v.unit in _UNITS else None, "min": v.low, "max": v.high, "start": v.start}
        if second:
            _add(_add(variables, "ScalarVariable", **about), "Real", **numbers)
        else:
            _add(variables, "Float64", **about, **numbers)
    about = {**_IN_RANGE, "valueReference": flag, "causality": "output", "variability": "discrete"}
    if second:
        _add(_add(variables, "ScalarVariable", **about), "Boolean")
    else:
        _add(variables, "Boolean", **about)
        _add(variables, "Float64", name="time", valueReference=flag + 1, causality="independent", variability="continuous")
    structure, first = _add(root, "ModelStructure"), len(unit.inputs)
    for tag in ("Output", "InitialUnknown"):
        parent = _add(structure, f"{tag}s") if second else structure
        known = {"dependencies": " ".join(str(j + second) for j in range(first))}
        for k in (*range(first, first + len(unit.outputs)), flag):
            place = {"index" if second else "valueReference": k + second}
            _add(parent, "Unknown" if second else tag, **place, **known)
    return root
