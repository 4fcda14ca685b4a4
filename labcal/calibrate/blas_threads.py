"""One thread for NumPy's and SciPy's linear algebra, whose matrices here are too small for more."""

from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import threadpool_limits


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Let BLAS compute with one thread inside, and with as many as before afterwards.

    Measured on two cores that others used, too: factoring 200 x 200 takes ten times as long with two threads
    as with one. The number of threads also decides on the last digits.
    """
    with threadpool_limits(limits=1, user_api="blas"):
        yield
