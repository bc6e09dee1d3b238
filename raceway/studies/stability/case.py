"""Cases, and the rows that they write: a number beside its limit, or a message that must come."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import attrs

from raceway.errors import RacewayError
from raceway.storage.tables import Tables

AS_EXPECTED, FAILED = "as expected", "failed"
_LONGEST = 200
#: A value, or a value and the drift of the energy.
Measured = float | tuple[float, float | None]


@attrs.frozen
class Case:
    """One place of the catalogue; small enough to be sent to another process.

    Attributes
    ----------
    name : what its rows are called by
    measure : ``module:function``, a module of this folder or a whole path, called as ``function(rows, registry, **arguments)``
    setting : law, integrator, what else was varied;  arguments : plain values
    quick : whether it belongs to what is run unless all is asked for
    """

    name: str
    measure: str
    setting: Tables = attrs.field(factory=dict)
    arguments: Tables = attrs.field(factory=dict)
    quick: bool = True


@attrs.frozen
class Row:
    """One line of the report.

    Attributes
    ----------
    setting : integrator, law, step, what else was varied
    quantity : what ``predicted`` and ``observed`` are, with the unit
    expected : the expectation in words, its bound in it
    energy_drift : change of the energy over the motion's energy; None where it is not balanced
    reason : why the bound is what it is
    note : why the row failed, or what one should know
    """

    case: str
    setting: Tables
    quantity: str
    expected: str
    predicted: float | None
    observed: float | None
    energy_drift: float | None
    verdict: str
    reason: str
    note: str = ""


@attrs.frozen
class Rows:
    """What a case writes: its name, the setting of all its rows, the rows so far."""

    case: str
    setting: Tables = attrs.field(factory=dict)
    written: list[Row] = attrs.field(factory=list)

    def check(
        self,
        quantity: str,
        value: Measured | Callable[[], Measured],
        why: str,
        *,
        near: float | None = None,
        within: float = 0.0,
        at_most: float | None = None,
        at_least: float | None = None,
        at: Tables | None = None,
        note: str = "",
    ) -> Row:
        """A number against ``near``, relatively ``within``, or a bound; an error of a function, or no number, fails.

        Parameters
        ----------
        why : the reason of the limit;  at : setting of this row alone
        """
        least, most = at_least, at_most
        if near is not None:
            words, least, most = f"equal within {within:.2g}", near - within * abs(near), near + within * abs(near)
        else:
            words = f"at least {at_least:.3g}" if at_most is None else f"at most {at_most:.3g}"
        observed = drift = None
        try:
            given = value() if callable(value) else value
            observed, drift = given if isinstance(given, tuple) else (given, None)
            if not all(math.isfinite(each) for each in (observed, drift or 0.0)):
                note, observed, drift = f"not a number: {observed}, energy {drift}", None, None
        except RacewayError as error:
            note = f"refused, unexpectedly: {short(error)}"
        good = observed is not None and (least is None or observed >= least) and (most is None or observed <= most)
        return self._write(at, quantity, words, near, observed, drift, good, why, note)

    def refused(self, words: str, why: str, work: Callable[[], object], at: Tables | None = None) -> Row:
        """What must be refused, with a message that holds ``words``."""
        good, note = False, "it was computed instead"
        try:
            work()
        except RacewayError as error:
            good, note = words in str(error), short(error)
        return self._write(at, "message", f"refused: '{words}'", None, None, None, good, why, note)

    def warned(self, words: str, why: str, warnings: Iterable[str]) -> Row:
        """A warning that holds ``words``."""
        found = next((text for text in warnings if words in text), None)
        note = found or "no such warning"
        return self._write(None, "warning", f"warned: '{words}'", None, None, None, found is not None, why, note)

    def lost(self, why: str, at: Tables | None = None) -> Row:
        """A case, or a part of it, that ended without an answer."""
        return self._write(at, "answer", "an answer or a refusal", None, None, None, False, "", why)

    def _write(
        self, at: Tables | None, quantity: str, words: str, near: float | None, value: float | None, drift: float | None,
        good: bool, why: str, note: str,
    ) -> Row:  # fmt: skip
        setting, number = {**self.setting, **(at or {})}, None if value is None else float(value)
        verdict = AS_EXPECTED if good else FAILED
        self.written.append(Row(self.case, setting, quantity, words, near, number, drift, verdict, why, note))
        return self.written[-1]


def short(error: BaseException) -> str:
    """The first line of a message, not too long for a table."""
    text = (str(error).splitlines() or [type(error).__name__])[0]
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."
