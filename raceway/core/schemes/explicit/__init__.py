"""Central differences in the velocity form: explicit in the contacts, implicit in the constant linear damping.

Notes
-----
v(1/2) = v0 + dt/2 a0,  q1 = q0 + dt v(1/2),  (M + dt/2 C) a1 = F1 - f(q1, v0 + dt a0) - K q1 - C v(1/2),
v1 = v(1/2) + dt/2 a1.  Contact forces that depend on the rate see the predicted velocity v0 + dt a0, so that the order
stays 2 with damped contacts.  Stable for dt < 2 / (largest natural frequency of the tangent), and
for less where contacts damp: ``Ring.damped_time_step``.

References
----------
Belytschko, Liu, Moran: Nonlinear Finite Elements for Continua and Structures, box 6.1.

scheme     ``Explicit``;  compiled, stepped: its loops
"""
