"""A linearised bearing, factored and iterated, put back into its equations: with friction its tangents are not symmetric."""

from __future__ import annotations

import numpy as np
import pytest

from raceway.core.elastic.superelements import linearised
from raceway.core.elastic.superelements.interface import Motions
from raceway.core.elastic.superelements.linearised import Linearised
from raceway.core.elastic.superelements.tangent import BallTangent
from tests.superelements.bearings import built

#: Of springs of some 1e8 N/m on bodies of 1e-8 m/N: condition 1e4.
ROUNDING = 1e-9


@pytest.mark.parametrize("way", ["factored", "iterated"])
@pytest.mark.parametrize("held", [(), (3, 4), (1,)])
def test_forces_balance(way, held, monkeypatch):
    monkeypatch.setattr(linearised, "_FACTORED", 10**6 if way == "factored" else 0)
    system = built().bearing.bearing.system
    contact, assembly = system.contact, system.assembly
    face = system.condensed.interface(0.0)
    rng = np.random.default_rng(5)
    chosen = rng.permutation(len(contact.nodes))[: len(contact.nodes) // 3]
    nodes, weights = face.place[contact.nodes[chosen]], contact.weights[chosen]
    some = rng.standard_normal((len(chosen), 3, 3))
    blocks = 1e7 * (some @ some.transpose(0, 2, 1)) + 2e6 * rng.standard_normal((len(chosen), 3, 3))  # not symmetric
    ball = contact.pair[chosen] % face.ball_count
    tangents = {k: BallTangent.of(nodes[ball == k], weights[ball == k], blocks[ball == k]) for k in range(face.ball_count)}
    m = assembly.frame_size
    unknown = ~np.isin(np.arange(m), held)
    frame = 1e3 * np.eye(m)
    driver = Motions(
        1e-6 * rng.standard_normal((len(face.numbers), 3)), 1e-6 * rng.standard_normal((face.ball_count, face.extra)),
        rng.standard_normal(m),
    )  # fmt: skip
    force, q = Linearised(face, tangents, frame, unknown).forces(driver)
    back = face.moved(Motions(-force.nodes, -force.balls, q), q)
    x, mean = driver.nodes + back.nodes, driver.balls + back.balls
    wanted = np.zeros_like(x)
    moved = np.einsum("pa,pac->pc", weights, x[nodes])
    pressed = np.einsum("pcd,pd->pc", blocks, moved)
    for a in range(8):
        np.add.at(wanted, nodes[:, a], weights[:, a, None] * pressed)
    assert np.abs(force.nodes - wanted).max() < ROUNDING * np.abs(wanted).max()
    for k in range(face.ball_count):
        springs = face.springs(k, True)
        assert np.abs(force.balls[k] - springs * mean[k]).max() < ROUNDING * np.abs(springs * mean[k]).max()
    rest = (driver.frame - frame @ q - face.on_frame(wanted))[unknown]
    assert np.abs(rest).max(initial=0.0) < ROUNDING * np.abs(wanted).sum()
    assert not q[~unknown].any()
