"""The suites find what they claim to find: each check is failed by a plug-in made for it."""

import importlib
import os
import re

import attrs
import numpy as np
import pytest

from checks.validation.scenes import built_in
from raceway.extend import Drivers
from raceway.testing import (
    SUITES,
    BodiesSuite,
    ContactLawSuite,
    ExcitationSuite,
    IdentifierSuite,
    IntegratorSuite,
    exponents,
    suite_of,
)
from raceway.testing import suite as suites
from tests import broken_laws
from tests.broken_bodies import BROKEN

GeneralizedAlpha = built_in("integrator", "generalized_alpha")
Newmark = built_in("integrator", "newmark")
Bidirectional = built_in("excitation", "bidirectional")
SineFit = built_in("identifier", "sine_fit")


def failed(suite, plugin, *checks):
    """Messages of those checks that fail, of all without names."""
    case = type("Run", (suite,), {"plugin": plugin})()
    return {row.name: row.message for row in map(case.row, checks or suite.checks()) if not row.good}


def law(name, **options):
    return broken_laws.Broken(function=getattr(broken_laws, name), **options)


class Dissipating(broken_laws.Broken):
    name = "dissipating"
    dissipative = True


@pytest.mark.slow
@pytest.mark.parametrize(("plugin", "check", "found"), [
    (law("sticky"), "zero_outside", "force 1 at gap 0 m"), (law("negative"), "never_negative", "force -"),
    (law("falling"), "monotonic", "the force falls by"),
    (law("wrong_slope"), "derivatives", "d_gap = .* but differences give"),
    (law("losing"), "closed_cycle", "say dissipative = True"),
    (Dissipating(function=broken_laws.gaining), "closed_cycle", "gains .* of the energy"),
    (law("allocating"), "no_allocation", "a call allocates [1-9]"),
    (law("infinite"), "extreme_input", "not finite at gap -1 m"),
    (law("raising"), "extreme_input", "raises ValueError: too deep"),
    (law("incomplete"), "overwrites", "`force` is not overwritten whole"),
    (law("writing", state_size=1), "input_untouched", "state_old changed"),
    (law("neighbours"), "array_lengths", "the order of the contacts"),
    (law("other_signature"), "signature", "not for LAW alone"), (law("plain_python"), "signature", "is not compiled"),
    (broken_laws.OwnUnits(), "unit_invariance", "a dimensional number hides"),
    (broken_laws.OwnUnits(), "hertzian", "the force differs by .* from Hertz's"),
    (broken_laws.FollowsLoad(), "running", "say renewed = True"), (broken_laws.StandsOff(), "running", "it must vanish"),
    (broken_laws.FlatParameters(), "parameters", r"returns shape \(7,\), not \(7, k\)"),
    (
        broken_laws.NeedsOption,
        "declaration",
        r"options without a default \(stiffness\): give the class a classmethod `examples",
    ),
    (broken_laws.Thawed(), "declaration", "is not frozen"),
], ids=lambda v: v if isinstance(v, str) else None)  # fmt: skip
def test_contact_laws(plugin, check, found):
    message = failed(ContactLawSuite, plugin, check).get(check, "it passes")
    assert re.search(found, message), message


@attrs.frozen
class Deadly(broken_laws.Broken):
    """Ends the process that looks at it."""

    name = "deadly"

    def build(self, pairs):
        os.abort()


@pytest.mark.parametrize(("plugin", "check", "how"), [
    (law("far_beyond"), "never_negative", "died: its process ended by SIGSEGV"),
    (law("endless"), "never_negative", "died: it had not ended after 2 s"),
    (Deadly(function=broken_laws.losing), "parameters", "died: its process ended by SIGABRT"),
], ids=["SIGSEGV", "endless", "SIGABRT"])  # fmt: skip
def test_a_suite_survives_what_it_tests(plugin, check, how, monkeypatch):
    monkeypatch.setattr(suites, "LIMIT_S", 2.0)
    suite = type("Run", (ContactLawSuite,), {"plugin": plugin})()
    assert suite.row(check).message == how
    assert suite.row("declaration").good, "the next duty is looked at"


