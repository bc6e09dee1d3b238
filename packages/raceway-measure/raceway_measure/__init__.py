"""Measurements.

fit     ``raceway fit``, ``raceway identify``: numbers from measured data
rig     ``raceway study rig``: signals of a test rig, and what can be read back from them
plugin  what this package adds to ``raceway``
"""
