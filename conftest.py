"""For all tests of the repository: those that need what pip does not install are skipped loudly, or fail."""

pytest_plugins = ["validation.system_libraries", "benchmarks.claims"]
