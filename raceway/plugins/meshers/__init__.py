"""Built-in meshers."""
