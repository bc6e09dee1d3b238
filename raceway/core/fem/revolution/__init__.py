"""Bodies of revolution: exact compliances of bodies meshed uniformly in azimuth, one small real system a harmonic.

sections   nodes and quadrilaterals of a section: rings graded to a contact or coarse, a ball about its rolling direction
body       Revolution: matrices of a sector, compliances harmonic by harmonic, natural frequencies; the floating ball

D. L. Thomas, Dynamics of rotationally periodic structures, Int. J. Numer. Meth. Engng 14 (1979) 81-102: block-circulant
matrices split into one system for each harmonic.
"""
