"""Measure in 3-D with two cameras and a target of dots.

The chain from a scene, or a photograph, to errors in millimetres is in :mod:`labcal.pipeline`. The names
that ``__init__.pyi`` lists are what it takes and returns; each is imported when it is first used, so that
importing the package imports nothing heavy.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
