"""Rings and balls: from scene and plan to a system that can be settled and stepped.

``build(scene, plan) -> Built`` in a folder for each kind of bodies; ``model`` chooses.

model       the model of a scene: bodies, contacts, loads, constraints
basis       what all kinds share: geometry, Hertz contacts, parameters of the law, loads, mass, excitation
mounting    preload of a pair, axial displacement that is held
meshing     meshes of the bodies by the scene's mesher
mesh_fit    whether meshes have the size of the bearing
rigid       only the contacts deform
condensed   finite elements of rings and balls, condensed onto one resultant a contact
patches     the same, condensed onto pressures at surface points (``contact.discretisation = "nodal"``)
elastic     every node of rings and balls is a degree of freedom
"""
