"""A process that does not outlive its parent, whatever ends that."""

import multiprocessing
import os
import threading


def end_with_parent() -> None:
    """End this process at once when the one that started it has ended, even if that was killed.

    A thread waits for it. No thread of ours works without the interpreter's lock being let go for longer
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
