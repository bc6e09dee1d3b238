"""Rigid rings and balls: only the contacts deform.

build   the system of a scene
"""
