"""What compiled kernels need.

dense           5x5 linear algebra without allocation
plugin_kernel   signature of a plug-in's kernel, checked before a loop takes it
"""
