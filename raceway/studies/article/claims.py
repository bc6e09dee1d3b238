"""The article's claims: what each asks, the rule that decides, what was computed, and the verdict that follows.

No claim is fitted: a verdict is what its rule says of the numbers, and the rules know nothing of what is wanted.  Claims 1 to 3
are here, 4 and 6 in ``claims_rotating``, 5 in ``claims_axial``; 4 to 6 are judged for K and for |Z|, of which the article does not
say which one its stiffness is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from raceway.storage.tables import ReadTables
from raceway.studies.article.claims_axial import axial
from raceway.studies.article.claims_rotating import both, hardening
from raceway.studies.article.curves import MEASURES, ONE_WAY, Curves
from raceway.studies.article.design import Setting
from raceway.studies.article.regions import Finding, by_tilt
from raceway.studies.article.rules import LEVEL, course
from raceway.studies.article.verdict import BRIDGED, FAILED, UNTESTED, Verdict, judge

#: What the text of the article gives.
LARGEST_DEVIATION, HEAVIEST_DEVIATION = 0.0242, 0.0033


def verdicts(curves: Curves, static: Sequence[ReadTables]) -> list[Verdict]:
    """Every claim.

    Parameters
    ----------
    static : rows of the static verification, as ``raceway verify`` gives them
    """
    out = [*_static(static), _rig(), *_one_way(curves)]
    for measure in MEASURES:
        out += [*hardening(curves, measure), *axial(curves, measure), *both(curves, measure)]
    # Each claim for K, and at once for |Z|.
    return sorted(out, key=lambda one: one.number[0])


def _static(rows: Sequence[ReadTables]) -> list[Verdict]:
    """The load cases are lost: there is nothing to hold the article's percentages against, only ours to report."""
    pressures = [row for row in rows if not row["quantity"].startswith("mesh independence")]
    heaviest = [row for row in pressures if "inner" in row["quantity"] and "2000 N axial" in row["quantity"]]
    parts = (
        ("1a", f"Static peak pressures are within {LARGEST_DEVIATION:.2%} of exact Hertz in four load cases.", pressures,
         "largest deviation of the peak pressures in four load cases of our own"),
        ("1b", f"In the heaviest case the inner race's is within {HEAVIEST_DEVIATION:.2%}.", heaviest,
         "deviation of the inner race's peak pressure at 2000 N axial, the heaviest of ours"),
    )  # fmt: skip
    out = []
    for number, claim, taken, words in parts:
        known = [row["error"] for row in taken if row["error"] is not None]
        kind = UNTESTED if known or not taken else FAILED
        text = f"{words}: {max(known):.2%}" if known else "no number"
        failed = next((row["note"] for row in taken if row["error"] is None), "")
        rule = "none: the load cases are not in the text that is left of the article, so that no case can be computed again"
        out.append(Verdict(number, claim, rule, text, kind, failed=failed))
    return out


def _rig() -> Verdict:
    return Verdict(
        "2",
        "Stiffness is within 9.12 % of the rig's.",
        "none: the table of measured stiffnesses is not in the text that is left of the article",
        "K at the rig's speeds and loads is reported in a table of its own",
        UNTESTED,
    )


def over_speed(curves: Curves, excitation: ReadTables, measure: str, judged: Callable[..., bool | None]) -> list[Finding]:
    """A rule of (values, errors, failed) for curves over speed, at every way to model and every load; the value is k*(1)."""
    found = []
    for model in curves.design.models():
        setting = Setting(**excitation, **model)
        for load in curves.design.loads_of(setting):
            values, errors = curves.values(setting, load, measure), curves.errors(setting, load)
            ratio = values[-1] / values[0]
            outcome = judged(values, errors, curves.failed(setting, load))
            why = curves.why_not(setting, load) if outcome is None else ""
            found.append(Finding({**model, "load": load}, outcome, float(ratio) if np.isfinite(ratio) else None, why))
    return found


def _one_way(curves: Curves) -> list[Verdict]:
    rule = (
        f"unidirectional force, constant amplitude: falls at every step of the speed, and by at least {LEVEL:.1%} over the range; "
        f"{BRIDGED}"
    )

    def falls(values: np.ndarray, errors: np.ndarray, failed: np.ndarray) -> bool | None:
        found = course(values, errors, failed)
        return None if found is None else found == "falls"

    out = []
    for letter, measure, words in (("a", "K", "K = Re Z + m w²"), ("b", "|Z|", "|Z|, which holds the inertia of the mass")):
        found = over_speed(curves, ONE_WAY, measure, falls)
        text = f"k*(w* = 1): {by_tilt(found)}"
        claim = f"Unidirectional: the radial stiffness falls with speed; k = {words}."
        out.append(judge(f"3{letter}", claim, rule, text, found))
    return out
