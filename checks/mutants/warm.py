"""A process with libraries of others imported, which runs tests in forks of itself: their imports take longer than most tests.

It runs in a copy of the sources, of which it imports nothing but this package.  A line of input is a job in JSON: the cache's folder, kernels
to carry over, words for pytest, file of the output, limit of time [s], 0 for none.  It answers by pytest's exit code.
"""

import gc
import json
import os
import runpy
import signal
import sys
from contextlib import suppress
from importlib import import_module

from checks.mutants.kernels import carry_over


def serve(libraries: list[str]) -> None:
    """Import libraries, then run the jobs until there are no more."""
    runpy.run_path("conftest.py")  # sets what libraries read when they are imported
    for name in libraries:
        import_module(name)
    gc.freeze()  # none of this is searched for garbage at the end of each fork
    for line in sys.stdin:
        if not (fork := os.fork()):
            _run(**json.loads(line))
        _, status = os.waitpid(fork, 0)
        with suppress(ProcessLookupError):
            os.killpg(fork, signal.SIGKILL)  # what a test left behind
        print(os.waitstatus_to_exitcode(status), flush=True)


def _run(cache: str, kernels: list[tuple[str, str]], words: list[str], output: str, limit: int) -> None:
    """In a fork; a signal ends it beyond its time, in compiled code, too."""
    os.setsid()
    signal.alarm(limit)
    for number, path in enumerate((os.devnull, output, output)):
        os.dup2(os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND), number)
    os.environ["RACEWAY_CACHE_DIR"] = cache
    if kernels:
        carry_over(kernels)
    sys.exit(import_module("pytest").main(words))


if __name__ == "__main__":
    serve(sys.argv[1:])
