"""One contact of a bearing on the bench: what its law does with a gap and its rate.

contact   the contact of a scene, and its forces, stiffnesses and dampings
cycle     a harmonic motion of the gap: hysteresis loop, energy a cycle, K and C
bench     both as an object;  front: ``raceway.law``;  command: ``raceway law``;  screen, picture: what it shows
"""
