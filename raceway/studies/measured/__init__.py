"""Measured signals of a rig, and the bearing's stiffness in them: ``raceway identify``.

front           ``raceway.identify``;  identified: its answer;  command: ``raceway identify``
signals         a record's columns from CSV files, arrays, data frames;  heads: how columns may be named
recording       a record of two displacements with a mark or a speed: what is needed, what is refused
angle           the shaft's angle at every sample;  marks: of a once-per-turn probe
orders          1x line against speed, by least squares in blocks of turns; its scatter
run_out         the vector that a slow roll shows
inversion       from the line at the sensor to force, moment and motion in the bearing
identify        all of it: K, C, uncertainty, sensitivities;  from_files: from records, in files or in memory
figures         turns, spectrum and orbits of a record
"""
