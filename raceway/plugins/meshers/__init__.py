"""Meshers.

structured   hexahedra of a whole bearing
"""
