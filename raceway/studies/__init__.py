"""Many runs, or many numbers, made into one answer.  Studies call ``raceway.pipeline.run`` and never reach into a time loop.

compare     effects of keys of a scene, everything else the same
sweep       a scene at thousands of points, in a store
precision   error against run time
stability   stiff and extreme cases with expectations
verify      reference cases against this program
article     the article's figures, and a verdict on each of its claims
map         hardening and softening of k(speed)
rig         a simulated test rig;  shaft: its shaft on two bearings
measured    K and C from measured signals
ross        coefficients for the rotor program ROSS
view        pictures of bearings and meshes
many        points, processes and stores that studies share
command     ``raceway study``
"""
