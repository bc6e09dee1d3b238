"""What studies share.

axes           ``KEY=a,b,c`` and ``KEY=start:stop:count``
points         the scene at one point of a study
processes      tasks in processes of their own
measured_run   one setting, run a few times, with its cost
row_store      finished rows on disk
reference      published reference cases
page           a self-contained HTML page
"""
