"""A damping far below the rule of thumb of rotor programs, in words."""

from __future__ import annotations

from collections.abc import Mapping

from raceway.answers.quantities import C_ERROR, C, K

#: Damping over stiffness by the rule of thumb of rotor programs [s]: ROSS 2.3 takes c = 1.25e-5 s k for a ball bearing without a
#: given damping (``ross.BallBearingElement``), the middle of its "typical range" of 0.25e-5 to 2.5e-5 s.
RULE_OF_THUMB_S = 1.25e-5
#: Part of the rule's damping below which a damping is next to nothing: a twentieth of the lower end of the typical range.
_NOTHING = 1e-2

#: Of scenes without any damping.
DRY = "dry: no damping is modelled"
#: What to do in the scene.
_REMEDY = "set contact.damping or contact.time_constant"


def dry_damping_note(content: Mapping[str, object]) -> str | None:
    """The sentence for one run.

    Parameters
    ----------
    content : of result.json

    Returns
    -------
    None where nothing is identified, or where C is not far below the rule of thumb.
    """
    if content["identification"] is None:
        return None
    error, damping = C_ERROR.of(content), C.of(content)
    above_error = error is None or abs(damping) > error
    return dry_damping_words(damping if above_error else None, K.of(content))


def dry_damping_words(damping: float | None, stiffness: float, remedy: str = _REMEDY) -> str | None:
    """The sentence for C [N s/m], None where it is not resolved, and K [N/m]; None where C is not far below the rule of thumb."""
    rule = RULE_OF_THUMB_S * abs(stiffness)
    if damping is not None and abs(damping) > _NOTHING * rule:
        return None
    state = "is not resolved" if damping is None else "is 0" if damping == 0.0 else f"is {damping:.2g} N s/m"
    return f"C {state}, dry; the rule of thumb of rotor programs, 1.25e-5 s K, gives {rule:.2g} N s/m: {remedy}"
