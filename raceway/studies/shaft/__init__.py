"""A shaft with a disc on two of our bearings, whirling with its unbalance.

rotor     a shaft as Timoshenko elements in forward whirl; with the rig's disc, the response of bearing and sensor
bearing   the response of the scene's bearing to the shaft's load, and the motion that shaft and bearing have in common
"""
