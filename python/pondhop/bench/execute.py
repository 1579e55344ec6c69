"""The runs that are missing, in parallel processes."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from itertools import islice
from threading import Thread

from pondhop.bench.farm_sets import Task
from pondhop.bench.measure import Entrant, Request, Run, TimeLimit, measure, warm_up
from pondhop.bench.results import Results


def requests(
    tasks: Iterable[Task], entrants: Sequence[Entrant], time_limits: Sequence[TimeLimit], seeds: Sequence[int]
) -> list[Request]:
    """Return every planner on every farm with every time limit and seed, farm by farm."""
    return [
        Request(task, entrant, time_limit, seed)
        for task in tasks
        for entrant in entrants
        for time_limit in time_limits
        for seed in seeds
    ]


def execute(
    missing: Sequence[Request], results: Results, *, num_jobs: int = 1, advance: Callable[[Request], object]
) -> None:
    """Run what is asked for and add each run to the results as soon as it is finished.

    Planners run in processes of their own, one for each job, so that neither a progress bar nor another planner takes
    part in what is measured. More jobs than cores would measure how the cores are shared.

    Parameters
    ----------
    missing
        The runs, begun in this order.
    results
        Where they go.
    num_jobs
        How many run at once.
    advance
        Called with each request when its run is finished.

    Raises
    ------
    InvalidInput
        As `pondhop.solve`.
    BrokenProcessPool
        If a process dies, as for want of memory. Whatever is raised, finished runs stay.
    """
    context = multiprocessing.get_context("spawn")
    others = set(multiprocessing.active_children())
    with ProcessPoolExecutor(num_jobs, context, _begin_process) as pool:
        try:
            # No more are handed over than run at once: farms are not held twice, and an end is an end at once.
            waiting = iter(missing)
            under_way = {pool.submit(_measure_warm, request): request for request in islice(waiting, num_jobs)}
            while under_way:
                finished, _ = wait(under_way, return_when=FIRST_COMPLETED)
                done = {future: under_way.pop(future) for future in finished}
                under_way |= {pool.submit(_measure_warm, request): request for request in islice(waiting, len(done))}
                for future, request in done.items():
                    run, routes = future.result()
                    results.add(run, routes)
                    advance(request)
        except BaseException:
            for process in set(multiprocessing.active_children()) - others:
                process.terminate()
            raise


def _begin_process() -> None:
    """Let Ctrl-C end a process without a word, and the end of the benchmark, however it comes, end it too."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


_warmed: set[str] = set()
"""Labels of the planners that this process has run."""


def _measure_warm(request: Request) -> tuple[Run, list[list[int]]]:
    entrant = request.entrant
    if entrant.label not in _warmed:
        warm_up(entrant)
        _warmed.add(entrant.label)
    return measure(request)
