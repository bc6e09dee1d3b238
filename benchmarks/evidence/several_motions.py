"""Several steady motions under one force: which one is taken, what is told, and whether two integrators agree."""

from __future__ import annotations

import os
import time
from collections import Counter

import numpy as np

from benchmarks.evidence import Row, below
from benchmarks.evidence._crossed import Pair, compared
from raceway import scene_from_dict
from raceway.pipeline.result import Result
from raceway.pipeline.run import run
from validation.several import Tables, article, by_integration, heavy

TITLE = "Several steady motions"
COMMAND = "python -m benchmarks.evidence several_motions"
#: Scenes of a whole run; the environment may ask for fewer, and the report says how many there were.
COUNT = int(os.environ.get("RACEWAY_CROSSED_SCENES", "700"))
WANTED = 700
#: Distance of two answers over the sum of their stated errors.
_MOST = 3.0


def rows() -> list[Row]:
    return [*_taken(), *_told(), *_crossed()]


def _solved(tables: Tables) -> Result:
    return run(scene_from_dict(tables))


def _taken() -> list[Row]:
    """The motion that is taken, against a turn by DOP853 that begins on it and must close."""
    out = []
    for name, damping, tables in (
        ("82 kg, 5000 N s/m", 5000.0, lambda **own: heavy(82.0, **own)),
        ("82 kg, no damping", 0.0, lambda **own: heavy(82.0, 0.0, **own)),
        ("article, 1000 N, tilt free, force of one direction", 0.0, lambda **own: article(1000.0, **own)),
    ):
        direct, by_time = _solved(tables(kind="periodic", tolerance=1e-9)), _solved(tables())
        z = direct.identification.dynamic_stiffness
        wanted, multiplier, gap = by_integration(direct, damping)
        note = f"Z = {1e-6 * z:.6g} N/um; largest multiplier {multiplier:.6f}; the turn closes to {gap:.1e} of its amplitude"
        out.append(
            below(f"{name}: Z by 'periodic' against an integration of its own", abs(z / wanted - 1.0), 1e-6, COMMAND, note)
        )
        out.append(
            below(f"{name}: growth of disturbances a turn, by that integration, less 1", multiplier - 1.0, 1e-5, COMMAND)
        )
        off = abs(by_time.identification.dynamic_stiffness - z) / abs(z)
        note = f"off by {off:.2g}, stated {by_time.error['total']:.2g}; 12 turns of 360 steps"
        out.append(
            below(f"{name}: error of 'newmark' over the stated one", off / by_time.error["total"], _MOST, COMMAND, note)
        )
    return out


def _told() -> list[Row]:
    out = []
    for kind in ("periodic", "newmark"):
        found = _solved(heavy(80.0, kind=kind))
        lasting = [one for one in found.simulation.orbits if one["stable"]]
        z = ", ".join(
            f"{1e-6 * complex(one['dynamic_stiffness']['real'], one['dynamic_stiffness']['imag']):.5g}" for one in lasting
        )
        out.append(
            Row(f"80 kg, 5000 N s/m, '{kind}': stable motions told", len(lasting), "2", len(lasting) == 2, COMMAND, z)
        )
    found = _solved(article(500.0))
    told = found.simulation.orbits[0]
    warned = any("unstable" in text for text in found.warnings)
    out.append(Row("article, 500 N, 'newmark': multiplier of the orbit that it starts on", told["multiplier"], "told with a warning",
                   warned and not told["stable"], COMMAND))  # fmt: skip
    closed = _solved(article(800.0, kind="periodic", tolerance=1e-9))
    z, multiplier, gap = by_integration(closed, 0.0)
    first = closed.simulation.orbits[0]["stable"]
    out.append(below("article, 800 N, 'periodic': distance of a turn's end from its beginning, by integration, over the amplitude", gap,
                     1e-10, COMMAND, f"Re Z = {1e-6 * z.real:.5g} N/um, multiplier {multiplier:.6f}, {'' if first else 'not '}the stable one of {len(closed.simulation.orbits)} told"))  # fmt: skip
    return out


def _crossed() -> list[Row]:
    begin = time.process_time()
    pairs = [compared(number) for number in range(COUNT)]
    spent = time.process_time() - begin
    row = Row("random scenes, each by two integrators", COUNT, f"at least {WANTED}", COUNT >= WANTED, COMMAND,
              f"{spent:.0f} s of processor time")  # fmt: skip
    return [row, *crossed_rows(pairs)]


def crossed_rows(pairs: list[Pair]) -> list[Row]:
    """Rows of the pairs without and with friction."""
    out = []
    for words, share, some in (
        ("without friction", 0.99, [pair for pair in pairs if pair.friction == 0.0]),
        ("with friction 0.03 to 0.3, from different starts", 0.95, [pair for pair in pairs if pair.friction > 0.0]),
    ):
        judged = [pair for pair in some if pair.apart is not None]
        beyond = [pair for pair in judged if pair.apart > _MOST]
        silent = [pair for pair in beyond if not pair.told]
        good, none = len(judged) - len(silent), [pair for pair in some if pair.apart is None]
        out += [
            Row(f"pairs {words}: apart by at most three times the sum of their stated errors, or told as several motions",
                f"{good} of {len(judged)}", f"at least {share:.0%}", good >= share * len(judged) > 0, COMMAND,
                "; ".join(_one(pair) for pair in silent)),
            Row(f"pairs {words}: further apart, and told as several motions", len(beyond) - len(silent), "reported", True, COMMAND),
            Row(f"pairs {words}: distance over the sum of the stated errors; median, 99 % where nothing is told", _spread(judged),
                "reported", True, COMMAND),
            Row(f"pairs {words}: one of the two failed or states no error", f"{len(none)} of {len(some)}", "reported", True,
                COMMAND, _reasons(none)),
        ]  # fmt: skip
    return out


def _one(pair: Pair) -> str:
    return f"scene {pair.number}: {pair.words}, {pair.apart:.3g}"


def _spread(judged: list[Pair]) -> str:
    values = [pair.apart for pair in judged if not pair.told]
    return ", ".join(f"{value:.2g}" for value in np.percentile(values, (50.0, 99.0))) if values else "none"


def _reasons(pairs: list[Pair]) -> str:
    """How often each beginning of a reason occurs."""
    found = Counter(" ".join(pair.why.split(": ", 1)[-1].split()[:8]) for pair in pairs)
    return "; ".join(f"{count} x {why}" for why, count in found.most_common(6))
