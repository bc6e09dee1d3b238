"""Cylindrical roller bearings for Raceway: a kind of bodies and its contact law."""

from __future__ import annotations

from raceway import hookimpl
from raceway_cylindrical_rollers.kind import CylindricalRollers
from raceway_cylindrical_rollers.law import Palmgren


@hookimpl
def raceway_bodies() -> list[type]:
    return [CylindricalRollers]


@hookimpl
def raceway_contact_laws() -> list[type]:
    return [Palmgren]
