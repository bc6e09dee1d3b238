"""Bodies of revolution: exact compliances of bodies meshed uniformly in azimuth, one small real system a harmonic.

profile        Profile: nodes and quadrilaterals of a section, its race and its seat
ring_profile   sections of rings: graded to a contact, or coarse
ball_profile   section of a ball about its rolling direction
sector         matrices of one sector, harmonic by harmonic
factor         sparse factorisation, and condensation by it
harmonics      which harmonics are solved, and the weights with which their compliances add up at an offset
grooves        compliances between groove centres
body           Revolution: compliances between nodes, natural frequencies
cached         compliances through the cache on disk
ball           the floating ball: one dimensionless compliance for all balls

References
----------
D. L. Thomas, Dynamics of rotationally periodic structures, Int. J. Numer. Meth. Engng 14 (1979) 81-102: block-circulant
matrices split into one system for each harmonic.
"""
