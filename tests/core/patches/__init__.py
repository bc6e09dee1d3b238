"""Condensed bodies with pressures at surface points: single contacts, whole bearings, what is refused."""
