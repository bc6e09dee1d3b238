"""Error against run time: which setting is good enough."""
