"""Kinds of plug-ins.

contracts   duties of each kind, numbered
hookspecs   hooks that a plug-in may implement
doors       arguments of public functions, read by their annotations
options     attrs fields with unit, help and rule
rules       keys that cannot stand or do nothing, when and why, as data
duties      duties as the program calls them: faults are put to the plug-in, what is left out has its default
shown       short texts and tables of results, for terminals and notebooks
loading     how plug-ins are found, loaded and tried: the registry
estimate    sentences of how an error was estimated, an enumeration
"""
