"""Error against run time: which setting is good enough.

design      settings that are run
reference   the value that they are held against, with its bound
front       ``raceway.precision``
study       the runs;  command: ``raceway precision``
result      errors, fronts, orders
picture     files of a study;  screen: its table;  labelled: its data set
labels      beside points, none on another
"""
