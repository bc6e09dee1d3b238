"""Pictures of fits, of recordings and of the error of a rig are readable, whatever the numbers are."""

from types import SimpleNamespace

import numpy as np
import pytest
from raceway_measure.fit.picture import draw_fit, figures
from raceway_measure.fit.shaft_angle import rotation_of
from raceway_measure.fit.synchronous import synchronous
from raceway_measure.rig import study as rig

import raceway
from checks.validation.figures import assert_readable
from checks.validation.records import made
from raceway.testing import b7206c


def test_pictures_of_a_fit_are_readable():
    data = {"axial [N]": [400.0, 1000.0, 2000.0, 3000.0], "kxx [N/um]": [39.0, 68.0, 98.0, 124.0]}
    names = "bearing.contact_angle_deg,bearing.conformity_inner"
    one, two = (raceway.fit(data, b7206c(), free).to_dict() for free in (names.split(",")[0], names))
    lost = {**one["free"][0], "error": None, "determined": False, "low": None, "high": None}
    wild = {**one["series"][0], "measured": [1.0, 1e3, 1e6, 1e9]}
    region = draw_fit(two).axes[1].lines[0].get_xydata()  # at 95 % of two numbers: chi squared 5.991
    assert 0.5 * np.ptp(region, axis=0) == pytest.approx(np.sqrt(5.991 * np.diag(two["covariance"])), rel=1e-3)
    assert_readable([draw_fit(one), draw_fit({**two, "series": [*two["series"], wild]}), draw_fit({**one, "free": [lost]})])


def test_pictures_of_a_recording_are_readable():
    rotation = rotation_of(made(noise=1e-6))
    component = synchronous(rotation)
    state = SimpleNamespace(sensor=3.0 * component.forward, deflection=9.0 * component.forward)
    drawn = figures(rotation, component, state)
    order, amplitude = drawn["spectrum"].axes[0].lines[0].get_data()
    assert amplitude[order == 1.0] == pytest.approx(1e6 * abs(component.forward), rel=0.02)
    assert_readable(drawn.values())


def made_up_pictures():
    """The first load's K is a quarter of the second's, and one cause is ten times K."""
    points = []
    for axial, true in ((400.0, 30e6), (2000.0, 120e6)):
        for speed in (1100.0, 1300.0, 1500.0):
            state = SimpleNamespace(speed=speed, stiffness=true)
            readings = [SimpleNamespace(correction=f"way {k}", stiffness=true * (0.2 + 0.3 * k)) for k in range(6)]
            causes = [
                SimpleNamespace(kind="noise", what=f"cause {k}", error=e) for k, e in enumerate((0.0, 1e-9, -0.01, 10.0))
            ]
            points.append(
                SimpleNamespace(
                    axial=axial, state=state, identified=SimpleNamespace(state=state), readings=readings, causes=causes
                )
            )
    study = SimpleNamespace(points=points)
    return [rig._procedures(study), rig._causes(study)]


def test_the_pictures_of_a_rigs_error_are_readable_and_their_dashed_lines_say_what_they_are():
    assert_readable(made_up_pictures())
    _, split = made_up_pictures()
    (panel,) = split.axes
    dashed = [line.get_xdata()[0] for line in panel.lines if line.get_linestyle() == "--"]
    assert {text.get_text(): text.xy[0] for text in panel.texts} == {f"{limit:g} %": limit for limit in dashed} != {}
