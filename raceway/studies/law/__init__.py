"""One contact of a bearing in the laboratory: what its law does with a gap and the gap's rate, beside Hertz'.

contact   the contact of a scene, and its force at any approach and rate
cycle     a harmonic motion of the approach: hysteresis loop, energy a cycle, K and C
front     both, as ``raceway.law`` and its object;  picture: four panels;  command: ``raceway law``
"""
