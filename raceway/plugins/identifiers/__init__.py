"""Dynamic stiffness from motion.

one_frequency   of whole turns, by least squares, of the tangent, over several whirl speeds
order_tracking  along a changing speed
"""
