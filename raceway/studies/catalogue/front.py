"""The catalogue of bearings, for Python: ``raceway.catalogue``."""

from __future__ import annotations

from raceway.errors import SceneError
from raceway.framework.doors import door
from raceway.scene.catalogue import Preset, found_by, no_preset


@door
def catalogue(pattern: str = "*") -> tuple[Preset, ...]:
    """Bearings of the catalogue, which ``preset`` of a scene's [bearing] takes by name.

    Parameters
    ----------
    pattern : as in a shell (``"70*C"``), or a part of the name; in any case

    Returns
    -------
    tuple of Preset
        Each with ``name``, ``title``, ``table`` (the [bearing] table), ``facts`` (value, source, scatter) and ``stiffness_error``

    Raises
    ------
    SceneError
        None has such a name; the nearest five.

    Examples
    --------
    >>> import raceway as rw
    >>> [one.name for one in rw.catalogue("7014*")]
    ['7014C', '7014A5', '7014A']
    >>> rw.catalogue("7014C")[0].table["ball_count"]
    20
    """
    found = tuple(found_by(pattern))
    if not found:
        raise SceneError.at("pattern", pattern, no_preset(pattern))
    return found
