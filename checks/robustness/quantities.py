"""What designers decide by - life, friction, heat - against published numbers, hand calculations and limits, as the tests compute them."""

from __future__ import annotations

from itertools import product

from raceway_catalogue.infer import lines_by_size
from raceway_catalogue.inferred import infer_printed
from raceway_catalogue.printed import printed_by
from raceway_catalogue.rating_conventions import CONFORMITY

from checks.robustness import Row, below, near
from checks.validation import lives, rolling_friction, warm
from raceway.core.contact.losses import mean_slip
from raceway.core.life import life_factor
from raceway.core.rolling_friction import measured_factors

COMMAND = "python -m checks quantities"
_PAGE = "docs/measurements.md"
TEST = "python -m pytest tests/test_life.py packages/raceway-catalogue/tests/test_infer.py tests/test_rolling_friction.py tests/test_warm.py"
_PUBLISHED = {"radial": 0, "radial, 10 um of clearance": 2, "radial and axial, 10 um": 4}
#: Viscosity ratios and e_C C_u / P.
_CHART = tuple(product((0.1, 0.4, 1.0, 4.0), (0.05, 0.2, 0.5)))


def rows() -> list[Row]:
    out = []
    for words, line in _PUBLISHED.items():
        *case, expected, within = lives.MASTA[line]
        life = lives.reference_life(*case)
        out.append(near(f"L10r, 1000 N {words} [1e6 revolutions]", round(life, 4), expected, within, COMMAND))
    sizes = [infer_printed(one, conformity=CONFORMITY) for one in lines_by_size(printed_by("nsk"))]
    count = sum(len(one.printed.ratings) for one in sizes)
    for kind, bound in (("dynamic", 0.00614), ("static", 0.008)):
        error = max(one.worst(f"{kind} rating") for one in sizes)
        out.append(below(f"{kind} ratings of {count} designations by their geometry: largest error", error, bound, COMMAND))
    chart = [abs(float(life_factor(*point)) / lives.printed_life_factor(*point) - 1.0) for point in _CHART]
    out.append(below(f"a_ISO at {len(chart)} points of the standard's equations: largest error", max(chart), 1e-9, COMMAND))
    return out + _friction() + _heat()


def _friction() -> list[Row]:
    moment, expected = rolling_friction.inlet_moment(), rolling_friction.INLET_MOMENT
    loss = rolling_friction.hysteresis_loss(100.0)
    return [
        near("moment by the oil's shear, printed by D-BRAIN [N m]", moment, expected, 2e-5, COMMAND),
        Row("hysteresis of a ball on a plane, over the elastic work", loss, "from 0.01 to 0.03", 0.01 <= loss <= 0.03, COMMAND, "Johnson"),
        near("slip by a contact's curvature, Houpert's 0.0806", 0.5 * mean_slip(0.0, 1.0), 0.0806, 5e-4, COMMAND),
        near("slip by spin, 3/8 mu Q a", mean_slip(1.0, 0.0), 0.375, 1e-12, COMMAND),
        near("drag of a ball over that of a sphere in the mixture", rolling_friction.drag_over_sphere(), 1.0, 1e-9, COMMAND),
        below("torque of pure rolling without oil [N m]", rolling_friction.rolling_without_oil(), 1e-12, COMMAND),
    ]  # fmt: skip


def _heat() -> list[Row]:
    out = [
        below("heat at no speed [W]", warm.heat_at_rest(), 0.0, COMMAND),
        below("infinite conductances against the isothermal bearing", warm.isothermal_difference(), 1e-9, COMMAND),
        below("energy that the network loses, relative", warm.energy_imbalance(), 1e-9, COMMAND),
    ]
    for preload in (100.0, 500.0):
        by_hand = warm.runaway_by_hand(preload)
        words = f"thermal runaway of a rigid pair under {preload:g} N, by hand [r/min]"
        out.append(near(words, round(warm.runaway_speed(preload)), round(by_hand), 0.02, COMMAND))
    outside = list[str]()
    for bore, rpm, flow, watt in warm.HEATS:
        heat, low, high = warm.heat_and_band(bore, rpm, flow)
        words, ok = f"{bore} mm bore, {rpm:g} r/min, {flow:g} cm3/min: heat, measured {watt:g} [W]", low < watt < high
        outside += [] if ok else [words]
        out.append(Row(words, round(heat), f"inside {low:.0f} to {high:.0f}: the measurement", ok, COMMAND, _PAGE))
    for speed, measured, computed in rolling_friction.spin_down():
        low, high = measured_factors(0.036, speed)
        outside += [] if low < measured / computed < high else [f"51205 at {speed:.3g} rad/s"]
    words = f"friction band: measured torque or heat of every bearing in {_PAGE} inside it: {'not ' * bool(outside)}all, without refit"
    assumed = "120 and 167 mm under an assumed load of 22 240 N; under 2224 N four runs at 120 mm lie above"
    out.append(below(words, len(outside), 0, COMMAND, f"{assumed} {outside}"))
    left = warm.outside_the_others()
    return [*out, below("measured bearings outside the band that the others give them", len(left), 0, COMMAND, str(left))]
