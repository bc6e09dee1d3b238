"""Kinds of plug-ins, and how they are found.

contracts   duties of each kind, numbered
hookspecs   hooks that a plug-in may implement
doors       arguments of public functions, read by their annotations
options     attrs fields with unit, help and rule
registry    plug-ins by kind and name
rules       keys that cannot stand or do nothing, when and why, as data
duties      duties as the program calls them: faults are put to the plug-in, what is left out has its default
sources     entry points and one-off files
packages    what this project's own packages add, installed or not;  installed: commands and names beside ``raceway``
probe       compiled kernel of a plug-in by its declared signature, and trial calls of it before a run
shown       short texts and tables of results, for terminals and notebooks
estimate    sentences of how an error was estimated, an enumeration
"""
