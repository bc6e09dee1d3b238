"""Ways through time: a scheme is stated once, and has a compiled loop and one that steps from Python.

schemes    ``OneStep``, ``Explicit``, ``Static``, and ``integrate``, which takes the loop that a bearing asks for
compiled   loops over small systems;  advance: takes them in chunks;  stepped: the same, step for step, for systems stepped from Python

Newmark's method and generalised-alpha, Newton's method in the displacement of the new step:

M [(1 - am) a1 + am a0] + (1 - af) r1 + af r0 = 0 with r = f + C v + K q - F,
q1 = q0 + dt v0 + dt^2 [(1/2 - beta) a0 + beta a1],  v1 = v0 + dt [(1 - gamma) a0 + gamma a1].
The a of generalised-alpha is an algorithmic quantity: it is carried from step to step, never recomputed from the
balance of forces, which would cost an order.  Newmark is am = af = 0.  The rates of balls that are condensed follow the
second-order backward difference.

Central differences in the velocity form, explicit in the contacts, implicit in the constant linear damping:

v(1/2) = v0 + dt/2 a0,  q1 = q0 + dt v(1/2),  (M + dt/2 C) a1 = F1 - f(q1, v0 + dt a0) - K q1 - C v(1/2),
v1 = v(1/2) + dt/2 a1.  Contact forces that depend on the rate see the predicted velocity v0 + dt a0, so that the order
stays 2 with damped contacts.  Stable for dt < 2 / (largest natural frequency of the tangent), and
for less where contacts damp: ``Ring.damped_time_step``.

Static, the motion as a series of equilibria: f(q) + K q = F at the end of each step, begun at the last two equilibria,
extrapolated.  Without friction and gyroscopic moments the forces of the balls have a potential, which is minimised; with them a
root is found.

Newmark, J. Eng. Mech. Div. ASCE 85 (1959); Chung, Hulbert, J. Appl. Mech. 60 (1993), equations 16 to 27.
Belytschko, Liu, Moran: Nonlinear Finite Elements for Continua and Structures, box 6.1.
"""
