"""Every registered combination."""
