"""The sentence about a dry bearing's damping: when it is said, its numbers, and that it names the remedy."""

import pytest

from raceway.commands.screen.damping import RULE_OF_THUMB_S, dry_damping_note, dry_damping_words


def content(damping, error):
    found = {"equivalent_damping": damping, "equivalent_damping_error": error, "equivalent_stiffness": 235e6}
    return {"identification": found}


def test_a_dry_bearing_is_told_beside_the_rule_of_thumb():
    told = dry_damping_note(content(2.6e-3, 1e-4))
    assert "0.0026 N s/m" in told
    # 1.25e-5 s times 235 N/um
    assert pytest.approx(2937.5) == RULE_OF_THUMB_S * 235e6
    assert "2.9e+03 N s/m" in told
    assert "contact.damping" in told


def test_noise_is_no_number():
    told = dry_damping_note(content(2.6e-3, 1e-2))
    assert "not resolved" in told
    assert "0.0026" not in told


def test_a_damping_that_counts_is_not_told():
    assert dry_damping_note(content(500.0, 1.0)) is None
    assert dry_damping_words(500.0, 235e6) is None


def test_a_static_scene_has_no_damping_to_tell_of():
    assert dry_damping_note({"identification": None}) is None
