"""Builders of the kinds of bodies: from scene and plan to a system that can be settled and stepped.

``build(scene, plan) -> Built`` in a file for each ``bodies.kind``; ``raceway.model`` chooses.

basis       what all kinds share: geometry, Hertz contacts, parameters of the law, loads, mass, excitation
rigid       only the contacts deform
"""
