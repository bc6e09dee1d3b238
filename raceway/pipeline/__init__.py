"""One run: scene, plan, model, equilibrium, motion, identification, result.

run            the order of these steps
settle         static equilibrium under the constant loads
starting       initial state of a motion: on its orbit, under a growing force, at rest
simulate       from model and equilibrium to recorded motion
allowance      processor time that a run may take beyond its plan
damping        where the damping comes from; a run at both ends of the band of time constants
motion         the table ``motion`` of a result
ball_pass      frequencies of cage, ball passes and ball spin
pressure       peak pressure and semi-axes of contacts
plausibility   warnings: balls without load, ellipses over the groove's edge
gradient       derivatives by the keys of the scene
error          relative errors of Z
result         the result: result.json
facts          what it says in short
"""
