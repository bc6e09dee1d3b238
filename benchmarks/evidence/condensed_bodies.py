"""Condensed bodies: compliances by harmonics, the floating ball, frequencies, cost, cache."""

from __future__ import annotations

import json
import subprocess
import sys
from math import ceil, cos, pi
from typing import Any

import attrs
import numpy as np

from benchmarks.evidence import Row, below, near
from benchmarks.evidence._files import ROOT
from raceway.core.revolution.ball_profile import ball_profile
from raceway.core.revolution.body import Revolution, seat_areas
from raceway.core.revolution.profile import Profile, dofs
from raceway.core.revolution.ring_profile import coarse_profile, graded_profile

TITLE = "Condensed bodies: rings and balls by harmonics"
COMMAND = "python -m benchmarks.evidence condensed_bodies"
STEEL = (212e9, 0.29, 7810.0)
ALL = (0, 1, 2)
#: Refinement of the ball [N], and the highest load that its patch holds.
LOAD, HIGHEST = 300.0, 420.0
BULK = 0.8e-3


def rows() -> list[Row]:
    return [*_full(), *_reciprocity(), *_sampling(), *_frequencies(), *_cost()]


def _shape(inner: bool, land: float | None = None) -> Any:
    from raceway import load_scene
    from raceway.core.mesh.ring_shape import ring_shape

    shape = ring_shape(load_scene(ROOT / "examples" / "minimal.toml").bearing, inner)
    return shape if land is None else attrs.evolve(shape, land=land)


def _small(inner: bool) -> Profile:
    return graded_profile(_shape(inner), 0.4e-3, (0.0, 0.55), 1e-3, 2e-3)


def _full() -> list[Row]:
    """Against meshes swept into three dimensions, assembled by HexOperator.stiffness and factorised as they are."""
    from validation.reference.swept import Swept

    typed, out = "pytest tests/revolution/test_compliance.py", []

    def worst(body: Revolution, solve: Any, swept: Swept) -> float:
        race = body.profile.race
        at = dofs(race, ALL)
        found = body.compliance(at, at, harmonics="all")
        differences = []
        for component in ALL:
            full = swept.seen(solve(swept.force(int(race[1]), component)), race)
            column = found[:, :, component * len(race) + 1]
            differences.append(float(np.abs(full - column).max() / np.abs(full).max()))
        return max(differences)

    for inner in (True, False):
        profile, word = _small(inner), "inner" if inner else "outer"
        for formulation in ("incompatible", "full", "one_point"):
            swept = Swept(profile, 36, formulation)
            found = worst(Revolution(profile, 36, *STEEL, formulation), swept.clamped, swept)
            what = f"{word} ring clamped, {formulation}: difference from the full solve, loads along r, theta and x"
            out.append(below(what, found, 1e-10, typed, f"{len(profile.quads) * 36} elements"))
    profile, bed = _small(False), 5e11
    swept, areas = Swept(profile, 36), seat_areas(profile, 36)
    found = worst(Revolution(profile, 36, *STEEL, seat=bed), lambda f: swept.bedded(f, areas, bed), swept)
    out.append(below("outer ring on a bed of 500 N/mm3: difference from the full solve", found, 1e-10, typed))
    ball = ball_profile(4.7625e-3, 0.5e-3, 1e-3, 1e-3, 1.6e-3)
    swept = Swept(ball, 24)
    found = worst(Revolution(ball, 24, *STEEL, seat="free"), swept.floating, swept)
    note = "rigid motions held by constraints, no shift: equal to rounding"
    out.append(below("floating ball: difference from a constrained full solve", found, 2e-5, typed, note))
    return out


def _reciprocity() -> list[Row]:
    out = []
    for word, profile, seat in (("inner ring", _small(True), "clamped"), ("ball", _ball(4)[0], "free")):
        at = dofs(profile.race, ALL)
        both = Revolution(profile, 60, *STEEL, seat=seat).compliance(at, at, np.array([2, -2]))
        found = float(np.abs(both[0] - both[1].T).max() / np.abs(both).max())
        out.append(below(f"{word}: reciprocity", found, 1e-12, "pytest tests/revolution/test_compliance.py"))
    return out


