"""Cases that misbehave, for processes of their own: nothing heavy is imported."""

from __future__ import annotations

import os
import time

from raceway.studies.stability.case import Near, judged


def hang(case, registry):
    time.sleep(60.0)


def die(case, registry):
    os._exit(7)


def answer(case, registry):
    return [judged(case.name, {}, "one", Near(0.1, "why"), 1.0, lambda: (case.arguments["value"], None))]
