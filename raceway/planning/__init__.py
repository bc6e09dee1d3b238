"""What a scene needs, what is left out and why, and what it will cost; nothing is built here.

plan           the plan of a scene
parts          parts that are kept or left out, each with its reason;  decisions: on coordinates, balls, bodies, motion, output
combinations   combinations that cannot run
implausible    values that are possible and unlikely
modules        modules that a run imports
recording      turns, steps and samples of a motion
steady_orbits  steady orbits that a run searches for
mesh           size of the scene's mesh;  sections: of condensed rings;  patches: of surface points;  elastic: of full models
closed_form    closed formulas for plans and first guesses
wall_time      predicted time of a run;  machine: speed of this machine
"""
