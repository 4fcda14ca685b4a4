"""Detection of scripts without ``if __name__ == "__main__":``, which each worker would execute again.

A worker process is started afresh and imports the script that started it. A script without the guard would
then start workers of its own from within each worker.
"""

import multiprocessing
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Lock

from labcal.errors import InputError

WORKER_NAME = "labcal-worker"
"""The name of every worker process: it has it before it imports the script."""
UNGUARDED_STATUS = 87
"""The exit status by which a worker reports to its parent that the script has no guard."""
_STARTING = Lock()


def _imports_script() -> bool:
    """Tell whether this is a process that was just started, and imports the script of its parent."""
    return getattr(multiprocessing.current_process(), "_inheriting", False)


def end_unguarded_worker() -> None:
    """End this process if it is a worker that executes its parent's script instead of a case.

    Call it where work begins that must not be done twice. The process ends silently: its parent reports.
    """
    if _imports_script() and multiprocessing.current_process().name == WORKER_NAME:
        os._exit(UNGUARDED_STATUS)


def refuse_unguarded() -> None:
    """Raise where processes may not be started, since the script of the parent is still being imported.

    Raises
    ------
    InputError
        The script lacks the guard.
    """
    end_unguarded_worker()
    if _imports_script():
        raise unguarded_script()


def unguarded_script() -> InputError:
    """Return the error that shows what the script should look like."""
    return InputError(
        f"{_script()} uses several workers outside of 'if __name__ == \"__main__\":'. Each worker is a "
        "process that imports the script, and would execute all of it again. Put the code of the script into "
        "a function, and call it like this:\n\n"
        "def main():\n"
        "    ...\n\n"
        'if __name__ == "__main__":\n'
        "    main()\n\n"
        "Or use one worker (workers=1), which needs no other process."
    )


def advice_on_script() -> str:
    """Return advice for workers that end before their first case; empty if they import no script."""
    path = getattr(sys.modules["__main__"], "__file__", None)
    if path is None or Path(path).name == "__main__.py":  # which the standard library leaves out
        return ""
    return (
        f"Workers import {path} again: keep its code under 'if __name__ == \"__main__\":', or use one worker."
    )


@contextmanager
def lost_script_left_out() -> Iterator[None]:
    """Start a process without the script if that is not a file that can be read again.

    Such is one from standard input (Python says that its file is ``<stdin>``), one from a pipe, or one that
    was deleted meanwhile. Cases are functions of the package and do not need it.
    """
    main = sys.modules["__main__"]
    with _STARTING:
        path = getattr(main, "__file__", None)
        if path is None or Path(path).is_file():
            yield
            return
        main.__file__ = None  # where a process that starts looks for it
        try:
            yield
        finally:
            main.__file__ = path


def _script() -> str:
    """Return the name of the script, for messages."""
    path = getattr(sys.modules["__main__"], "__file__", None)
    return "The program" if path is None else f"The script {Path(path).name}"
