"""Built-in excitations.

bidirectional    a turning force, as of an unbalance
unidirectional   a harmonic force along a fixed direction
run_up           unbalance force under a changing speed
measured         a force from a CSV file
amplitude        amplitude law: constant, or m e w^2
"""
