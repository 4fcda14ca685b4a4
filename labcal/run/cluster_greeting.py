"""The greeting of a scheduler: it speaks first, so that what only listens is no scheduler."""

import socket
import time
from urllib.parse import urlsplit

_PAUSE_S = 0.1


def wait_for_greeting(address: str, seconds: float) -> None:
    """Wait until a scheduler greets, which may be starting at the moment.

    Dask's own client waits for ever for something that accepts connections and is silent.

    Parameters
    ----------
    address : str
        ``tcp://HOST:PORT``. Of another kind (``tls://``) nothing is asked: there the client speaks first.
    seconds : float
        The longest time.

    Raises
    ------
    OSError
        Nobody greets.
    """
    parts = urlsplit(address)
    if parts.scheme != "tcp":
        return
    deadline = time.monotonic() + seconds
    while True:
        left = max(deadline - time.monotonic(), _PAUSE_S)
        try:
            with socket.create_connection((parts.hostname, parts.port or 0), timeout=left) as one:
                one.settimeout(left)
                if one.recv(1):
                    return
                raise ConnectionError("what listens there hangs up")
        except TimeoutError as error:
            raise TimeoutError(
                "what listens there is no scheduler, or the network drops the words"
            ) from error
        except OSError:
            if time.monotonic() + _PAUSE_S > deadline:
                raise
            time.sleep(_PAUSE_S)
