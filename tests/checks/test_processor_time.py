"""A quick test beyond its budget of processor time fails, whatever the clock on the wall says."""

import os
from contextlib import suppress

import pytest

from checks import processor_time


@pytest.fixture
def tried(request, monkeypatch, tmp_path):
    """``tried(seconds, mark, ci, meets, slowness)``: what is told of a test that takes them; ``meets`` is done in set-up and call."""

    def test(seconds, mark="", ci="", meets=lambda: None, slowness=0.8):
        item = pytest.Function.from_parent(request.node.parent, name="test_of_another", callobj=lambda: None)
        if mark:
            item.add_marker(mark)
        taken = list(os.times())
        with monkeypatch.context() as patch:  # the test of this file is measured, too
            patch.setenv("CI", ci)
            patch.setattr(processor_time, "CACHE", tmp_path)
            patch.setattr(processor_time, "timed", lambda: slowness)
            patch.setattr(os, "times", lambda: tuple(taken))
            for hook, share in ((processor_time.pytest_runtest_setup, 0.25), (processor_time.pytest_runtest_call, 0.75)):
                steps = hook(item)
                next(steps)
                taken[0] += 0.5 * share * seconds  # of this process, and of children
                taken[2] += 0.5 * share * seconds
                meets()
                with suppress(StopIteration):
                    steps.send(None)
        return [value[1] for _, value in item.user_properties]

    return test


def test_beyond_the_budget_it_is_told_and_far_beyond_it_fails(tried):
    assert tried(1.9) == []
    assert tried(2.1) == [False]
    with pytest.raises(pytest.fail.Exception, match=r"test_of_another takes 10\.1 s .* at most 2 s: give it a smaller case"):
        tried(10.1)
    assert tried(10.1, slowness=6.0) == [] and tried(15.0, slowness=3.0) == [False]


@pytest.mark.parametrize("mark", processor_time.LONG)
def test_others_may_last(tried, mark):
    assert tried(100.0, mark) == []


def test_what_is_met_first_is_told_and_no_failure(tried, tmp_path):
    assert tried(10.1, ci="true") == [False]
    assert tried(10.1, meets=lambda: (tmp_path / "kernel.nbc").write_text("")) == [True]


def test_compiling_is_not_counted(tried, monkeypatch):
    clock = {"compile_processor_s": 0.0, "load_s": 0.0}

    def compiles():
        clock["compile_processor_s"] += 1.0
        clock["load_s"] += 0.1

    with monkeypatch.context() as patch:  # by the program's clock this test is measured
        patch.setattr("checks.processor_time.clock", clock)
        assert tried(4.0, meets=compiles) == []
