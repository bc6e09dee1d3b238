"""Published reference cases."""
