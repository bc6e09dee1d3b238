"""The shaft against closed forms, and its correction as the article prints it."""

from math import pi, sqrt

import attrs
import numpy as np
import pytest
from raceway_measure.rig.signals import critical_speed, readings
from raceway_rotor.rig_table import Rig
from raceway_rotor.shaft import make_beam, shaft

from checks.validation.records import SPEED

E, NU, RHO, D = 212e9, 0.29, 7810.0, 0.03
SECOND_MOMENT, AREA = pi / 64.0 * D**4, pi / 4.0 * D**2
HELD = 1e16  # N/m: 1e-8 of a shaft's own compliance


def supported(span, elements=8, density=RHO, shear=False):
    line = make_beam(np.linspace(0.0, span, elements + 1), D, E, NU, density, shear)
    return line.with_spring(0.0, HELD).with_spring(span, HELD)


def static(line, place, force=1.0):
    load = np.zeros(len(line.stiffness))
    load[2 * line.node(place)] = force
    return np.linalg.solve(line.stiffness, load)


def test_a_simply_supported_beam_bends_as_in_the_textbook():
    span = 0.175
    line = supported(span)
    found = static(line, 0.5 * span)
    for k, x in enumerate(line.nodes[:5]):
        # Timoshenko, Strength of Materials: P x (3 L^2 - 4 x^2) / (48 E I); nodes of cubic elements are exact.
        assert found[2 * k] == pytest.approx(x * (3 * span**2 - 4 * x**2) / (48 * E * SECOND_MOMENT), rel=1e-6, abs=1e-15)


def test_shear_adds_its_closed_form():
    span = 0.175
    kappa = 6.0 * (1.0 + NU) / (7.0 + 6.0 * NU)
    extra = span / (4.0 * kappa * E / (2.0 * (1.0 + NU)) * AREA)
    thick, thin = (static(supported(span, shear=shear), 0.5 * span)[8] for shear in (True, False))
    assert thick - thin == pytest.approx(extra, rel=1e-6)


def test_first_critical_speed_of_a_jeffcott_rotor():
    span, mass = 0.175, 4.0
    line = supported(span, density=1e-6).with_disc(0.5 * span, mass, 0.0, 0.0)
    assert line.critical_speeds()[0] == pytest.approx(sqrt(48 * E * SECOND_MOMENT / span**3 / mass), rel=1e-6)


def test_natural_frequencies_of_a_slender_beam_converge_with_the_fourth_power():
    span = 0.5
    exact = (pi / span) ** 2 * sqrt(E * SECOND_MOMENT / (RHO * AREA))
    errors = []
    for elements in (2, 4, 8):
        line = supported(span, elements)
        values = np.linalg.eigvals(np.linalg.solve(line.stiffness, line.mass)).real
        errors.append(1.0 / sqrt(values.max()) / exact - 1.0)
    # Consistent mass: above, and 16 times less with half the length.
    assert min(errors) > 0.0
    assert np.diff(np.log2(errors)) == pytest.approx([-4.0, -4.0], abs=0.1)


def test_gyroscopic_moments_of_an_overhung_disc():
    length, mass, transverse, polar = 0.1, 3.0, 0.01, 0.005
    line = make_beam(np.array([0.0, length]), D, E, NU, 1e-6, False).with_spring(0.0, HELD, HELD)
    line = line.with_disc(length, mass, transverse, polar)
    k = E * SECOND_MOMENT / length**3 * np.array([[12.0, -6.0 * length], [-6.0 * length, 4.0 * length**2]])
    exact = np.linalg.eigvals(np.linalg.solve(np.diag([mass, transverse - polar]), k)).real
    assert line.critical_speeds()[:2] == pytest.approx(np.sqrt(np.sort(exact)), rel=1e-6)
    # A disc that is flat (I_p > I_t) has one critical speed of forward whirl only.
    flat = make_beam(np.array([0.0, length]), D, E, NU, 1e-9, False).with_spring(0.0, HELD, HELD)
    flat = flat.with_disc(length, mass, transverse, 2.0 * transverse)
    assert np.sum(flat.critical_speeds() < 1e6) == 1


