"""How structured meshes are made: spacings along a line, rings swept from a profile, balls as cubed spheres.

spacing   graded points on a line            ring   a ring with the true groove
sphere    a ball: inner cube and six blocks  size   how many cells and bytes, and what is refused
ring_shape  the profile of a ring from the dimensions of a scene
outline   its section without the groove, plain or from a polygon
"""
