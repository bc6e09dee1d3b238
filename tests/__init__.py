"""Tests of Raceway; ``validation.reference`` holds independent implementations to test against."""
