"""Reference cases: published numbers, closed forms, and this program by two ways."""
