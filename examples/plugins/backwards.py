import attrs

from raceway import between, hookimpl, option


@attrs.frozen
class Backwards:
    """In this process, a few batches at a time, the last of them first."""

    name = "backwards"
    workers: int = option(3, help="batches that are taken together", rule=between(1, 100))

    def compute(self, work, batches):
        taken = []
        for batch in batches:
            taken.append(batch)
            if len(taken) == self.workers:
                yield from ((number, work(points)) for number, points in reversed(taken))
                taken.clear()
        yield from ((number, work(points)) for number, points in reversed(taken))


@hookimpl
def raceway_executors():
    return [Backwards]
