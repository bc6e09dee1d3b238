"""Stiff and extreme cases, each with an expectation."""
