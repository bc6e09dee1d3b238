"""Built-in identifiers.

fft_1x           Fourier line over whole turns;  whole_turns: the window that it is taken over
sine_fit         least squares of mean, drift and harmonics
order_tracking   1x line along a changing speed
impedance_fit    K and C from Z at several whirl speeds
tangent          linear response of the static equilibrium
"""
