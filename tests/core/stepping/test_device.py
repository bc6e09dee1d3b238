"""Explicit steps by the kernels of CUDA devices, run as Python, against those of the processor; what a device refuses, and what it leaves."""

import re

import numpy as np
import pytest

from checks.validation.scenes import built_in
from raceway import (
    LAW,
    BeyondPlanError,
    ConvergenceError,
    PluginError,
    SceneError,
    StabilityError,
    jit,
    make_plan,
    scene_from_dict,
)
from raceway.core.fem.elastic import device
from raceway.core.fem.elastic.device_steps import DeviceSteps
from raceway.extend import Schedule, integrate, three_halves
from tests.core.test_elastic_scene import EXCITED, scene
from tests.core.validation.sectors import BALL, sliding, system

CentralDifference = built_in("integrator", "central_difference")
#: Largest difference over the size of what is compared: sums in another order round by some 1e-16 in each of 20 steps.
SAME = 1e-12


@pytest.fixture(autouse=True)
def several_steps_at_a_time(monkeypatch):
    """However slow Python is, the host looks at the device after 1, 2, 4, ... steps."""
    monkeypatch.setattr("raceway.core.fem.elastic.device_steps._LOOK_S", 1e3)


def moved(where: str, steps: int, stride: int = 1, share: float = 0.5, facets: float = 1.0, on_chunk=None, **changes):
    """System and record after some steps of ``share`` of the stable limit; ``facets``: factor on the size that they are taken for."""
    made = system(**changes)
    start = sliding(made)
    state = made.begin(start)
    made.internal(0.0, 1e-9, state.u, state.v)
    made.contact.facet *= facets
    schedule = Schedule(share * made.stable_step(), steps, 1, stride)
    return made, integrate(CentralDifference(device=where), made, start, schedule, on_chunk)


def agree(steps: int, **changes) -> dict[str, float]:
    """Differences of all that the two ways leave, over its size."""
    (_, wanted), (_, found) = (moved(where, steps, **changes) for where in ("cpu", "gpu"))
    assert found.counts["device"] == device.title() and wanted.counts["device"] == "cpu"
    pairs = {name: (values, found.final.full_state[name]) for name, values in wanted.final.full_state.items()}
    pairs |= {name: (values, found.energies[name]) for name, values in wanted.energies.items()}
    pairs |= {name: (getattr(wanted, name), getattr(found, name)) for name in ("time", "force", "gap", "contact_force")}
    pairs |= {
        name: (np.array(wanted.counts[name]), np.array(found.counts[name]))
        for name in ("max_penetration_m", "peak_contact_force_n")
    }
    return {
        name: float(np.abs(a - b).max(initial=0.0) / max(np.abs(a).max(initial=0.0), 1e-300))
        for name, (a, b) in pairs.items()
    }


def test_the_kernels_of_a_device_move_a_ball_between_rings_as_the_processor_does():
    assert max(agree(4, stride=4).values()) < SAME


