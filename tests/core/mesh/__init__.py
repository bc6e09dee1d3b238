"""Meshes: what they hold, how good they are, how they are made, read and written."""
