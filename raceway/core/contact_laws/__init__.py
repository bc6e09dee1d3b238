"""Compiled kernels of the built-in contact laws; the classes with the options are in ``raceway.contact_laws``.

hertz     Q = K delta^1.5, or its foundation at surface points
penalty   p = k_n delta, at surface points or integrated over the overlap ellipse
power     powers of the approach that both need
"""
