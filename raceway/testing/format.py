"""The conformance suite of file formats."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.errors import RacewayError
from raceway.testing.suite import Suite, check_class, duty, require

if TYPE_CHECKING:
    from raceway.framework.contracts import Format

#: Relative difference of real numbers that a text of ten figures may make.
TEN_FIGURES = 1e-10


def same(a: Any, b: Any, relative: float = 0.0) -> bool:
    """Whether two things read from files are equal, arrays inside them too; attrs objects (meshes) field by field.

    Real numbers may differ by ``relative`` times themselves; integers and words may not differ.
    """
    if isinstance(a, dict) and isinstance(b, dict):
        return set(a) == set(b) and all(same(a[k], b[k], relative) for k in a)
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(same(x, y, relative) for x, y in zip(a, b, strict=True))
    if attrs.has(type(a)) and type(a) is type(b):
        return all(same(getattr(a, field.name), getattr(b, field.name), relative) for field in attrs.fields(type(a)))
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        a, b = np.asarray(a), np.asarray(b)
        if a.dtype.kind == "f" and b.dtype.kind == "f":
            return a.shape == b.shape and bool(np.allclose(a, b, rtol=relative, atol=0.0))
        return np.array_equal(a, b)
    if isinstance(a, float) and isinstance(b, float):
        return a == b or abs(a - b) <= relative * abs(b)
    return bool(a == b)


class FormatSuite(Suite):
    """Duties of ``raceway.framework.contracts.Format``.

    Attributes
    ----------
    what : something that the format can write; a plug-in checked by name offers it as ``example_content()``
    """

    kind = "format"
    what: Any = None

    @duty("attributes: suffixes with the dot, options")
    def test_declaration(self, form: Format) -> None:
        check_class("format", form)
        suffixes = form.suffixes
        require(isinstance(suffixes, tuple) and suffixes, "`suffixes` must be a tuple that is not empty")
        bad = [s for s in suffixes if not re.fullmatch(r"(\.[a-z0-9_-]+)+", s)]
        require(not bad, f"suffixes {bad} must be lower case and begin with a dot")

    @duty("what is written is read back the same, real numbers to ten figures, with every suffix")
    def test_round_trip(self, form: Format) -> str | None:
        if not hasattr(form, "write"):
            return "reads only"
        what = self._content(form)
        with tempfile.TemporaryDirectory() as folder:
            for suffix in form.suffixes:
                path = Path(folder) / f"content{suffix}"
                form.write(path, what)
                require(path.is_file() and path.stat().st_size > 0, f"write() leaves no file `content{suffix}`")
                require(
                    same(form.read(path), what, TEN_FIGURES),
                    f"`content{suffix}` is read back different from what was written",
                )
        return None

    @duty("a file that is missing or malformed is refused with a RacewayError that names it")
    def test_bad_files(self, form: Format) -> None:
        with tempfile.TemporaryDirectory() as folder:
            for suffix in form.suffixes:
                missing, empty, noise = (Path(folder) / f"{word}{suffix}" for word in ("missing", "empty", "noise"))
                empty.write_bytes(b"")
                noise.write_bytes(bytes(range(255, -1, -1)) * 8)
                for path in (missing, empty, noise):
                    try:
                        form.read(path)
                    except RacewayError as error:
                        require(path.name in str(error), f"the error about `{path.name}` does not name it: {error}")
                    else:
                        require(False, f"`{path.name}` is read without an error")

    def _content(self, form: Format) -> Any:
        if self.what is not None:
            return self.what
        example = getattr(form, "example_content", None)
        require(example is not None, "give the class `example_content()`, or the suite `what`, to write")
        return example() if example is not None else None
