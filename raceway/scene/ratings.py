"""Load ratings of a bearing: as its keys say, as the catalogue prints them, or by ISO 281 and ISO 76 from its geometry."""

from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache

import attrs
import numpy as np

from raceway.core.columns import Number
from raceway.core.quantities.ratings import STEEL, STEEPEST, BallRow
from raceway.scene.bearing import STEEL as STEEL_YOUNG
from raceway.scene.bearing import Bearing
from raceway.scene.catalogue import preset_of

_GEOMETRY = "ball_count", "ball_diameter", "pitch_diameter", "contact_angle_deg", "conformity_inner", "conformity_outer"


@attrs.frozen
class LoadRatings:
    """Ratings of one row of balls; numbers may be columns.

    row : balls and grooves at the nominal contact angle
    modulus : contact modulus E* of permitted pressures [Pa]: that of the standards where balls and rings are of steel
    dynamic, static : C and C0 [N];  dynamic_from, static_from : "key", "catalogue" or "geometry"
    missing : why there is no dynamic rating, which is nan then; else empty
    """

    row: BallRow
    modulus: Number
    dynamic: Number
    dynamic_from: str
    static: Number
    static_from: str
    missing: str = ""

    @cached_property
    def of_contacts(self) -> tuple[np.ndarray, np.ndarray]:
        """(..., 2) loads of a ball at both races [N]: rings live a million revolutions under the first, C0 permits the second."""
        both = self.row.contact_ratings(self.dynamic).T, self.row.static_contact_ratings(self.static).T
        for ratings in both:  # of all scenes with this bearing
            ratings.setflags(write=False)
        return both

    @cached_property
    def fatigue_load_limit(self) -> np.ndarray:
        """C_u [N]."""
        return self.row.fatigue_load_limit(self.modulus)


def load_ratings(bearing: Bearing) -> LoadRatings:
    """Ratings of a bearing of one row.

    The nominal contact angle is ``contact_angle_deg``, 0 where only a clearance is given.  Printed ratings are those of the
    catalogue's geometry; other balls, grooves and angles change them by the standards' formulas.

    Ceramic balls change no dynamic rating (ISO 20056-1).  Their contacts reach 4200 MPa under less load, where ISO 20056-2 permits
    a little more.
    """
    row, modulus, parts = _ball_row(attrs.asdict(bearing, recurse=False)), STEEL, (bearing.rings, bearing.balls)
    if not all(np.all((STEEL_YOUNG[0] <= part.young) & (part.young <= STEEL_YOUNG[1])) for part in parts):
        from raceway.core.contact.hertz import contact_modulus

        modulus = contact_modulus(*(number for part in parts for number in (part.young, part.poisson)))
    static_rating = row.static_rating_of_grooves(modulus)
    static, static_from = _rating(bearing, "static_rating", static_rating, BallRow.static_rating_of_grooves)
    if bearing.dynamic_rating is None and np.any(row.angle > STEEPEST):
        missing = "bearing.dynamic_rating is missing: ISO 281 rates contact angles up to 45 deg by their radial load"
        return LoadRatings(row, modulus, np.nan, "", static, static_from, missing)
    dynamic, dynamic_from = _rating(bearing, "dynamic_rating", row.dynamic_rating(), BallRow.dynamic_rating)
    return LoadRatings(row, modulus, dynamic, dynamic_from, static, static_from)


#: The same of bearings without columns: loads change, bearings stay.
ratings_of_numbers = lru_cache(maxsize=64)(load_ratings)


def _rating(bearing: Bearing, key: str, by_geometry: Number, formula: Callable[[BallRow], Number]) -> tuple[Number, str]:
    """A rating [N] and where it comes from; ``by_geometry`` from the geometry by a formula."""
    value = getattr(bearing, key)
    if value is not None:
        return value, "key"
    entry = preset_of(bearing.preset, bearing.maker)
    if entry is None or key not in entry.ratings:
        return by_geometry, "geometry"
    return entry.ratings[key] * (by_geometry / formula(_ball_row(entry.table))), "catalogue"


def _ball_row(numbers: Mapping[str, Number]) -> BallRow:
    count, ball, pitch, angle, inner, outer = (numbers.get(key) for key in _GEOMETRY)
    return BallRow(count, ball, pitch, np.radians(0.0 if angle is None else angle), inner, outer)