def test_rotary_and_polar_inertia_of_a_shaft_are_those_of_its_sections():
    """A rigid tilt turns all sections alike: rho I L about a diameter, twice that about the axis."""
    length = 0.4
    line = make_beam(np.linspace(0.0, length, 5), D, E, NU, RHO, True)
    tilt = np.empty(10)
    tilt[::2], tilt[1::2] = line.nodes, 1.0
    assert tilt @ line.rotary @ tilt == pytest.approx(RHO * SECOND_MOMENT * length, rel=1e-12)
    assert tilt @ line.polar @ tilt == pytest.approx(2.0 * RHO * SECOND_MOMENT * length, rel=1e-12)
    whirling = tilt @ (line.dynamic(3.0, 2.0) - line.stiffness) @ tilt
    assert whirling == pytest.approx(-9.0 * (tilt @ (line.mass + line.rotary) @ tilt) + 6.0 * (tilt @ line.polar @ tilt))


def test_a_stiff_hub_bends_less():
    span, hub = 0.175, 0.02
    places = np.array([0.0, 0.5 * (span - hub), 0.5 * span, 0.5 * (span + hub), span])
    stiff = np.array([D, 100.0 * D, 100.0 * D, D])
    line = make_beam(places, D, E, NU, RHO, False, stiff).with_spring(0.0, HELD).with_spring(span, HELD)
    # Castigliano: the square of the bending moment over the part that bends, P^2 x^2 / 4 up to the hub on both sides.
    exact = (0.5 * (span - hub)) ** 3 / (6.0 * E * SECOND_MOMENT)
    assert static(line, 0.5 * span)[4] == pytest.approx(exact, rel=1e-6)


def test_mass_and_symmetry():
    rig = Rig()
    line = shaft(rig)
    rigid = np.zeros(len(line.mass))
    rigid[::2] = 1.0
    assert rigid @ line.mass @ rigid == pytest.approx(rig.mass, rel=1e-12)
    turned, inner, outer = (
        np.column_stack([line.nodes, np.ones(len(line.nodes))]).ravel(), 0.5 * rig.shaft_diameter, rig.disc_radius,
    )  # fmt: skip
    bar = (
        rig.density * np.pi * inner**4 * rig.shaft_length
    )  # a rigid shaft and the ring of the disc, about the axis and a diameter
    ring = rig.density * np.pi * (outer**2 - inner**2) * rig.disc_thickness
    polar = 0.5 * (bar + ring * (outer**2 + inner**2))
    assert turned @ line.polar @ turned == pytest.approx(polar, rel=1e-9)
    assert turned @ line.rotary @ turned == pytest.approx(0.5 * polar + ring * rig.disc_thickness**2 / 12.0, rel=1e-9)
    assert rig.disc_mass == pytest.approx(3.97, abs=0.005)
    for matrix in (line.stiffness, line.mass, line.rotary, line.polar):
        assert np.abs(matrix - matrix.T).max() <= 1e-12 * np.abs(matrix).max()
    assert np.abs(line.stiffness @ rigid).max() < 1e-6 * np.abs(line.stiffness).max()


#: A 1x line at the sensor [m].
LINE = 12e-6 + 1e-6j


def bow(reading, rig, force: float, held) -> float:
    """Deflection that a reading takes off the line [m]."""
    return (LINE - force / complex(reading.stiffness - held.mass * SPEED**2, reading.damping * SPEED)).real


def test_the_printed_formula_is_the_article_s_and_with_twice_the_span_timoshenko_s_beam(rig, held):
    found = {one.correction: one for one in readings(rig, held, SPEED, LINE)}
    whole, a, span = rig.unbalance * SPEED**2, rig.sensor_distance, rig.span
    bending = rig.young * pi / 64.0 * rig.shaft_diameter**4
    grown = 1.0 / (1.0 - (SPEED / critical_speed(rig, held)) ** 2)
    printed = whole * a * (3.0 * span**2 - 16.0 * a**2) / (192.0 * bending)
    # Timoshenko: P a (3 L^2 - 4 a^2) / (48 E I) at a from the support of a simply supported beam of span L.
    beam = whole * a * (3.0 * span**2 - 4.0 * a**2) / (48.0 * bending)
    assert bow(found["as printed"], rig, 0.5 * whole, held) == pytest.approx(grown * printed, rel=1e-9)
    assert bow(found["as printed, with L twice the span"], rig, 0.5 * whole, held) == pytest.approx(grown * beam, rel=1e-9)
    assert bow(found["none"], rig, 0.5 * whole, held) == pytest.approx(0.0, abs=1e-15)
    # Beyond its support the beam is straight, with the slope P L^2 / (16 E I) there.
    (found,) = (
        one
        for one in readings(attrs.evolve(rig, sensor_side="outside"), held, SPEED, LINE)
        if one.correction.endswith(" bow")
    )
    assert bow(found, rig, 0.5 * whole, held) == pytest.approx(-grown * whole * a * span**2 / (16.0 * bending), rel=1e-9)
