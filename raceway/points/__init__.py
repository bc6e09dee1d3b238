"""One scene at many points, and one engine that computes them: in, rows out as they finish, kept and resumed, by any executor.

axes        values along keys of a scene, lists and grids of points;  base: the scene at a point
engine      items of work, versions and plug-ins that decide a row; time and memory of runs
store       rows and states on disk;  dataset: labelled results, NetCDF and CSV
sweep       ``raceway.sweep``;  selection: a part of it;  plot: its pictures
compare     ``raceway.compare``;  effects: two-level factorial analysis and findings in words
band        ``raceway.band``;  sensitivities: derivatives by every number of a scene
workload    points before any is computed: mistakes, plug-ins and files in them, size and cost
function    ``raceway.function``: quantities as a function of arrays;  column_quantities: what it computes, with derivatives
follow, parameter, branch, attractor    ``raceway.follow``: the branch of steady orbits over a continuous key
"""
