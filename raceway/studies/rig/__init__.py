"""``raceway study rig``: the article's test rig, its signals, and what can be read back from them.

sensors         the signals: noise, drift, run-out, changing speed
as_printed      the article's procedure, and other corrections for the shaft
error_split     one cause of error at a time
study           all speeds and loads;  command: ``raceway study rig``
figures, page, screen   its figures, page and table
"""
