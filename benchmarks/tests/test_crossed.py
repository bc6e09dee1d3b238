"""What the cross of starts and methods counts, on pairs without a run."""

from __future__ import annotations

from types import SimpleNamespace

from benchmarks.evidence._crossed import Pair, _told, crossed
from benchmarks.evidence.several_motions import crossed_rows
from raceway.pipeline.starting import _STICKS


def _pair(apart, friction=0.0, told=False):
    return Pair(1, friction, "newmark against newmark", apart, told)


def test_the_cross_counts_what_is_apart_and_not_told():
    """99 % without friction, 95 % with it; no error at all is none that holds."""

    def holds(*pairs):
        return [row.ok for row in crossed_rows(list(pairs)) if row.limit.startswith("at least")]

    near, far = [_pair(1.0)] * 99, [_pair(1.0, 0.1)] * 95
    assert holds(*near, _pair(4.0), *far, *[_pair(4.0, 0.1)] * 5) == [True, True]
    assert holds(*near[:98], *[_pair(4.0)] * 2, *far[:94], *[_pair(4.0, 0.1)] * 6) == [False, False]
    assert holds(*near, *[_pair(4.0, told=True)] * 2, *far, *[_pair(4.0, 0.1, told=True)] * 6) == [True, True]
    assert holds(_pair(None), _pair(None, 0.3)) == [False, False]


def test_with_friction_both_runs_of_a_crossed_scene_begin_differently():
    rubbing = [pair for pair in map(crossed, range(60)) if pair[0]["contact"]["friction"] > 0.0]
    assert {pair[0]["contact"]["friction"] for pair in rubbing} == {0.03, 0.1, 0.3}
    assert all(pair[0]["integrator"]["start"] != pair[1]["integrator"]["start"] for pair in rubbing)


def test_only_the_words_for_several_motions_tell_of_several():
    one = "without friction: 2 steady motions that are not unstable exist"
    assert _told(SimpleNamespace(warnings=("an orbit that is unstable",)), SimpleNamespace(warnings=(one,)))
    assert not _told(SimpleNamespace(warnings=(_STICKS, "an orbit that is unstable")))
