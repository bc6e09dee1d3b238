"""Deliberate faults of one line each: does a test fail on every one of them?

``faults.toml`` lists them: the file, the text that is replaced (it occurs once), what it becomes, the tests that must catch it,
and what the fault does.  ``make mutants`` puts each into a copy of the sources and runs its tests there.

faults      the table
trial       a fault in a copy of the sources, and its tests
warm        the process that runs them
kernels     compiled kernels that a fault leaves as they are
"""
