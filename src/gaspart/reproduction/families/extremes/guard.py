"""Work that may hang: done in a separate process, which is killed when it does."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from multiprocessing import get_context
from multiprocessing.connection import Connection

from gaspart.errors import SceneError


def run_guarded(work: Callable, items: Sequence, limit: float) -> list:
    """Return `work(item)` for each item, in order, or None.

    An item that takes more than `limit` seconds, or ends its process, has the result None. Compiled code
    cannot be interrupted, so it is run in a child process, which can be killed. Raises SceneError where the
    system cannot fork processes, such as Windows.
    """
    if not hasattr(os, "fork"):
        raise SceneError("system", os.name, "this figure needs one that forks processes: Linux or macOS")
    results: list = []
    context = get_context("fork")
    while len(results) < len(items):
        receiver, sender = context.Pipe(duplex=False)
        child = context.Process(target=_work, args=(sender, work, items[len(results) :]))
        child.start()
        sender.close()
        try:
            while len(results) < len(items) and receiver.poll(limit):
                results.append(receiver.recv())
        except EOFError:  # the child has ended
            pass
        if len(results) < len(items):
            results.append(None)
        child.kill()
        child.join()
    return results


def _work(sender: Connection, work: Callable, items: Sequence) -> None:
    for item in items:
        sender.send(work(item))
