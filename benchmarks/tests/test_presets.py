"""The series of the catalogue are written by the program."""

from __future__ import annotations

from benchmarks.presets import FOLDER, every


def test_the_series_are_what_the_inference_gives():
    for series, content in every().items():
        assert (FOLDER / f"{series}.toml").read_text(encoding="utf-8") == content, "python -m benchmarks.presets"
