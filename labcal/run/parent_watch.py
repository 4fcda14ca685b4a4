"""A watch on the parent process, which ends this process with it."""

import multiprocessing
import os
import threading


def end_with_parent() -> None:
    """End this process as soon as its parent has ended, even if that was killed.

    A thread waits for it. No thread of labcal holds the interpreter's lock for longer
    than half a second (the renderer and the detector's compiler were measured). The kernel's own way on
    Linux (``PR_SET_PDEATHSIG``) looks at the thread that started the process and not at its process.
    """
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, name="parent-watch", daemon=True).start()
