"""A second process that compiles kernels into the cache while this one compiles others: the first run of a clone waits half as long."""

import atexit
import multiprocessing
import subprocess
import sys
from functools import cache

from raceway.core import jit, wheel_kernels
from raceway.core.threads import usable_cores


@cache
def compile_beside(*names: str) -> None:
    """Start a process that compiles these kernels, "module:name", in turn, unless they are there or no processor is left for it.

    Who needs one of them meanwhile waits for it; should the process end early, it compiles the kernel itself.
    """
    folder = jit.kernel_folder()
    busy = usable_cores() < 2 or multiprocessing.parent_process() is not None or wheel_kernels.writing
    if busy or folder is None or folder.unwritable or wheel_kernels.folder() is not None:
        return
    missing = [name for name in names if name not in jit.awaited and not jit.kernel_named(*name.split(":")).kept]
    if not missing:
        return
    command = [sys.executable, "-P", "-m", __name__, *missing]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, start_new_session=True)
    atexit.register(process.kill)
    assert process.stdout is not None
    finished = map(str.strip, process.stdout)
    jit.awaited.update(dict.fromkeys(missing, finished))


if __name__ == "__main__":
    for name in sys.argv[1:]:
        jit.kernel_named(*name.split(":")).compile()
        sys.stdout.write(f"{name}\n")
        sys.stdout.flush()
