"""Measurements that the documents quote, and what they share with the tests; run from the root of the repository.

robustness    checks that take minutes: ``python -m checks [NAME...]``
validation    the same physics by independent code, and scenes, cases and helpers that tests share
mutants       deliberate faults of one line, and whether the tests catch them
documents     parts of README and docs that are made from the program;  reports: pages of measured claims
claims        a test's claim beside a report's row;  night: evidence of a commit
against_calculix, calculix, explicit_step, kernel   speed, and numbers of another program
"""
