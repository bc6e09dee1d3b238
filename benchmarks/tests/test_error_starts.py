"""A few of the starts that the report draws."""

from benchmarks.evidence.error_starts import SEED, start_rows


def test_the_drawn_starts_hold():
    rows = start_rows(12, SEED)
    assert all(row.ok for row in rows), [(row.quantity, row.value) for row in rows]
