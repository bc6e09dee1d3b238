"""The article's own model, run: elastic rings and balls in nodal contact, beside condensed and rigid bodies.

design       the runs: four static load cases and one operating point under two excitations, each with three kinds of bodies
run_one      one run and its row: numbers, cost, or the reason of a failure
told         progress over all runs, with the time that the plans leave
deviations   rows held against Hertz and against condensed bodies
study        all runs one at a time, kept as they end:  ``elastic_article()``
figures      pressures, ball loads, K and |Z|
report       the page;  files: page, pictures, JSON and CSV on disk;  screen: a short table
words        numbers in words
command      ``raceway study article --bodies elastic``
"""
