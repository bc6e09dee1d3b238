"""Coefficients for the rotor program ROSS."""
