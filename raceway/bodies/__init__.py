"""Builders of the kinds of bodies: from scene and plan to a system that can be settled and stepped.

``build(scene, plan) -> Built`` in a file for each ``bodies.kind``; ``raceway.bodies.model`` chooses.

elastic     every node moves: pressures at points, or a calibrated force a contact
elastic_report  what a result tells of those;  elastic_points, elastic_resultants: of their contacts
basis       what all kinds share: geometry, Hertz contacts, parameters of the law, loads, mass, excitation
rigid       only the contacts deform
condensed   elastic rings and balls, one force for each contact
inertia     what it costs that condensed bodies follow at once
patches     the same with pressures at surface points (contact.discretisation = "nodal")
patch_report  what a result tells of those
locking     materials too incompressible for elements under surface points
"""
