"""Condensed bodies with resultants: kernels, structural compliances, whole bearings."""
