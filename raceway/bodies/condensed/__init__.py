"""Elastic rings and balls condensed onto contact resultants.

kind               the plug-in;  plan: memory and time of its sections, seats that hold nothing
build              the bearing of a scene, and the table ``model`` of its result
compliances        structural compliances of rings and balls, calibrated on contacts at surface points
calibration_error  what that calibration leaves under the scene's loads
inertia            first natural frequencies of the bodies against that of the excitation: error of a massless condensation
"""
