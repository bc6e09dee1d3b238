"""Measured signals of a rig, and the bearing's stiffness in them: ``raceway identify``.

recording       a record of two displacements with a mark or a speed; its CSV file: what may stand in it, what is refused
angle           the shaft's angle at every sample;  marks: of a once-per-turn probe
orders          1x line against speed, by least squares in blocks of turns; its scatter
run_out         the vector that a slow roll shows
inversion       from the line at the sensor to force, moment and motion in the bearing
identify        all of it: K, C, uncertainty, sensitivities;  from_files: from CSV files;  command: ``raceway identify``
figures         turns, spectrum and orbits of a record
"""
