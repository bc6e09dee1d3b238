"""The thermal network of a bearing, and its correlations."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

import raceway as rw
from raceway.core.quantities.thermal import (
    JOINT,
    LINKS,
    NODES,
    STEEL_CONDUCTIVITY,
    STEEL_EFFUSIVITY,
    Network,
    jet_oil_fraction,
    oil_convection,
    rolling_contact,
    seat_emission,
)
from tests.core.validation import warm as published

_INLET, _AMBIENT = 60.0, 20.0


def _network(n: int = 50) -> tuple[dict[str, np.ndarray], np.ndarray]:
    rng = np.random.default_rng(3)
    return {link: rng.uniform(0.5, 40.0, n) for link in LINKS}, rng.uniform(0.0, 300.0, (n, 6))


def test_the_network_balances_its_energy():
    """What arises leaves with the oil and to the ambient, to 1e-9, at each node, too."""
    conductances, heats = _network()
    along = Network(conductances, heats, _INLET, _AMBIENT).flows
    leaving = along["throughput"] + along["shaft_ambient"] + along["housing_ambient"]
    assert_allclose(leaving, heats.sum(axis=1), rtol=1e-12)
    for k, node in enumerate(NODES):
        out = sum(along[link] * ((first == node) - (second == node)) for link, (first, second) in LINKS.items())
        assert_allclose(out, heats[:, k], rtol=1e-9, atol=1e-9)


def test_without_heat_at_one_temperature():
    conductances, heats = _network()
    assert_allclose(Network(conductances, 0.0 * heats, 45.0, 45.0).temperatures, 45.0, rtol=1e-12)


@pytest.mark.parametrize("last", ["throughput", "shaft_ambient"])
def test_two_resistances_in_series(last):
    """Heat of the inner ring that can leave by one way only warms it by heat times the resistances on it."""
    way = {"throughput": "inner_oil", "shaft_ambient": "inner_shaft"}[last]
    conductances = dict.fromkeys(LINKS, 1e-12) | {way: 4.0, last: 5.0}
    heats = np.zeros((1, 6))
    heats[0, 0] = 100.0
    level = Network(conductances, heats, 30.0, 30.0).temperatures[0]
    assert_allclose(level[0] - 30.0, 100.0 / 4.0 + 100.0 / 5.0, rtol=1e-9)


def test_the_outer_ring_heats_a_film_that_passes_it():
    """Plug flow along a wall: what leaves is at T_in + (T_wall - T_in) (1 - exp(-N)), for a short, a usual and a long way."""
    for film, throughput in ((1e-3, 10.0), (12.0, 20.0), (300.0, 5.0)):
        conductances = dict.fromkeys(LINKS, 1e-12) | {"outer_oil": film, "throughput": throughput}
        heats = np.zeros((1, 6))
        heats[0, 2] = 100.0
        level = Network(conductances, heats, 30.0, 30.0).temperatures[0]
        assert_allclose(level[NODES.index("oil")] - 30.0, 100.0 / throughput, rtol=1e-6)
        assert_allclose(level[2] - 30.0, 100.0 / (-throughput * np.expm1(-film / throughput)), rtol=1e-4)


def test_oil_around_the_balls_by_hand():
    """760 cm3/min at 28 000 r/min on 46.5 mm: 1e5 760^0.37 / (28 000 46.5^1.7) = 0.0609; 1 at most; what 40 turns let through."""
    flow, speed = 760e-6 / 60.0, 28_000.0 * np.pi / 30.0
    assert_allclose(jet_oil_fraction(flow, speed, 46.5e-3), 1e5 * 11.639 / (28_000.0 * 683.2), rtol=1e-3)
    assert jet_oil_fraction(flow, 0.0, 46.5e-3) == 1.0
    assert_allclose(jet_oil_fraction(flow, 2.0 * speed, 46.5e-3), 0.5 * jet_oil_fraction(flow, speed, 46.5e-3))


def test_infinite_conductances_are_the_limit_of_large_ones():
    """Of some links and of all: then every node is at the inlet's temperature, and the oil takes what the ambient does not."""
    conductances, heats = _network()
    for links in (["inner_oil", "inner_balls", "balls_oil"], ["throughput"], ["outer_housing", "inner_shaft", "outer_oil"]):
        infinite = Network(conductances | dict.fromkeys(links, np.inf), heats, _INLET, _AMBIENT).temperatures
        large = Network(conductances | dict.fromkeys(links, 1e9), heats, _INLET, _AMBIENT).temperatures
        assert_allclose(infinite, large, rtol=1e-5)
    every = {link: value if "ambient" in link else np.inf for link, value in conductances.items()}
    level = Network(every, heats, _INLET, _AMBIENT).temperatures
    assert_allclose(level, _INLET, rtol=1e-15)
    along = Network(every, heats, _INLET, _AMBIENT).flows
    assert_allclose(along["throughput"] + along["shaft_ambient"] + along["housing_ambient"], heats.sum(axis=1), rtol=1e-12)


