"""Numbers given as text with a unit, or as quantities: converted once, while the scene is read."""

from __future__ import annotations

import math

import attrs
import numpy as np
import pytest
from jsonschema import Draft202012Validator

import raceway as rw
from checks.validation.command_line import ARTICLE, invoke
from raceway import SceneError
from raceway.extend import number_in, plain_tables, scene_schema
from raceway.testing import b7206c, default_registry

#: Unit of the key, text, number: exactly the number that one types in the key's unit.
SAME = {
    "millimetres": ("m", "9.525 mm", 0.009525), "micrometres": ("m", "5 um", 5e-6),
    "micro sign": ("m", "5 µm", 5e-6), "Greek mu": ("m", "5μm", 5e-6), "inch": ("m", "0.375 in", 0.009525),
    "pound-force": ("N", "10 lbf", 44.482216152605), "pound": ("kg", "2 lb", 0.90718474),
    "unbalance in ounce inch": ("kg m", "16 oz in", 0.45359237 * 0.0254),
    "pound-force an inch": ("N/m", "1 lbf/in", 175.1268352464764),
    "pound-force a square inch": ("Pa", "1 psi", 6894.757293168362), "kilonewton": ("N", "1 kN", 1000.0),
    "signs and powers of ten": ("N", "-.5e3 mN", -0.5), "gigapascal": ("Pa", "212 GPa", 212e9),
    "megapascal": ("Pa", "4200 MPa", 4.2e9), "flow": ("m3/s", "300 cm3/min", 5e-6),
    "gram": ("kg", "5 g", 0.005), "unbalance": ("kg m", "50 g mm", 5e-5), "inertia": ("kg m2", "3 kg mm^2", 3e-6),
    "density": ("kg/m3", "7.81 g/cm3", 7810.0), "turns a minute": ("r/min", "12000 rpm", 12000.0),
    "turns a second": ("r/min", "200 Hz", 12000.0), "rev/min": ("r/min", "900 rev/min", 900.0),
    "degrees": ("deg", "15 deg", 15.0), "degree sign": ("deg", "15°", 15.0), "milliseconds": ("s", "2 ms", 0.002),
    "stiffness": ("N/m", "100 N/um", 1e8), "seat": ("N/m3", "5 N/mm**3", 5e9), "damping": ("N s/m", "3 N*s/m", 3.0),
    "tilt": ("N m/rad", "2 kN m/rad", 2000.0),
    "the key's own unit, which is no product": ("m^1.8/N^0.9", "2 m^1.8/N^0.9", 2.0),
}  # fmt: skip


@pytest.mark.parametrize(("unit", "text", "number"), SAME.values(), ids=SAME)
def test_a_number_with_a_unit(unit, text, number):
    assert number_in(unit, text) == number


def test_what_pi_converts_is_right_to_the_last_digits():
    assert number_in("r/min", "100 rad/s") == pytest.approx(100.0 * 30.0 / math.pi, rel=1e-15)
    assert number_in("deg", "1 rad") == pytest.approx(math.degrees(1.0), rel=1e-15)


REFUSED = {
    "a length for a force": ("load.axial=12 mm", "'mm' is not a unit of this key"),
    "a symbol in the wrong case": ("load.axial=1 kn", "did you mean 'kN'?"),
    "no unit": ('load.axial="400"', "without a unit"), "decimal comma": ("load.axial=1,5 kN", "is no unit"),
    "in a list": ('load.radial=["1 m", 0.0]', "'m' is not a unit of this key"),
    "beside words": ("supports.tilt=3 N", "must be a number in N m/rad"),
    "against the rule": ("rotor.mass=-3 g", "must be at least 0"),
    "a count": ('bearing.ball_count="12 mm"', "must be a whole number"),
    "a pure number": ('contact.friction="0.1 mm"', "must be a number"),
    "beyond all numbers": ("load.axial=1e999 kN", "must be a finite number"),
    "beyond all powers": ("load.axial=1 mm^999999999", "is no unit"),
    "an inverse time for a speed": ("excitation.speed_rpm=100 1/s", "r/min, rpm, Hz or rad/s"),
}  # fmt: skip


@pytest.mark.parametrize(("change", "words"), REFUSED.values(), ids=REFUSED)
def test_a_wrong_unit_is_one_message_with_path_and_value(change, words):
    found = invoke("check", ARTICLE, "--set", change)
    assert found.exit_code == 2
    assert words in found.stderr
    assert found.stderr.count(f"`{change.partition('=')[0]}`") == 1


def test_every_unit_of_a_key_is_a_product_of_known_symbols_but_two():
    schema = str(scene_schema(default_registry()))
    assert "[r/min]" in schema
    unknown = set()
    for entry in default_registry().all():
        for unit in filter(None, (field.metadata.get("unit") for field in attrs.fields(entry.plugin))):
            try:
                number_in(unit, f"1 {unit}")
            except ValueError:
                unknown.add(unit)
    assert unknown <= {"m^1.8/N^0.9", "°C"}  # a temperature in °C has an offset: it is no product


def test_the_scene_holds_numbers_only_and_the_title_says_them():
    scene = rw.evolve(ARTICLE, "load.axial=0.4 kN", {"bearing.rings.young": "206 GPa"}, {"load": {"radial": ["1 kN", 0]}})
    assert scene.source["load"] == {"axial": 400.0, "radial": [1000.0, 0]}
    assert scene.title.splitlines()[1] == "bearing.rings.young = 206000000000, load.axial = 400, load.radial = [1000.0, 0]"
    assert plain_tables(scene, registry=default_registry()) == plain_tables(
        rw.evolve(ARTICLE, "load.axial=400.0", "bearing.rings.young=206e9", "load.radial=[1000.0, 0]"),
        registry=default_registry(),
    )


@attrs.frozen
class Units:
    """Units as pint writes them."""

    short: str

    def __format__(self, how: str) -> str:
        assert how == "~C"
        return self.short


@attrs.frozen
class Quantity:
    """What pint calls a quantity."""

    magnitude: object
    short: str
    base: tuple[float, str] = (0.0, "")

    @property
    def units(self) -> Units:
        return Units(self.short)

    def to_base_units(self) -> Quantity:
        return Quantity(self.magnitude * self.base[0], self.base[1])


def test_quantities_of_pint():
    scene = rw.Scene.from_dict(b7206c(load={"axial": Quantity(1, "kN"), "radial": Quantity(np.array([0.1, 0.0]), "kN")}))
    assert scene.load == rw.Scene.from_dict(b7206c(load={"axial": 1000.0, "radial": [100.0, 0.0]})).load
    pounds = scene.with_(load={"axial": Quantity(100.0, "lbf", (4.4482216152605, "kg*m/s**2"))})
    assert pounds.load.axial == pytest.approx(444.82216, rel=1e-7)
    assert scene.with_(contact={"friction": Quantity(0.1, "")}).contact.friction == 0.1
    with pytest.raises(SceneError, match=r"`load.axial` = '1 mm'.*not a unit of this key"):
        scene.with_(load={"axial": Quantity(1, "mm")})


def test_the_schema_takes_text_with_a_unit():
    check = Draft202012Validator(scene_schema(default_registry()))
    assert check.is_valid(b7206c(load={"axial": "1 kN", "radial": ["-1.5e2 N", 0.0]}, supports={"tilt": "2 kN m/rad"}))
    for load in ({"axial": "much"}, {"axial": "400"}, {"radial": ["1 N"]}):
        assert not check.is_valid(b7206c(load=load))