def test_points_that_leave_their_facets_a_law_of_others_with_damping_and_added_mass():
    @jit(LAW)
    def cubic(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
        for i in range(gap.size):
            depth = max(-gap[i], 0.0) * (1.0 - 1e-3 * gap_rate[i])
            force[i] = 1e5 * params[i, 0] * np.sqrt(depth) * depth * depth
            d_gap[i] = -2.5e5 * params[i, 0] * np.sqrt(depth) * depth
            d_rate[i] = 0.0

    assert max(agree(3, stride=3, facets=1e-4, law=cubic, damping=3e8, friction=0.0, least_step=1.2e-7).values()) < SAME


@pytest.mark.slow
@pytest.mark.parametrize("excitation", ["unidirectional", "bidirectional"])
@pytest.mark.parametrize(
    "changes",
    [{}, {"law": three_halves, "penalty": 1e16}, {"damping": 1e6, "facets": 1e-3}],
    ids=["penalty", "root", "damping, other facets"],
)
def test_twenty_steps_with_sliding_and_separation(excitation, changes):
    made, record = moved("cpu", 20, excitation=excitation, **changes)
    assert record.energies["friction"][-1] > 0.0  # it slides
    assert record.contact_force[0, 0] > 0.0 and record.contact_force[-1, 0] == 0.0  # it leaves the inner ring
    assert max(agree(20, stride=5, excitation=excitation, **changes).values()) < SAME


def test_a_law_that_names_what_no_device_runs_is_refused_with_its_name():
    helper = re.compile("x")

    def law(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
        helper.match("x")

    with pytest.raises(PluginError, match="names `helper`, Pattern, and devices run numbers"):
        device.device_function(jit(LAW)(law))


def test_auto_takes_the_processor_where_no_device_can(monkeypatch):
    monkeypatch.setattr(device, "absent", lambda: "the driver names none")
    _, record = moved("auto", 1)
    assert record.counts["device"] == "cpu"
    with pytest.raises(
        SceneError,
        match=r"`integrator.device` = 'gpu': finds no CUDA device \(the driver names none\): install .*, or use 'cpu' or 'auto'",
    ):
        moved("gpu", 1)


REFUSED = {
    "no device": ({}, "finds no CUDA device .the driver names none.: install its driver, and numba-cuda by pip install"),
    "memory": ({}, "has 0.00012 GiB free, and .* elements take .* use larger elements, or use 'cpu' or 'auto'"),
    "formulation": ({"bodies": {"formulation": "full"}}, "steps hexahedra of bodies.formulation = 'one_point', not 'full'"),
    "resultants": ({"contact": {"discretisation": "resultant"}}, "steps contacts of contact.discretisation = 'nodal'"),
    "seats": ({"supports": {"outer_seat": 1e14}}, "steps bodies on rigid seats"),
    "rigid": ({}, "is for bodies.kind = 'elastic'"),
    "implicit": ({"integrator": {"kind": "newmark"}}, "unknown key.*; kind 'central_difference' has it"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_the_plan_refuses_what_no_device_steps_with_key_reason_and_remedy(case, monkeypatch):
    changes, words = REFUSED[case]
    if case == "no device":
        monkeypatch.setattr(device, "absent", lambda: "the driver names none")
    if case == "memory":
        monkeypatch.setattr(device, "free_bytes", lambda: 2.0**17)
    tables = {**EXCITED, "integrator": {"kind": "central_difference", "device": "gpu"}, **changes}
    tables["integrator"] = {**tables["integrator"], "device": "gpu"}
    if case == "rigid":
        made = scene_from_dict(
            {name: tables[name] for name in ("excitation", "integrator")} | {"bearing": {"preset": "B7206C"}}
        )
    with pytest.raises(SceneError, match=f"`integrator.device` = 'gpu': {words}"):
        make_plan(made if case == "rigid" else scene(**tables))


def test_the_plan_says_what_runs_where():
    tables = EXCITED | {"integrator": {"kind": "central_difference", "device": "auto"}}
    (part,) = (part for part in make_plan(scene(**tables)).kept if part.part == "steps on a CUDA device")
    assert re.fullmatch(rf"integrator.device is 'auto', .* GiB of its memory: {re.escape(device.title())}", part.why)
    tables["bodies"] = {"formulation": "full"}
    (part,) = (part for part in make_plan(scene(**tables)).left_out if part.part == "steps on a CUDA device")
    assert (
        part.why
        == "a device steps hexahedra of bodies.formulation = 'one_point', not 'full', whose eight points take the processor 33 times as long"
    )


def test_a_contact_that_closes_on_the_device_is_held_against_the_limit_of_the_closed_one():
    made = system(penalty=4e18, friction=0.0)
    start = sliding(made, leaving=200.0)
    made.contact.place[:, 1] += np.where(made.contact.place[:, 1] < 5.0 * BALL, 1e-4, -1.3e-5)  # the outer race closes first
    state = made.begin(start)
    made.internal(0.0, 1e-9, state.u, state.v)
    dt = 0.9 * made.stable_step()
    with pytest.raises(StabilityError, match="s at t = .* s, where contacts have closed or stiffened. Use at least"):
        integrate(CentralDifference(device="gpu"), made, start, Schedule(dt, 6, 1))


def test_what_ends_a_run_leaves_the_last_state(monkeypatch):
    """A user who stops it: that of the last step; a device that fails: that of the last copy."""
    step_s = moved("cpu", 1)[1].time[0]

    def steps_of(state) -> int:
        """Steps after which the processor has the same state."""
        count = round(float(state["t"] / step_s))
        wanted = moved("cpu", count)[1].final.full_state["u"] if count else np.zeros_like(state["u"])
        assert np.abs(state["u"] - wanted).max() <= SAME * np.abs(wanted).max()
        return count

    def stop(done, total):
        if done >= 3:
            raise BeyondPlanError("stopped")

    with pytest.raises(BeyondPlanError) as caught:
        moved("gpu", 8, on_chunk=stop)
    assert steps_of(caught.value.state) >= 3

    steps, taken = DeviceSteps._take_steps, []

    def fails(self, *arguments):
        taken.append(arguments)
        steps(self, *arguments)
        if len(taken) > 2:
            raise RuntimeError("an illegal memory access")

    monkeypatch.setattr(DeviceSteps, "_take_steps", fails)
    with pytest.raises(ConvergenceError, match=r"the CUDA device failed \(an illegal memory access\)") as caught:
        moved("gpu", 8)
    assert caught.value.exit_code == 1 and steps_of(caught.value.state) < 3
