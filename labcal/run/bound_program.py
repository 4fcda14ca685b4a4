"""Programs that end together with the process that started them, where the system supports that."""

import os
import sys
from collections.abc import Sequence

_BIND = """
import ctypes, os, signal, sys
PR_SET_PDEATHSIG = 1
ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
if os.getppid() == int(sys.argv[1]):  # else it ended before the kernel was asked
    os.execv(sys.argv[2], sys.argv[2:])
"""


def bound_to_this_process(words: Sequence[str]) -> list[str]:
    """Return the command that runs a program so that it ends with this process, even if that is killed.

    On Linux the kernel is asked for it, by a process that then becomes the program. It looks at the thread
    that starts the program, so that thread should wait for it. Elsewhere the command is returned as it is.

    Parameters
    ----------
    words : sequence of str
        The path of the program, and its arguments.
    """
    if sys.platform != "linux":
        return [*words]
    return [sys.executable, "-I", "-S", "-c", _BIND, str(os.getpid()), *words]
