"""Compiled kernels of the built-in contact laws; the classes with the options are in ``raceway.contact_laws``."""
