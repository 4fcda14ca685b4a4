"""Measure in 3-D with two cameras and a target of dots.

:mod:`labcal.pipeline` has a function for each step from a scene, or from photographs, to errors in
millimetres. ``dir(labcal)`` lists what these functions take and return. Each name is imported when it is
first used, so that importing the package imports nothing heavy.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
