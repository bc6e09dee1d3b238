"""The series of the catalogue are written by the program."""

from __future__ import annotations

import re

import pytest

from checks.presets import FOLDER, every

#: As they are written: of two digits with a power of ten, of ten digits.
ERROR, NUMBER = re.compile(r"-?\d\.\de[+-]\d\d\b"), re.compile(r"-?\b\d+(?:\.\d+)?(?:e-\d\d)?\b")


def test_the_series_are_what_the_inference_gives():
    """To the last digit that is written: which way it rounds depends on the processor."""
    for series, content in every().items():
        texts = [(FOLDER / f"{series}.toml").read_text(encoding="utf-8"), content]
        errors = [[float(word) for word in ERROR.findall(text)] for text in texts]
        rest = [ERROR.sub("error", text) for text in texts]
        numbers = [[float(word) for word in NUMBER.findall(text)] for text in rest]
        assert NUMBER.sub("number", rest[0]) == NUMBER.sub("number", rest[1]), "python -m checks.presets"
        assert numbers[0] == pytest.approx(numbers[1], rel=1e-9, abs=0.0), "python -m checks.presets"
        assert errors[0] == pytest.approx(errors[1], rel=0.11, abs=0.0), "python -m checks.presets"
