"""For all tests of the repository: those that need what pip does not install are skipped loudly, or fail.

One thread of linear algebra, as the commands take: two processes of tests with two threads each wait for each other, three times as
long.  It is read when numpy is imported, which the plug-ins below do.  Kernels of CUDA devices run as Python, unless NUMBA_ENABLE_CUDASIM is 0.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_ENABLE_CUDASIM", "1")
os.environ |= {"RACEWAY_PLUGINS": "", "RACEWAY_DISABLE": ""}

pytest_plugins = [
    "checks.validation.fixtures",
    "checks.validation.system_libraries",
    "checks.claims",
    "checks.processor_time",
]
