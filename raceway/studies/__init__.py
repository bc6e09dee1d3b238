"""Many runs, or many numbers, made into one answer.  Studies call ``raceway.pipeline.run`` and never reach into a time loop.

reference          the reference cases in ``raceway/data/cases.json``
verify             every case against this program's own numbers; verify_bearings, verify_impacts: how each is computed
compare            one scene varied along axes: the table and what causes what; axes, effects, findings, explain, causes,
                   inertia, phrases, comparison: its parts, from the numbers to words and picture
sweep              one scene at thousands of points: a package, with its store, what executors compute, and data sets
processes          tasks of a study in processes of their own
"""
