from raceway import hookimpl

seen = []


@hookimpl
def raceway_plan_made(plan):
    """The plan is ready; nothing has been built."""
    seen.append("plan")


@hookimpl
def raceway_chunk_done(done, total):
    """Some thousands of steps are done; an exception stops the run.  In a search ``total`` is 0."""
    seen.append("chunk")


@hookimpl
def raceway_run_finished(result):
    seen.append("finished")


@hookimpl
def raceway_run_failed(error):
    """``error.state`` may hold the last good arrays."""
    seen.append("failed")
