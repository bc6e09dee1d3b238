"""Labels of ball loads on a picture: beyond the arrows, of all balls or of every nth, none on an arrow or on another."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from raceway.studies.view.bearing import Bearing, State

#: Height of the letters, and the mean width of one [pixels].
LETTERS, _LETTER = 26, 14.5
#: Between a label and what it must not touch [pixels].
_GAP = 9.0


def ball_labels(
    bearing: Bearing, state: State, top: float, seen: Callable[[np.ndarray], np.ndarray]
) -> list[tuple[str, tuple[float, float]]]:
    """Texts and their lower left corners [pixels].

    Parameters
    ----------
    top : the load whose arrow is longest [N]
    seen : points (n, 3) [mm] -> (n, 2) [pixels]
    """
    texts = [f"{k}: {load:.3g} N" for k, load in enumerate(state.load[: len(state.azimuth)])]
    half = np.array([[0.5 * _LETTER * len(text), 0.5 * LETTERS] for text in texts])
    tails, heads = (seen(points) for points in bearing.arrow_ends(state, top))
    along = heads - tails
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    # As far beyond the tip as the arrow would go on through the label.
    through = ((half + 1.2 * _GAP) / np.maximum(np.abs(along), 1e-9)).min(axis=1, keepdims=True)
    middle = heads + along * through
    share = np.linspace(0.0, 1.0, 25)[:, None, None]
    arrows = ((1.0 - share) * tails + share * heads).reshape(-1, 2)
    return [(texts[k], (float(middle[k, 0] - half[k, 0]), float(middle[k, 1] - half[k, 1])))
            for k in _chosen(middle, half, arrows, bearing.shape.ball_count)]  # fmt: skip


def _chosen(middle: np.ndarray, half: np.ndarray, arrows: np.ndarray, per_row: int) -> list[int]:
    """Every nth ball of each row, n as small as leaves room; those that have room where no n does."""
    touching = (np.abs(middle[:, None] - middle) < half[:, None] + half + _GAP).all(axis=2)
    np.fill_diagonal(touching, False)
    free = ~(np.abs(middle[:, None] - arrows) < half[:, None] + _GAP).all(axis=2).any(axis=1)

    def clear(balls: Sequence[int]) -> bool:
        return bool(free[balls].all()) and not touching[np.ix_(balls, balls)].any()

    for every in range(1, per_row + 1):
        balls = [k for k in range(len(middle)) if k % per_row % every == 0]
        if clear(balls):
            return balls
    kept: list[int] = []
    for k in range(len(middle)):
        if clear([*kept, k]):
            kept.append(k)
    return kept
