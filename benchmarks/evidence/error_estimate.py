"""The error that a result states against its true error, over 30 varied scenes, hard ones among them."""

from __future__ import annotations

from benchmarks.evidence import Row
from raceway.errors import ConvergenceError
from validation.error_estimate import CASES, FACTOR, SMALL, judge, right

TITLE = "Estimated against true error of the dynamic stiffness"
COMMAND = "python -m benchmarks.evidence error_estimate"


def rows() -> list[Row]:
    found, good, wrong = [], 0, list[str]()
    limit = f"a third of to {FACTOR:g} times the true error, or both below {SMALL:g}"
    for one in CASES:
        try:
            estimate, true, bound = judge(one)
        except ConvergenceError as why:
            wrong.append(one.name)
            found.append(Row(one.name, "no result", limit, False, COMMAND, str(why)))
            continue
        ok = right(estimate, true)
        good += ok
        note = f"true value known to {bound:.1g}" if bound > 0.1 * true else ""
        if not ok:
            wrong.append(one.name)
            note += f"{'; ' if note else ''}{estimate / true:.2g} of the true error"
        found.append(Row(one.name, f"{estimate:.2g} against {true:.2g}", limit, ok, COMMAND, note))
    words = f"not right: {', '.join(wrong)}" if wrong else ""
    found.append(Row("scenes whose estimate is right", f"{good} of {len(CASES)}", "all", good == len(CASES), COMMAND, words))
    return found
