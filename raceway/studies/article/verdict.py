"""A verdict and how it follows from what a rule finds at every place."""

from __future__ import annotations

from collections.abc import Sequence

import attrs

from raceway.storage.tables import Tables
from raceway.studies.article.regions import Finding, where

HOLDS, PARTLY, NOT, FAILED, UNTESTED = "holds", "holds only for", "does not hold", "failed", "cannot be tested"
#: What every rule does with numbers that are missing; the rules do it, here it is said.
BRIDGED = "unstable motions between the ends are left out, a failed run leaves no judgement"


@attrs.frozen
class Verdict:
    """A claim, or one reading of it.

    Attributes
    ----------
    number : of the claim, with a letter where it has several parts or readings, and "|Z|" where that is taken for the stiffness
    claim, rule, computed : in words
    kind : one of HOLDS, PARTLY, NOT, FAILED, UNTESTED
    region : where it holds, of PARTLY
    failed : where runs failed or their motion is unstable, with the first reason; "" where none
    """

    number: str
    claim: str
    rule: str
    computed: str
    kind: str
    region: str = ""
    failed: str = ""
    findings: tuple[Finding, ...] = ()

    @property
    def words(self) -> str:
        return f"{self.kind} {self.region}" if self.region else self.kind

    def to_dict(self) -> Tables:
        plain = attrs.asdict(self, filter=lambda field, _: field.name != "findings")
        return {**plain, "verdict": self.words, "findings": [one.to_dict() for one in self.findings]}


def judge(number: str, claim: str, rule: str, computed: str, findings: Sequence[Finding]) -> Verdict:
    """The verdict that follows from a rule's outcome at every place.

    Notes
    -----
    Failed places never count as holding: with one of them a claim that holds everywhere else holds only for the rest.
    """
    judged = [one for one in findings if one.holds is not None]
    failed = ""
    if len(judged) < len(findings):
        reason = next(one.why for one in findings if one.holds is None)
        failed = f"{where(findings, None)} (the first reason: {reason or 'a run is missing'})"
    if not judged:
        kind = FAILED
    elif not any(one.holds for one in judged):
        kind = NOT
    else:
        kind = HOLDS if all(one.holds for one in findings) else PARTLY
    region = where(findings, True) if kind == PARTLY else ""
    return Verdict(number, claim, rule, computed, kind, region, failed, tuple(findings))
