"""Addresses of schedulers of a Dask cluster."""

import re

from labcal.errors import InputError

LOCAL = "local"
"""In place of an address: a cluster of processes of this machine."""

_ADDRESS = re.compile(r"(tcp|tls)://(\[[0-9A-Fa-f:.]+\]|[^\s/:\[\]@]+):([0-9]{1,5})")
_MOST_PORT = 65535


def require_address(text: str) -> str:
    """Return the address of a scheduler as it was given.

    Raises
    ------
    InputError
        It is none.
    """
    found = _ADDRESS.fullmatch(text)
    if found is not None and 0 < int(found[3]) <= _MOST_PORT:
        return text
    host = re.fullmatch(r"(?:[a-z+]+:/*)?([\w.-]+)(?::([0-9]{1,5}))?/?", text)
    hint = f" Did you mean 'tcp://{host[1]}:{host[2] or 8786}'?" if host is not None else ""
    raise InputError(
        f"'{text}' is no address of a Dask scheduler.{hint} It is 'local', for a cluster of processes of "
        "this machine, or tcp://HOST:PORT (tls://HOST:PORT where the scheduler asks for it)."
    )