@attrs.frozen(kw_only=True)
class WrongExcitation(Bidirectional):
    """Declares something else than it does."""

    name = "wrong"
    factor: float = 1.0
    turning: int = 1
    period: float = 1.0
    lag: float = 0.0

    amplitude_n = property(lambda self: self.factor * Bidirectional.amplitude_n.fget(self))
    sense = property(lambda self: self.turning)
    period_s = property(lambda self: self.period / self.frequency_hz)

    def parameters(self):
        true = attrs.asdict(self, filter=lambda a, _: a.name in attrs.fields_dict(Bidirectional))
        params = Bidirectional(**true).parameters()
        params[2] += self.lag
        return params


@pytest.mark.parametrize(("options", "check"), [
    ({"factor": 1.01}, "amplitude"), ({"turning": -1}, "sense"), ({"turning": 0}, "sense"),
    ({"period": 0.5}, "declaration"), ({"period": 1.3}, "period"), ({"lag": 0.01}, "direction_and_phase"),
])  # fmt: skip
def test_excitations(options, check):
    plugin = WrongExcitation(speed_rpm=12000.0, unbalance=3e-4, **options)
    assert check in failed(ExcitationSuite, plugin, check)


class Exchanged(Bidirectional):
    """Answers two points in the wrong order."""

    elementwise = True

    def parameters(self):
        params = Bidirectional.parameters(self)
        return params if params.ndim == 1 else params[::-1]


def test_an_excitation_whose_points_are_exchanged():
    assert "parameters" in failed(ExcitationSuite, Exchanged(speed_rpm=12000.0, unbalance=3e-4), "parameters")


class Unstable(built_in("integrator", "central_difference")):
    name = "unstable"
    implicit = True


class Overrated(GeneralizedAlpha):
    name = "overrated"
    order = 3


class Conservative(GeneralizedAlpha):
    name = "conservative"
    dissipative = False


class Silent(Newmark):
    name = "silent"

    @property
    def scheme(self):
        own = super().scheme
        return Drivers(compiled=lambda system, start, schedule, on_chunk=None: own.compiled(system, start, schedule, None))


class Late(Newmark):
    """Times that are off by one step."""

    name = "late"

    @property
    def scheme(self):
        def late(system, start, schedule, on_chunk=None):
            record = Newmark().scheme.compiled(system, start, schedule, on_chunk)
            return attrs.evolve(record, time=record.time + schedule.dt)

        return Drivers(compiled=late)


class TwoMinds(Newmark):
    """Another method step by step than compiled."""

    name = "two_minds"

    @property
    def scheme(self):
        return Drivers(compiled=super().scheme.compiled, stepped=GeneralizedAlpha(rho_infinity=0.5).scheme.stepped)


class Boasting(built_in("integrator", "periodic")):
    """Another amplitude than it says."""

    name = "boasting"

    def solve(self, system, start, schedule, on_chunk=None):
        record = super().solve(system, start, schedule, on_chunk)
        return attrs.evolve(record, displacement=1.0001 * record.displacement)


@pytest.mark.parametrize(("plugin", "checks"), [
    (Boasting(), {"steady_motion", "orbit"}), (Unstable(), {"stability"}),
    (Overrated(), {"order_linear", "order_contact"}), (Conservative(rho_infinity=0.2), {"energy"}),
    (Silent(), {"progress"}), (Late(), {"record"}), (TwoMinds(), {"drivers"}),
])  # fmt: skip
def test_integrators(plugin, checks):
    assert checks == set(failed(IntegratorSuite, plugin, *checks))


@pytest.mark.parametrize(("plugin", "check", "found"), BROKEN, ids=lambda v: v if isinstance(v, str) else None)
def test_bodies(plugin, check, found):
    row = type("Run", (BodiesSuite,), {"plugin": plugin})().row(check)
    assert not row.good, "it passes"
    assert re.search(found, row.message), row.message


def test_every_duty_of_bodies_can_fail():
    assert {check for _, check, _ in BROKEN} == set(BodiesSuite.checks())


