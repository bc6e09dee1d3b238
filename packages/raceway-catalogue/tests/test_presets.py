"""The series of the catalogue are written by the program."""

import re
from contextlib import suppress

import pytest
from presets import CONFORMITY, FOLDER, _roller_texts, _rows, every, infer_printed, lines_by_size, printed_by

from raceway import SceneError

#: As they are written: of two digits with a power of ten, of ten digits.
ERROR, NUMBER = re.compile(r"-?\d\.\de[+-]\d\d\b"), re.compile(r"-?\b\d+(?:\.\d+)?(?:e-\d\d)?\b")


def alike(written: str, found: str) -> None:
    """To the last digit that is written: which way it rounds depends on the processor."""
    texts = [written, found]
    errors = [[float(word) for word in ERROR.findall(text)] for text in texts]
    rest = [ERROR.sub("error", text) for text in texts]
    numbers = [[float(word) for word in NUMBER.findall(text)] for text in rest]
    assert NUMBER.sub("number", rest[0]) == NUMBER.sub("number", rest[1]), (
        "python packages/raceway-catalogue/tests/presets.py"
    )
    assert numbers[0] == pytest.approx(numbers[1], rel=1e-9, abs=0.0), "python packages/raceway-catalogue/tests/presets.py"
    assert errors[0] == pytest.approx(errors[1], rel=0.11, abs=0.0), "python packages/raceway-catalogue/tests/presets.py"


def test_some_rows_are_what_the_inference_gives():
    """Of balls one size in fifty; rollers, which are a closed form, all."""
    texts = {path.stem: path.read_text(encoding="utf-8") for path in FOLDER.glob("*.toml")}
    lines = {line.partition(" = ")[0]: line for text in texts.values() for line in text.splitlines()}
    rows = {}
    for one in [*lines_by_size(printed_by("nsk"))[::50], *printed_by("nsk_deep_groove")[::50]]:
        with suppress(SceneError):
            rows |= _rows(infer_printed(one, "NSK", **({} if one.deep_groove else {"conformity": CONFORMITY})))
    written = [name for name in rows if name in lines]  # others' printed ratings are met less closely
    assert len(written) > 5
    alike("\n".join(lines[name] for name in written), "\n".join(f"{name} = {rows[name]}" for name in written))
    for series, content in _roller_texts().items():
        alike(texts[series], content)


@pytest.mark.slow
def test_the_series_are_what_the_inference_gives():
    for series, content in every().items():
        alike((FOLDER / f"{series}.toml").read_text(encoding="utf-8"), content)
