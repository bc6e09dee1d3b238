"""Outcome of a claim's rule, and the verdict that follows."""

import attrs

from raceway.extend import ReadTables, Tables
from raceway_article.design import TILT_WORDS

#: A change below this over the whole range neither rises nor falls.
LEVEL = 0.005


@attrs.frozen
class Finding:
    """Outcome of a rule for one model, load or speed.

    at : which friction, tilt, inertia, bodies, load [N] and speed [r/min]
    holds : None where it could not be judged, with the reason in ``why``
    value : the number that the rule looks at
    """

    at: ReadTables
    holds: bool | None
    value: float | None = None
    why: str = ""


HOLDS, PARTLY, NOT, FAILED, UNTESTED = "holds", "holds only for", "does not hold", "failed", "cannot be tested"
#: Kind of a verdict -> tone of its cell on a page, words after a count, and its one word in tables.
KINDS = {
    HOLDS: ("good", "hold", "holds"),
    PARTLY: ("partly", "hold only in a region", "partly"),
    NOT: ("bad", "do not hold", "no"),
    FAILED: ("failed", "failed", "failed"),
    UNTESTED: ("partly", "cannot be tested", "untested"),
}
#: Words of ``where`` at most.
_MOST_WORDS = 15
#: How every rule treats numbers that are missing; the rules do it, this tells the reader.
BRIDGED = "unstable motions between the ends are left out, a failed run leaves no judgement"


@attrs.frozen
class Verdict:
    """A claim, or one reading of it.

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
    def where(self) -> str:
        """Where it holds in few words: the region, or of a longer one in how many runs at each tilt."""
        if len(self.region.split()) <= _MOST_WORDS:
            return {HOLDS: "everywhere", NOT: "nowhere", UNTESTED: "its data are lost"}.get(self.kind, self.region)
        parts = []
        for tilt in dict.fromkeys(finding.at["tilt"] for finding in self.findings):
            outcomes = [finding.holds for finding in self.findings if finding.at["tilt"] == tilt]
            parts.append(f"{TILT_WORDS[tilt].removeprefix('tilt ')} {sum(map(bool, outcomes))} of {len(outcomes)}")
        return f"tilt {', '.join(parts)}"

    def row(self) -> Tables:
        """As a row of a flat table."""
        words = f"{self.kind} {self.region}" if self.region else self.kind
        plain = attrs.asdict(self, filter=lambda field, _: field.name != "findings")
        return {**plain, "verdict": words, "where": self.where}

    def to_dict(self) -> Tables:
        return {**self.row(), "findings": [attrs.asdict(finding) for finding in self.findings]}
