"""Stability: stiff and extreme cases.

The limits are those of the cases themselves; a row here is the worst of theirs.
"""

from pathlib import Path

import pytest
from raceway_checks.stability.catalogue import catalogue
from raceway_checks.stability.study import PROCESSES, measured, stability

from raceway.extend import registry_with, written

pytestmark = pytest.mark.night
#: Finished cases are kept here and beside it, as the command keeps them.
KEPT = Path("raceway-out") / "stability"
FOREIGN = [Path(__file__).parents[4] / "tests" / f"{name}.py" for name in ("cubic_law", "hunt_crossley")]
#: Rows that are not as expected.
KNOWN = {
    "axial load 1 N under 50 N rotating: rattling": "balls meet the races ever differently: |Z| hangs on the step, as its stated error says",
    "elastic bodies: Poisson's ratio 0.4999": "work of pressures along the deformed race's slope is in no energy, 9 % where elements lock",
}
CLOSED, OWN = "closed form", "own other method"


def off(row):
    return abs(row.observed / row.predicted - 1.0)


def test_quick_cases(claim):
    study = stability(processes=0)
    quantity = f"{study.cases} quick cases: rows that are not as expected"
    claim(quantity, len(study.failed), at_most=0, basis=OWN, source=f"limits of {len(study.rows)} rows, with their reasons")
    source = "`raceway stability` within a minute of one core, kernels compiled"
    claim("quick cases: processor time", study.cpu_s, at_most=60.0, unit="s", basis="regression", source=source)


def test_all_cases(claim):
    study = stability(every=True, kept=KEPT)
    failed = [row for row in study.rows if row.verdict == "failed"]
    source = f"limits of {len(study.rows)} rows of {study.cases} cases"
    quantity = "rows that are not as expected"
    claim(quantity, len(failed), at_most=0, basis=OWN, source=source, misses="the rows of two cases below")
    for name, why in KNOWN.items():
        count = sum(row.case == name for row in failed)
        of = sum(row.case == name for row in study.rows)
        quantity = f"{name}: rows of {of} that are not as expected"
        claim(quantity, count, at_most=0, basis=OWN, source="limits of the rows", misses=why)
    others = [row for row in failed if row.case not in KNOWN]
    assert not others, others[:5]
    claim("all other cases: rows that are not as expected", len(others), at_most=0, basis=OWN, source=source)
    rows = [row for row in study.rows if row.case not in KNOWN and row.observed is not None]
    _steps(claim, rows)
    _energy(claim, rows)
    for words, limit, basis, source in (
        ("|Z| [N/m], predicted by the steady motion", 0.01, OWN, "12 turns of 360 steps leave 0.1 %; ten times that"),
        ("|Z| [N/m], predicted by 1440 steps a turn", 0.01, OWN, "360 steps a turn cost a few 1e-3 where balls rattle"),
        ("axial displacement [m]", 1e-6, CLOSED, "the law's own force, inverted for one ball by bisection"),
        ("sum of the balls' axial forces [N]", 1e-8, CLOSED, "equilibria are solved to a residual of 1e-11"),
        ("lengthening [m]", 1e-5, CLOSED, "constant strain is exact in every element; condition of the matrix"),
    ):
        found = [off(row) for row in rows if row.quantity == words and "surface points" not in row.case]
        quantity = f"{words.partition(' [')[0]}, {len(found)} rows of extreme scenes: largest relative error"
        quantity += words.partition("]")[2]
        claim(quantity, max(found), at_most=limit, basis=basis, source=source)


def _steps(claim, rows):
    for words in ("linear", "small motions of the bearing"):
        limits = [
            row for row in rows if row.case == f"steps around the limit, {words}" and row.quantity == "stable limit [s]"
        ]
        quantity = f"observed over predicted stable step, less 1: {words}"
        source = f"2 / w_max with the law's damping, {len(limits)} limits, bisected to 1e-3"
        claim(quantity, max(map(off, limits)), at_most=0.02, basis=CLOSED, source=source)
    orbits = [row for row in rows if row.case == "orbit at the safe limit"]
    opened = sum(row.setting["contacts open"] for row in orbits)
    quantity = "steps of the safe limit: distance from the steady orbit in turn 50 over its size"
    source = f"{len(orbits)} orbits, {opened} with lift-off; an unstable motion leaves by many times the size"
    claim(quantity, max(row.observed for row in orbits), at_most=0.5, basis=OWN, source=source)


def _energy(claim, rows):
    trends = [row for row in rows if row.case == "undamped steps" and row.setting["steps"] == 1_000_000]
    for name in sorted({row.setting["integrator"] for row in trends}):
        for words, bound in (("all contacts stay closed", 1e-6), ("contacts open", 1e-3)):
            found = [row.observed for row in trends if row.setting["integrator"] == name and row.note == words]
            quantity = f"energy's trend in a million steps, {name}, {words}"
            source = f"conserved, or lost as the method is made to; {len(found)} laws"
            claim(quantity, max(found), at_most=bound, basis=CLOSED, source=source)
    falls = [row for row in rows if row.case == "chatter"]
    for name, step in sorted({(row.setting["integrator"], row.setting["step/period"]) for row in falls}):
        found = [row.observed for row in falls if (row.setting["integrator"], row.setting["step/period"]) == (name, step)]
        quantity = f"contact chatter, {name}, step/period {step:g}"
        if (name, step) == ("newmark", 1.0):
            source = "the known fault of average acceleration; each step solved by bisection shows it, too"
            claim(quantity, min(found), at_least=0.1, basis=OWN, source=source)
        else:
            claim(quantity, max(found), at_most=1e-3, basis=CLOSED, source="a damped mass comes to rest")


@pytest.mark.parametrize("law", ["cubic", "hunt_crossley"])
def test_a_third_partys_law(claim, law):
    registry = registry_with(FOREIGN)
    cases = [one for one in catalogue(registry) if one.setting.get("law") == law]
    with written(KEPT) as store:
        rows, _ = measured(cases, PROCESSES, registry, store, FOREIGN)
    failed = [row for row in rows if row.verdict == "failed"]
    assert not failed, failed[:5]
    quantity = f"tests/{law}.py, {len(cases)} cases: rows that are not as expected"
    claim(quantity, len(failed), at_most=0, basis=OWN, source=f"limits of {len(rows)} rows, from the law's own force")
