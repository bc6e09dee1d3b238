"""A shaft with a disc on two of our bearings, whirling with its unbalance.

beam            a shaft as Timoshenko elements in forward whirl, with rotary inertia and gyroscopic moments
rotor           the rig's shaft and disc: what tested bearing and sensor do under unbalance, force and moment
shaft_load      the force and the moment that a shaft passes on to a bearing: an excitation;  shaft_load_kernel: compiled
bearing         what a bearing does under them, by ``raceway.pipeline.run``
balance         the fixed point at which shaft and bearing agree
"""