class Halved(SineFit):
    name = "halved"
    synchronous = True

    def identify(self, records, equilibrium, model):
        found = super().identify(records, equilibrium, model)
        return attrs.evolve(found, dynamic_stiffness=0.5 * found.dynamic_stiffness)


class Naive(SineFit):
    """One harmonic and no drift: half the largest excursion."""

    name = "naive"

    def identify(self, records, equilibrium, model):
        found = super().identify(records, equilibrium, model)
        size = 0.5 * np.ptp(records[0].displacement[:, 1:3], axis=0).max()
        return attrs.evolve(found, dynamic_stiffness=complex(found.force_amplitude / size))


def test_identifiers():
    for plugin, checks in ((Halved(), {"clean", "synchronous"}), (Naive(), {"drift", "noise", "harmonics"})):
        assert set(failed(IdentifierSuite, plugin, *checks)) == checks


def test_units_are_read():
    assert exponents("N/m^1.5") == (-1.5, 1.0, 0.0)
    assert exponents("kg m") == (0.0, 1.0, 2.0)
    assert exponents("N s/m") == (-1.0, 1.0, 1.0)
    assert exponents("") == (0.0, 0.0, 0.0)
    with pytest.raises(AssertionError, match="'furlong'"):
        exponents("furlong")


EXPECTING = """
import attrs
from raceway.contact_laws.hertz import Hertz

@attrs.frozen
class Loose(Hertz):
    name = "loose"
    {body}
"""


@pytest.fixture
def expecting(tmp_path, monkeypatch):
    """Makes a law in a folder with a list of expected failures beside it."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def make(body, listed):
        name = f"expecting_{abs(hash((body, listed, str(tmp_path))))}"
        (tmp_path / f"{name}.py").write_text(EXPECTING.format(body=body))
        (tmp_path / "raceway_expected_failures.toml").write_text(listed)
        importlib.invalidate_caches()
        return importlib.import_module(name).Loose()

    return make


WRONG = "def build(self, pairs): return (pairs.hertz_factor / (1.0 + pairs.curvature_b))[:, None] * [1.0, 0.0]"


def test_an_expected_failure_conforms_and_xfails_under_pytest(expecting):
    plugin = expecting(WRONG, '[contact_law.loose]\nunit_invariance = "an empirical table in 1/m"')
    conformity = ContactLawSuite.conformity(plugin)
    (row,) = [r for r in conformity.rows if r.name == "unit_invariance"]
    assert conformity.conforms and row.status == "expected failure" and "an empirical table" in row.message
    with pytest.raises(pytest.xfail.Exception):
        type("Case", (ContactLawSuite,), {"plugin": plugin})().test_unit_invariance()


@pytest.mark.parametrize(("listed", "found"), [
    ('[contact_law.loose]\nmonotonic = "never tried"', "it passes: remove it from"),
    ('[contact_law.loose]\nno_such_check = "what"', "no check has that name"),
    ('[contact_law.loose]\nmonotonic = ""', "monotonic need a reason in words"),
    ("[contact_law.loose\n", "is not valid TOML"),
])  # fmt: skip
def test_the_list_is_honoured_strictly(expecting, listed, found, monkeypatch):
    checks = ContactLawSuite.checks()
    few = {name: checks[name] for name in ("declaration", "monotonic")}  # all of them take a second
    monkeypatch.setattr(ContactLawSuite, "checks", classmethod(lambda _: few))
    conformity = ContactLawSuite.conformity(expecting("pass", listed))
    assert not conformity.conforms
    assert any(found in row.message for row in conformity.rows if not row.good)


def test_an_unlisted_failure_fails_under_pytest(expecting):
    plugin = expecting(WRONG, "")
    with pytest.raises(AssertionError, match="a dimensional number hides"):
        type("Case", (ContactLawSuite,), {"plugin": plugin})().test_unit_invariance()


def test_every_suite_says_its_duties():
    for kind in SUITES:
        checks = suite_of(kind).checks()
        assert len(checks) >= 3
        assert all(method.__doc__ and method.duty for method in checks.values())
