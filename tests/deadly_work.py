"""Work of a study and of a sweep that kills the process which computes the number 3; light, so that processes start fast."""

import os

import attrs


@attrs.frozen
class Deadly:
    """Ten times a number."""

    def fault(self):
        return None

    def __call__(self, numbers):
        if 3 in numbers:
            os._exit(11)
        return [10 * n for n in numbers]


def squared(number, registry):
    assert type(registry).__name__ == "Registry"
    return {"square": number**2, "process": os.getpid()}


def deadly(number, registry):
    if number == 3:
        os._exit(11)
    return squared(number, registry)
