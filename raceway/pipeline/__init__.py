"""One run: scene, plan, model, equilibrium, motion, identification, result.

front            ``raceway.run``: one scene in any form, computed
run              the order of these steps, and the time that they may take
equilibrium      static equilibrium under the constant loads; pressures, ball-pass frequencies
simulate         how a motion begins, and the motion
identified       what is identified in motions, what run-ups and friction leave in it
error            relative errors of Z: time step, fit, total
transient_error  relative errors of Z: what has not died out, and what the start decides
plausible        warnings, and the spread of K over hypotheses that the scene leaves at their defaults
uncertainty      intervals of headline quantities, from the errors and spreads of the others
gradient         derivatives by the keys of the scene;  first_order: of its numbers, and their band over tolerances
quantities       numbers of plug-ins at one solved point
warm             steady temperatures of scenes with [heat]
result           the result: result.json, formats of results;  content: its keys;  run_screen, run_parts: its tables on a screen
"""

#: A run is stopped beyond so many times its predicted time; predictions are within a factor of three of measured ones.
PATIENCE = 20.0