def test_more_heat_is_warmer_and_more_oil_is_colder():
    conductances, heats = _network()
    level = Network(conductances, heats, _INLET, _AMBIENT).temperatures
    warmer = Network(conductances, heats + np.eye(6)[2], _INLET, _AMBIENT).temperatures
    assert (warmer > level).all() and (np.argmax(warmer - level, axis=1) == 2).all()
    more_oil = conductances | {"throughput": 2.0 * conductances["throughput"]}
    hot = level[:, -1] > _INLET
    assert (Network(more_oil, heats, _INLET, _AMBIENT).temperatures[hot] < level[hot]).all()


def test_a_fast_contact_takes_up_what_two_half_spaces_exchange():
    """Strip by strip e dT sqrt(t / pi) a unit of area [J/m2] over the time in contact, integrated by quadrature."""
    a, b, speed = 6e-4, 6e-5, 2e3

    def strip(y):
        time = 2.0 * b * np.sqrt(1.0 - (y / a) ** 2) / speed
        return STEEL_EFFUSIVITY * np.sqrt(time / np.pi) * speed

    assert_allclose(rolling_contact(a, b, speed), quad(strip, -a, a)[0], rtol=3e-4)


def test_a_standing_contact_is_two_constrictions():
    """Of a circle each has 1 / (4 k a); a film is in series; an open contact conducts nothing."""
    a = 1e-4
    assert_allclose(rolling_contact(a, a, 0.0), 2.0 * STEEL_CONDUCTIVITY * a, rtol=1e-12)
    film = rolling_contact(a, a, 0.0, film=1e-6, oil_conductivity=0.14)
    assert_allclose(1.0 / film, 1.0 / (2.0 * STEEL_CONDUCTIVITY * a) + 1e-6 / (0.14 * np.pi * a**2), rtol=1e-12)
    assert rolling_contact(0.0, 0.0, 10.0) == 0.0


def test_convection_by_hand():
    """VG 32 at 60 C and 10 000 r/min, D cos(alpha)/d_m = 0.2: nu 14e-6 m2/s, k 0.14 W/m/K, rho c 1.7e6, Pr 170."""
    h = oil_convection(10_000.0 * np.pi / 30.0, 0.2, 14e-6, 0.14, 1.7e6, 9.525e-3)
    assert_allclose(h, 0.0986 * (8000.0 / 14e-6) ** 0.5 * 0.14 * 170.0 ** (1.0 / 3.0) + 29.4, rtol=1e-3)


def test_emission_of_both_seats_is_that_of_the_standard():
    """A 6206 of 30 by 62 by 16 mm: 0.016 W/mm2 of 4624 mm2 at 50 K."""
    both = seat_emission(0.030, 0.092, 0.016) + seat_emission(0.062, 0.092, 0.016)
    assert_allclose(both, 0.016 * 4624.4 / 50.0, rtol=1e-4)
    assert seat_emission(0.5, 0.9, 0.1) < 0.016e6 * np.pi * 0.5 * 0.1 / 50.0


def test_conductances_are_the_correlations_with_sizes_and_film_of_the_bearing():
    """Of both rows; contacts by the film of the quantity `film` and the speed of rolling at both races' angles, 1e-3 off their mean's."""
    result = rw.run(published.warm_pair())
    found = result.to_dict()
    (b, _), oil, w = result.model.problem.bearing.of_rows, result.model.problem.lubricant, 12_000.0 * np.pi / 30.0
    capacity = oil.density * 2000.0
    ratio = b.ball_diameter * np.cos(np.radians(15.0)) / b.pitch_diameter
    h = oil_convection(w, ratio, oil.kinematic_viscosity, oil.conductivity, capacity, b.ball_diameter)
    wetted = 1.0 - 12 * b.ball_diameter / (np.pi * b.pitch_diameter)
    wanted = {
        "throughput": capacity * 8e-6, "balls_oil": 2 * 12 * h * np.pi * b.ball_diameter**2,
        "inner_oil": 2 * wetted * h * np.pi * (b.pitch_diameter - b.ball_diameter) * b.width,
        "outer_oil": 2 * h * np.pi * (b.pitch_diameter + b.ball_diameter) * b.width,
        "inner_shaft": 2 * JOINT * np.pi * b.bore * b.width, "outer_housing": 2 * JOINT * np.pi * b.outer_diameter * b.width,
        "shaft_ambient": 2 * seat_emission(b.bore, b.bore + b.outer_diameter, b.width),
        "housing_ambient": 2 * seat_emission(b.outer_diameter, b.bore + b.outer_diameter, b.width),
    }  # fmt: skip
    for race in ("inner", "outer"):
        film, ball = found["film"][race], found["equilibrium"]["balls"][0]
        axes = ball[f"semi_major_{race}_m"], ball[f"semi_minor_{race}_m"]
        contact = rolling_contact(*axes, film["entraining_speed_m_per_s"], film["central_m"], oil.conductivity)
        wanted[f"{race}_balls"] = 24 * float(contact)
    stated, level, flows = (found["heat"][name] for name in ("conductances_w_per_k", "temperatures_k", "flows_w"))
    assert stated == pytest.approx(wanted, rel=2e-3) and stated.keys() == wanted.keys()
    for seat, ring in (("shaft", "inner"), ("housing", "outer")):
        along = stated[f"{ring}_{seat}"] * (level[ring] - level[seat])
        out = stated[f"{seat}_ambient"] * (level[seat] - 293.15)
        assert [along, out] == pytest.approx([flows[seat], flows[seat]], rel=1e-9)
