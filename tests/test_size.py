"""The package stays below its ceilings."""

from __future__ import annotations

from validation.size import ceilings, measures, sources

MODULES = sources()


def test_no_ceiling_is_exceeded():
    present = measures(MODULES)
    above = [
        f"{part}, {name}: {present[part][name]:g}, at most {ceiling:g}"
        for part, numbers in ceilings().items()
        for name, ceiling in numbers.items()
        if part in present and present[part][name] > ceiling
    ]
    assert not above, "make it smaller, or raise the ceiling in validation/size.toml with a reason in CHANGELOG.md"
