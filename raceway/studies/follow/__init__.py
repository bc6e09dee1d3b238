"""K as a curve: the branch of steady orbits over a continuous key, through folds.

parameter   systems and boundary-value problems over one key of a scene
row         K, C, amplitude, phase, contacts and stability of one orbit
walk        follows one branch: special points, peaks, contacts that open, how it ends
study       the branch from the first value on, branches of twice the period, what happens where it is unstable
instead     motion that a ring makes where the orbit is unstable, by time integration
result      the curve: follow.json, follow.csv
front       ``raceway.follow``;  command: ``raceway follow``
picture     amplitude and K over the key;  screen: the tables
"""
