"""What was inferred of a bearing: each number with its scatter and its reason."""

from __future__ import annotations

import attrs

from raceway.framework.shown import Fact, Shown, number
from raceway.storage.tables import Tables
from raceway.studies.infer.practices import POISSON, YOUNG
from raceway.studies.infer.printed import Printed


@attrs.frozen
class Number:
    """A number, its relative scatter, and why it is this one."""

    value: float
    scatter: float
    reason: str


@attrs.frozen
class Check:
    """A printed number met: contact angle [deg], what, printed and computed, relative error."""

    contact_angle_deg: float
    quantity: str
    printed: float
    computed: float

    @property
    def error(self) -> float:
        return self.computed / self.printed - 1.0


@attrs.frozen(repr=False)
class Inferred(Shown):
    """Balls and grooves of a bearing, inferred from what its maker prints.

    Attributes
    ----------
    printed : what it was inferred from
    practice : "tables" of ISO 281 and ISO 76, or the maker's own "grooves"
    ball_count, ball_diameter [m], pitch_diameter [m], conformity_inner, conformity_outer : Number
    share : of the probability that this ball count has among all that explain the ratings
    other : the next likely ball count and diameter [m] with its share, or None
    checks : printed ratings [N] and stiffnesses of pairs [N/m] against those of these numbers
    stiffness_error : relative uncertainty of the axial stiffness, 90 %

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.infer("70 mm", "110 mm", {15: ("47 kN", "43 kN"), 25: ("44.5 kN", "41 kN")})
    >>> found.ball_count.value, round(found.ball_diameter.value * 1e3, 3)
    (20, 11.906)
    """

    printed: Printed
    practice: str
    ball_count: Number
    ball_diameter: Number
    pitch_diameter: Number
    conformity_inner: Number
    conformity_outer: Number
    share: float
    other: Tables | None
    checks: tuple[Check, ...]
    stiffness_error: float

    @property
    def numbers(self) -> dict[str, Number]:
        """By the keys of [bearing]."""
        keys = "ball_count", "ball_diameter", "pitch_diameter", "conformity_inner", "conformity_outer"
        return {key: getattr(self, key) for key in keys}

    def worst(self, quantity: str) -> float | None:
        """Largest relative error of "dynamic rating", "static rating" or "pair stiffness"; None where none is printed."""
        return max((abs(one.error) for one in self.checks if one.quantity == quantity), default=None)

    def bearing(self, contact_angle_deg: float | None = None) -> Tables:
        """The table [bearing] of a scene.

        Parameters
        ----------
        contact_angle_deg : None: that of the first rating
        """
        one, steel = self.printed, {"young": YOUNG, "poisson": POISSON}
        table: Tables = {"bore": one.bore, "outer_diameter": one.outer_diameter}
        table |= {} if one.width is None else {"width": one.width}
        table |= {key: found.value for key, found in self.numbers.items()}
        table["contact_angle_deg"] = contact_angle_deg or one.ratings[0].contact_angle_deg
        return {**table, "rings": dict(steel), "balls": dict(steel)}

    def to_dict(self) -> Tables:
        """Plain tables: numbers with scatter and reason, checks, the table [bearing]."""
        return {
            "names": list(self.printed.names),
            "practice": self.practice,
            "share": self.share,
            "other": self.other,
            "numbers": {key: attrs.asdict(found) for key, found in self.numbers.items()},
            "checks": [{**attrs.asdict(one), "error": one.error} for one in self.checks],
            "stiffness_error": self.stiffness_error,
            "bearing": self.bearing(),
        }

    def _shown(self) -> tuple[str, list[Fact]]:
        facts: list[Fact] = []
        for key, found in self.numbers.items():
            length = key.endswith("diameter")
            value = number(1e3 * found.value, "mm") if length else f"{found.value:g}"
            scatter = "" if key == "ball_count" else f"+- {100.0 * found.scatter:.2g} %; "
            facts.append((key.replace("_", " "), value, scatter + found.reason))
        for quantity in ("dynamic rating", "static rating", "pair stiffness"):
            off = self.worst(quantity)
            if off is not None:
                facts.append((quantity, f"{100.0 * off:.2g} %", "largest error of what is printed"))
        facts.append(("axial stiffness", f"{100.0 * self.stiffness_error:.2g} %", "known to about this, 90 %"))
        return self.printed.title, facts
