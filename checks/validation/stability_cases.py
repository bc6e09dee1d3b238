"""Cases that misbehave, for processes of their own: nothing heavy is imported."""

import os
import time

from raceway_checks.stability.study import Limit


def hang(rows, bench):
    time.sleep(60.0)


def die(rows, bench):
    os._exit(7)


def answer(rows, bench, value=None):
    rows.check("one", 1.0 + {"near": 0.05, "far": 1.0}[value], "why", Limit.equal(1.0, 0.1))
