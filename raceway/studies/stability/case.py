"""A case of the catalogue of stiff and extreme cases, and what is expected of it."""

from __future__ import annotations

import math
from collections.abc import Callable

import attrs

from raceway.errors import RacewayError
from raceway.storage.tables import Tables

AS_EXPECTED, FAILED = "as expected", "failed"
_LONGEST = 200


@attrs.frozen
class Case:
    """One place of the catalogue; small enough to be sent to another process.

    Attributes
    ----------
    name : what a row is called by
    measure : ``module:function``, a module of ``raceway.studies`` or a whole path, called as ``function(case, registry)``; returns rows
    arguments : what the function needs, plain values
    weight : seconds that it takes, roughly: the longest are begun first
    """

    name: str
    measure: str
    arguments: Tables = attrs.field(factory=dict)
    weight: float = 1.0


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
class Near:
    """The observed value equals the predicted one."""

    relative: float
    reason: str

    def words(self, predicted: float | None) -> str:
        return f"equal within {self.relative:.2g}"

    def holds(self, predicted: float | None, observed: float) -> bool:
        return predicted is not None and abs(observed - predicted) <= self.relative * abs(predicted)


@attrs.frozen
class AtMost:
    """The observed value stays below a bound."""

    bound: float
    reason: str

    def words(self, predicted: float | None) -> str:
        return f"at most {self.bound:.3g}"

    def holds(self, predicted: float | None, observed: float) -> bool:
        return observed <= self.bound


@attrs.frozen
class AtLeast:
    """The observed value passes a bound."""

    bound: float
    reason: str

    def words(self, predicted: float | None) -> str:
        return f"at least {self.bound:.3g}"

    def holds(self, predicted: float | None, observed: float) -> bool:
        return observed >= self.bound


Expectation = Near | AtMost | AtLeast
#: What a measurement returns: observed value, energy drift.
Measured = tuple[float, float | None]


def judged(
    case: str,
    setting: Tables,
    quantity: str,
    expectation: Expectation,
    predicted: float | None,
    measure: Callable[[], Measured],
    note: str = "",
) -> Row:
    """A row of what a measurement gives; one that ends in an error, or in no number, has failed."""
    head = (case, setting, quantity, expectation.words(predicted), predicted)
    try:
        observed, drift = measure()
    except RacewayError as error:
        return unexpected(case, setting, quantity, expectation, error, predicted)
    if not math.isfinite(observed) or (drift is not None and not math.isfinite(drift)):
        return Row(*head, None, None, FAILED, expectation.reason, f"not a number: {observed}, energy {drift}")
    good = expectation.holds(predicted, observed)
    return Row(*head, float(observed), drift, AS_EXPECTED if good else FAILED, expectation.reason, note)


def unexpected(
    case: str,
    setting: Tables,
    quantity: str,
    expectation: Expectation,
    why: RacewayError,
    predicted: float | None = None,
) -> Row:
    """The row of a refusal that nobody expects."""
    head = (case, setting, quantity, expectation.words(predicted), predicted)
    return Row(*head, None, None, FAILED, expectation.reason, f"refused, unexpectedly: {short(why)}")


def refused(case: str, setting: Tables, words: str, reason: str, measure: Callable[[], object]) -> Row:
    """A row of what must be refused, with a message that holds ``words``."""
    head = (case, setting, "message", f"refused: '{words}'", None, None, None)
    try:
        measure()
    except RacewayError as error:
        good = words in str(error)
        return Row(*head, AS_EXPECTED if good else FAILED, reason, short(error))
    return Row(*head, FAILED, reason, "it was computed instead")


def lost(case: Case, why: str) -> Row:
    """The row of a case that ended without an answer."""
    return Row(case.name, _plain(case.arguments), "answer", "an answer or a refusal", None, None, None, FAILED, "", why)


def short(error: BaseException) -> str:
    """The first line of a message, not too long for a table."""
    text = (str(error).splitlines() or [type(error).__name__])[0]
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def _plain(arguments: Tables) -> Tables:
    return {key: value for key, value in arguments.items() if isinstance(value, str | int | float)}
