"""Newmark's method and the generalised-alpha method: Newton in the displacement of the new step.

Notes
-----
M [(1 - am) a1 + am a0] + (1 - af) r1 + af r0 = 0 with r = f + C v + K q - F,
q1 = q0 + dt v0 + dt^2 [(1/2 - beta) a0 + beta a1],  v1 = v0 + dt [(1 - gamma) a0 + gamma a1].
The a of generalised-alpha is an algorithmic quantity: it is carried from step to step, never recomputed from the
balance of forces, which would cost an order.  Newmark is am = af = 0.  The rates of balls that are condensed follow the
second-order backward difference.

References
----------
Newmark, J. Eng. Mech. Div. ASCE 85 (1959); Chung, Hulbert, J. Appl. Mech. 60 (1993), equations 16 to 27.

scheme     ``OneStep``;  compiled, stepped: its loops
"""
