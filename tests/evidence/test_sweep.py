"""Sweeps: speed, memory and failures."""

import os

import pytest

from checks.validation import sweeps

pytestmark = pytest.mark.night

KEPT = {"basis": "own other method", "source": "the undisturbed sweep; a finished point is on disk before the next one"}


def test_two_workers_over_one(claim):
    quiet = sweeps.quiet()
    one, two = (
        sweeps.timed(2000, "--executor", "processes", "--workers", workers, bodies="condensed")["wall_s"] for workers in "12"
    )
    # Other programs on the machine are no fault of the sweep's.
    misses = "" if quiet or one / two >= 1.7 else f"other programs work here: load average {os.getloadavg()[0]:.1f}"
    quantity, source = "wall time of 2000 condensed points, one worker over two", "two, less the start and the main process"
    claim(quantity, one / two, at_least=1.7, basis="closed form", source=source, misses=misses)


@pytest.mark.parametrize(("bodies", "limit"), [("rigid", 60.0), ("condensed", 120.0)])
def test_time_of_a_thousand_points(claim, bodies, limit):
    wall = sweeps.timed(1000, "--executor", "processes", "--workers", "2", bodies=bodies)["wall_s"]
    quantity, source = f"1000 points, {bodies}, periodic, two workers: wall time", "a minute or two, as one waits"
    claim(quantity, wall, at_most=limit, unit="s", basis="regression", source=source)


def test_overhead(claim):
    spent = 1e3 * sweeps.overhead()["overhead_s"]
    source = "the same runs alone, each begun from its neighbour; a fifth of a rigid point"
    claim(
        "processor time of the sweep itself a point", spent, at_most=2.0, unit="ms", basis="own other method", source=source
    )


def test_memory(claim):
    few, many = (sweeps.timed(count)["peak_bytes"] for count in (200, 2000))
    source = "rows are on disk"
    claim("peak memory of 2000 points over that of 200", many / few, at_most=1.05, basis="closed form", source=source)


def test_warm_starts(claim):
    change = max(one["change"] for one in sweeps.continuation().values())
    quantity = "change of Z by starting from a neighbour, the article's speeds and through a resonance: largest, relative"
    claim(quantity, change, at_most=1e-7, basis="own other method", source="cold starts; both are solved to 1e-7")


def test_kills(claim):
    """At random moments, of 120 points; every fourth sweep with two processes."""
    found = sweeps.killed()
    assert found["killed"] == 20
    quantity = "of 20 sweeps killed at random moments: {}"
    claim(quantity.format("those that do not resume to the same values"), 20 - found["equal"], at_most=0, **KEPT)
    lost = found["unreadable"] + found["lost"]
    claim(quantity.format("stores left unreadable, or without a finished point"), lost, at_most=0, **KEPT)
    source = "workers end with their parent"
    words = quantity.format("processes left 5 s later")
    claim(words, found["orphans"], at_most=0, basis="closed form", source=source)
