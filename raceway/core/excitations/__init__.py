"""Compiled forces of the built-in excitations; the classes with the options are in ``raceway.plugins.excitations``."""
