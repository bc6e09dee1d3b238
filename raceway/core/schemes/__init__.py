"""Ways through time: a scheme is stated once, and has a compiled loop and one that steps from Python.

drivers    what a scheme is made of, and ``integrate``, which takes the one that a bearing asks for
one_step   Newmark's method and generalised-alpha;  explicit: central differences;  static: a series of equilibria
compiled   what compiled loops share: their arguments, the ramp, the rows of a record
advance    runs a compiled loop in chunks
"""
