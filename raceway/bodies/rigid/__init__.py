"""Rigid rings and balls: only the contacts deform.

kind    the plug-in
build   the bearing of a scene
"""
