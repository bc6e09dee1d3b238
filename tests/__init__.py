"""Tests of Raceway; ``tests.reference`` holds independent implementations to test against."""
