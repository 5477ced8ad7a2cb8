"""The same blocks on Dask, or on plain processes: what Dask is measured against."""

import multiprocessing
import signal
import time
from contextlib import contextmanager
from multiprocessing import resource_tracker

import dask
import psutil
from distributed import Client, KilledWorker, LocalCluster, as_completed, wait
from distributed.utils import LoopRunner

import parts


@contextmanager
def killed_at_ctrl_c():
    """Kills the processes that this one has started: asked to end, they finish their blocks first."""
    try:
        yield
    except KeyboardInterrupt:
        for process in multiprocessing.active_children():
            process.kill()
        raise


@contextmanager
def ctrl_c_blocked():
    """Threads and processes that begin here never see Ctrl-C: it reaches this thread alone. Windows has no such mask."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()
    own_mask = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, own_mask)


@contextmanager
def client(address, workers, folder):
    """A client of the scheduler at `address`, or of a local cluster of `workers` processes of one thread each."""
    # A worker may be lost through no fault of its block, on a cluster that takes machines back all the time.
    # Stacks are sampled every 10 ms otherwise, and all that they would show is one native call.
    settings = {"distributed.scheduler.allowed-failures": 10, "distributed.worker.profile.enabled": False}
    with dask.config.set(settings):
        if address is None:
            runner = LoopRunner()
            with ctrl_c_blocked():
                runner.start()
            with killed_at_ctrl_c(), LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                dashboard_address=None,
                local_directory=str(folder),
                silence_logs="ERROR",
                loop=runner.loop,
            ) as cluster, Client(cluster) as own, killed_at_ctrl_c():
                yield own
        else:
            with Client(address) as own:
                many = [name for name, worker in own.scheduler_info(n_workers=-1)["workers"].items() if worker["nthreads"] != 1]
                if many:
                    raise ValueError(
                        f"{len(many)} workers of {address} have several threads, {many[0]} for one; an instance takes a "
                        "process of its own: start them with `dask worker --nworkers N --nthreads 1`"
                    )
                own.upload_file(str(parts.Path(__file__).with_name("parts.py")))
                yield own


def on_dask(own, job, blocks, fingerprint, finished):
    """Runs blocks `(first scene, rows)`; calls `finished(scenes, failed, seconds)` after each.

    Returns the reasons of blocks that were given up, by first scene.
    """
    futures = {
        own.submit(parts.run_part, job, first, rows, fingerprint, pure=False, key=f"part-{first:06d}-{fingerprint[:8]}"): first
        for first, rows in blocks
    }
    given_up = {}
    for future in as_completed(futures):
        try:
            finished(*future.result())
        except (KilledWorker, parts.host.Failure) as error:
            given_up[futures[future]] = f"{type(error).__name__}: {error}"
        future.release()
    return given_up


def warm_up(own, job):
    """Opens the FMU in every worker."""
    names = list(own.scheduler_info(n_workers=-1)["workers"])
    wait([own.submit(_open, job, workers=[name], pure=False) for name in names])


def _open(job):
    parts._instance(job, parts._scratch())


def cpu_of_all():
    """CPU seconds of this process and everything it has started: with a local cluster all of Dask."""
    own = psutil.Process()
    times = [process.cpu_times() for process in (own, *own.children(recursive=True))]
    return sum(each.user + each.system for each in times)


def _process(job, fingerprint, blocks, results, ready, go):
    _open(job)
    ready.release()
    go.wait()
    begin = time.process_time()
    while (block := blocks.get()) is not None:
        parts.run_part(job, *block, fingerprint)
    results.put(time.process_time() - begin)


def on_processes(job, blocks, fingerprint, processes):
    """Runs blocks on plain processes that take them from one queue; returns seconds by the clock and of CPU, both
    without the start-up."""
    context = multiprocessing.get_context("spawn")
    queue, results, ready, go = context.Queue(), context.Queue(), context.Semaphore(0), context.Event()
    own = [context.Process(target=_process, args=(job, fingerprint, queue, results, ready, go)) for _ in range(processes)]
    for process in own:
        process.start()
    try:
        for _ in own:
            if not ready.acquire(timeout=120.0):
                raise RuntimeError("a process did not start within 120 s")
        begin = time.perf_counter()
        for block in blocks:
            queue.put(block)
        for _ in own:
            queue.put(None)
        go.set()
        cpu = sum(results.get(timeout=3600.0) for _ in own)
        return time.perf_counter() - begin, cpu
    finally:
        for process in own:
            process.join(timeout=10.0)
            process.kill()