def _sizes(nodes: int) -> tuple[float, int, float, float, int, int]:
    """Ball radius, sectors of the ball, steps along and across the groove, half cells of the patch along and across."""
    from raceway import load_scene
    from raceway.core.contact.geometry import BallBearing
    from raceway.core.contact.hertz import contact_modulus

    b = load_scene(ROOT / "examples" / "minimal.toml").bearing
    row = BallBearing(
        b.ball_diameter, b.pitch_diameter, b.ball_count, b.contact_angle, b.conformity_inner, b.conformity_outer
    )
    inner, outer = row.ellipses(contact_modulus(STEEL[0], STEEL[1], STEEL[0], STEEL[1]))
    radius = 0.5 * b.ball_diameter
    long, short = (float(axis) for axis in inner.semi_axes(LOAD))
    sectors = 2 * round(pi * radius * nodes / long)
    step, across = 2.0 * pi * radius / sectors, short / nodes
    reach = ceil(1.2 * float(inner.semi_axes(HIGHEST)[0]) / step), ceil(1.2 * float(outer.semi_axes(HIGHEST)[1]) / across)
    return radius, sectors, step, across, *reach


def _ball(nodes: int) -> tuple[Profile, int, np.ndarray]:
    radius, sectors, step, across, along, wide = _sizes(nodes)
    offsets = np.concatenate([np.arange(2 * along + 1), sectors // 2 - np.arange(along + 1)])
    return ball_profile(radius, across, wide * across, min(step, across), BULK), sectors, offsets


def _ring(nodes: int, inner: bool) -> tuple[Profile, int, np.ndarray]:
    _, _, step, across, along, wide = _sizes(nodes)
    shape = _shape(inner)
    rolling = shape.centre_r + shape.sign * shape.groove * cos(shape.contact)
    sectors = 12 * round(2.0 * pi * rolling / across / 12)
    reach = (along + 1) * step / shape.groove
    window = np.deg2rad(13.5) - reach, np.deg2rad(20.5) + reach
    return graded_profile(shape, step, window, min(step, across), BULK), sectors, np.arange(2 * wide + 1)


def _sampling() -> list[Row]:
    """Few of the nodes, all of the harmonics."""
    out = []
    for inner, seat in ((True, "clamped"), (False, 5e11)):
        profile, sectors, offsets = _ring(4, inner)
        body = Revolution(profile, sectors, *STEEL, seat=seat)
        at = dofs(profile.race[::4], ALL)
        offsets = np.concatenate([offsets, [sectors // 12, sectors // 6]])
        every, sampled = (body.compliance(at, at, offsets, which) for which in ("all", "sampled"))
        found = float(np.abs(every - sampled).max() / np.abs(every).max())
        what = (
            f"{'inner ring clamped' if inner else 'outer ring on a bed'}, {sectors} sectors: sampled harmonics against all"
        )
        out.append(below(what, found, 1e-5, COMMAND))
    profile, sectors, offsets = _ball(4)
    body = Revolution(profile, sectors, *STEEL, seat="free")
    at = dofs(profile.race[::2], ALL)
    every, sampled = (body.compliance(at, at, offsets, which) for which in ("all", "sampled"))
    found = float(np.abs(every - sampled).max() / np.abs(every).max())
    note = "told: balls are solved with all harmonics, because near half the number of sectors sampling is least exact"
    out.append(Row(f"ball, {sectors} sectors: sampled against all, were it used", found, "told", True, COMMAND, note))
    return out


def _frequencies() -> list[Row]:
    """The first elastic frequencies of rings with shoulders at 41.2 and 51.8 mm, elements of 0.5 mm."""
    out = []
    for inner, seat, expected, word in (
        (True, "free", (10.53, 2), "inner ring, free"),
        (True, "clamped", (132.9, 1), "inner ring, bore tied"),
        (False, "clamped", (159.0, 0), "outer ring, cylinder clamped"),
        (False, "free", (3.69, 2), "outer ring, free"),
    ):
        shape = _shape(inner, 20.6e-3 if inner else 25.9e-3)
        size = 0.5e-3
        divisions = 12 * round(2.0 * pi * (18e-3 if inner else 28e-3) / size / 12)
        found = Revolution(coarse_profile(shape, size, size), divisions, *STEEL, seat=seat).frequencies(range(6), 2)
        lowest = np.unravel_index(np.argmin(found), found.shape)
        note = f"harmonic {lowest[0]}, expected in {expected[1]}; tolerance: mesh, h = 1 to 0.5 mm moves it by up to 0.8 %"
        row = near(f"{word}: lowest elastic frequency, kHz", 1e-3 * found.min(), expected[0], 0.01, COMMAND, note)
        out.append(attrs.evolve(row, ok=row.ok and int(lowest[0]) == expected[1]))
    radius = 4.7625e-3
    found = Revolution(ball_profile(radius, 0.4e-3, 0.4e-3, 0.4e-3, 0.4e-3), 72, *STEEL, seat="free").frequencies(
        range(4), 2
    )
    wave = np.sqrt(STEEL[0] / (2.0 * (1.0 + STEEL[1])) / STEEL[2])
    note = "Lamb's lowest torsional mode of a sphere, 2.501 c_s / R; lumped masses and the hole on the axis remain"
    out.append(
        near("ball: lowest elastic frequency, kHz", 1e-3 * found.min(), 1e-3 * _torsion() * wave / (2 * pi * radius), 0.01,
             COMMAND, note)
    )  # fmt: skip
    return out


def _torsion() -> float:
    """The lowest root of j_2(x) = x j_3(x): torsional vibration of a free sphere (Lamb 1881)."""
    from scipy.optimize import brentq
    from scipy.special import spherical_jn

    return float(brentq(lambda x: spherical_jn(2, x) - x * spherical_jn(3, x), 2.0, 3.0))


#: In a process of its own with an empty cache of compliances: CPU seconds, memory, equal entries the second time.
BUILD = """
import json, sys, time
from pathlib import Path
from raceway.storage import array_cache
array_cache.folder = lambda: Path(sys.argv[2])
from benchmarks.evidence.condensed_bodies import set_up

def peak():  # of this program alone: ru_maxrss would hand on what its parent took
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return 1024 * int(line.split()[1])

set_up(1)
before = peak()
found = []
for _ in range(2):
    begin = time.process_time()
    parts = set_up(int(sys.argv[1]))
    found.append(time.process_time() - begin)
memory = peak()
print(json.dumps({"first": found[0], "second": found[1], "parts": parts, "memory": memory, "before": before}))
"""


def set_up(nodes: int) -> dict[str, Any]:
    """Compliances of a whole bearing's bodies, ball and two rings, all three components."""
    from raceway.core.revolution.ball import free_ball
    from raceway.core.revolution.cached import cached_compliance

    radius, sectors, step, across, _, wide = _sizes(nodes)
    ball = free_ball(
        radius, STEEL[1], sectors, across, wide * across, min(step, across), BULK, _ball(nodes)[2], components=ALL
    )
    elements, size = ball.elements, ball.dimensionless.nbytes
    for inner in (True, False):
        profile, divisions, offsets = _ring(nodes, inner)
        at = dofs(profile.race, ALL)
        found = cached_compliance("ring", profile, divisions, STEEL[0], STEEL[1], at, at, offsets)
        elements, size = elements + divisions * len(profile.quads), size + found.nbytes
    return {"elements": elements, "bytes": size}


def _cost() -> list[Row]:
    import tempfile

    out = []
    for nodes, limit in ((4, 5.0), (8, 20.0)):
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, "-c", BUILD, str(nodes), folder]
            done = json.loads(subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout)
        note = f"{done['parts']['elements'] / 1e6:.1f} million elements' worth; all three components, of which pressures need two and friction the third"
        word = f"{nodes} nodes per semi-axis"
        out += [
            below(f"{word}: set-up of ball and rings, CPU seconds", done["first"], limit, COMMAND, note),
            below(f"{word}: again from the cache, CPU seconds", done["second"], 0.3, COMMAND),
            below(
                f"{word}: peak memory, GiB", done["memory"] / 2**30, 0.8, COMMAND,
                f"{done['before'] / 2**30:.2f} GiB of it are Python, its packages and a first small body; kept: {done['parts']['bytes'] / 2**20:.1f} MiB",
            ),
        ]  # fmt: skip
    return out
