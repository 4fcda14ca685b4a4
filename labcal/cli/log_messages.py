"""Messages that the library logs while it works, as warnings of the command."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager

from labcal.cli.session import Session


class _Warnings(logging.Handler):
    """A receiver of the library's messages."""

    def __init__(self, session: Session) -> None:
        super().__init__(logging.WARNING)
        self._session = session

    def emit(self, record: logging.LogRecord) -> None:
        """Write a message as a warning."""
        self._session.warn(record.getMessage())


@contextmanager
def logged_as_warnings(session: Session) -> Iterator[None]:
    """Write what the library logs as warnings of a command."""
    logger, handler = logging.getLogger("labcal"), _Warnings(session)
    logger.addHandler(handler)
    try:
        yield
    finally:
        logger.removeHandler(handler)
