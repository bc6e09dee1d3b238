"""Dynamic stiffness from recorded motion.

lines            spectral lines at given frequencies, by least squares
identification   complex dynamic stiffness from the 1x lines of force and displacement
"""
