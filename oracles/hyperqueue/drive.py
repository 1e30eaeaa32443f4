"""Has HyperQueue start the tasks of a sweep: one line of JSON comes in, lines of JSON go out.

In, on standard input: {"server": FOLDER or null, "workers": N, "crashes": N, "tasks": [{"name", "args", "cwd", "stderr", "alone"}]}.
Without a server, one is started in this process, with N workers of one core each; it ends with this process.
Out, on standard output: {"finished": N, "failed": N, "total": N} whenever it changes, and at the end {"tasks": {NAME: ERROR}} of those
that failed. Other lines are HyperQueue's own.

A task that runs alone takes all cores of its worker, and starts when all tasks before it are done.
Standard input stays open as long as the tasks are wanted: when it closes, this process ends.
"""

import contextlib
import json
import os
import sys
import threading
from typing import Any

from hyperqueue.client import Client
from hyperqueue.cluster import WorkerConfig
from hyperqueue.ffi.protocol import ResourceRequest

from hyperqueue import Job, LocalCluster


def tell(**message: Any) -> None:
    """Writes one line of JSON."""
    print(json.dumps(message), flush=True)


def end_with_the_caller() -> None:
    """Ends this process when standard input closes: then no one waits for the tasks."""
    sys.stdin.read()
    os._exit(1)


def job_of(wanted: dict[str, Any]) -> Job:
    """The tasks as one job. No failure cancels the others."""
    job = Job(max_fails=None, name="featherbench sweep")
    before: list[Any] = []
    for task in wanted["tasks"]:
        alone = task["alone"]
        started = job.program(
            task["args"],
            cwd=task["cwd"],
            stdout=None,
            stderr=task["stderr"],
            name=task["name"],
            deps=list(before) if alone else [],
            # The number of workers that may end under a task before it is given up.
            crash_limit=wanted["crashes"],
            resources=ResourceRequest(cpus="all" if alone else 1),
        )
        # What runs alone has waited for all others: what comes later need not name those again.
        before = [started] if alone else [*before, started]
    return job


def drive(wanted: dict[str, Any]) -> None:
    """Submits the tasks and waits for them."""
    with contextlib.ExitStack() as stack:
        if wanted["server"] is None:
            cluster = stack.enter_context(LocalCluster())
            for _ in range(wanted["workers"]):
                cluster.start_worker(WorkerConfig(cores=1))
            client = cluster.client()
        else:
            client = Client(wanted["server"])
        job = job_of(wanted)
        submitted = client.submit(job)

        def progress(jobs: dict[int, Any]) -> None:
            for now in jobs.values():
                tell(finished=now["finished"], failed=now["failed"], total=now["total"])

        failed = client.connection.wait_for_jobs((submitted.id,), progress)
        tasks = client.get_failed_tasks(submitted) if failed else {}
        tell(tasks={job.task_by_id(task).label: context.error for task, context in tasks.items()})


def main() -> None:
    """Reads the tasks and has them done."""
    wanted = json.loads(sys.stdin.readline())
    threading.Thread(target=end_with_the_caller, daemon=True).start()
    drive(wanted)
    sys.stdout.flush()
    # The thread that reads standard input would keep the interpreter from ending.
    os._exit(0)


if __name__ == "__main__":
    main()
