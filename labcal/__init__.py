"""Measure in 3-D with two cameras and a target of dots.

Importing the package imports nothing heavy. :mod:`labcal.pipeline` holds the chain from a scene, or a
photograph, to errors in millimetres.
"""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("labcal")
except PackageNotFoundError:  # run from a source tree that is not installed
    __version__ = "0+source"

__all__ = ["__version__"]
