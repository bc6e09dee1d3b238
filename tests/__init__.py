"""Tests of Raceway; ``checks.validation.reference`` holds independent implementations to test against."""
