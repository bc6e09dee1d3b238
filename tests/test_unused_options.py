"""Options that change nothing are told with the reason, for built-ins and third parties alike."""

from typing import ClassVar

import attrs
import pytest

from raceway import option
from raceway.contact_laws.hertz import Hertz
from raceway.errors import PluginError
from raceway.framework.options import unused_options
from raceway.plugins.excitations.bidirectional import Bidirectional
from raceway.plugins.excitations.unidirectional import Unidirectional


@pytest.mark.parametrize(
    ("options", "unused"),
    [
        ({"unbalance": 1e-4}, set()),
        ({"unbalance": 1e-4, "load_share": 0.5}, set()),
        ({"unbalance": 1e-4, "force": 300.0}, {"force"}),
        ({"unbalance": 1e-4, "reference_speed_rpm": 9000.0}, set()),
        ({"amplitude": "constant", "force": 300.0}, set()),
        ({"amplitude": "constant", "unbalance": 1e-4, "reference_speed_rpm": 9000.0, "load_share": 0.5}, set()),
        ({"amplitude": "constant", "force": 300.0, "load_share": 0.5}, {"load_share"}),
        (
            {"amplitude": "constant", "force": 300.0, "unbalance": 1e-4, "reference_speed_rpm": 9000.0},
            {"unbalance", "reference_speed_rpm"},
        ),
    ],
)
@pytest.mark.parametrize("cls", [Bidirectional, Unidirectional])
def test_amplitude(cls, options, unused):
    excitation = cls(speed_rpm=12000.0, **options)
    found = unused_options(excitation)
    assert set(found) == unused and all(found.values())
    # What is called unused changes nothing.
    without = {name: value for name, value in options.items() if name not in unused}
    assert cls(speed_rpm=12000.0, **without).amplitude_n == excitation.amplitude_n


def test_a_plugin_that_says_nothing_has_none():
    assert unused_options(Hertz()) == {}


@attrs.frozen
class Confused(Hertz):
    name: ClassVar[str] = "confused"
    answer: object = option(None, help="what unused_options() returns")

    def unused_options(self):
        return self.answer


@pytest.mark.parametrize("answer", [["stiffness"], {"stiffness": "no such option"}, {"answer": 3}])
def test_a_wrong_answer_is_the_authors_mistake(answer):
    with pytest.raises(PluginError, match="plug-in 'confused': unused_options"):
        unused_options(Confused(answer=answer))
