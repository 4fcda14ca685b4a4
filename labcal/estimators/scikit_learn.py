"""The parts of scikit-learn that methods are made of, imported without all of ``scipy.stats``.

scikit-learn imports ``scipy.stats`` at its start (half a second) for a function that no method of labcal
calls. The module is put in place beforehand as one whose code runs when an attribute of it is first asked
for; whoever uses it later gets the whole of it. (:class:`importlib.util.LazyLoader` would run it already at
``import scipy.stats``, since Python then asks for the module's ``__spec__``.)
"""

import importlib.util
import sys
from types import ModuleType


class _LateModule(ModuleType):
    """A module that is loaded when the first attribute is asked for that it does not have yet."""

    def __getattr__(self, name: str) -> object:
        self.__class__ = ModuleType  # type: ignore[assignment] # it is an ordinary module from now on
        spec = self.__spec__
        if spec is not None and spec.loader is not None:
            spec.loader.exec_module(self)
        return getattr(self, name)


def _import_when_used(name: str) -> None:
    """Put a module into `sys.modules` that loads itself when it is first used; one that is there stays."""
    spec = None if name in sys.modules else importlib.util.find_spec(name)
    if spec is None:
        return
    module = importlib.util.module_from_spec(spec)
    module.__class__ = _LateModule
    sys.modules[name] = module


_import_when_used("scipy.stats")

from sklearn.base import BaseEstimator, RegressorMixin, clone  # noqa: E402 -- after what it must not load
from sklearn.utils.validation import check_is_fitted, validate_data  # noqa: E402

__all__ = ["BaseEstimator", "RegressorMixin", "check_is_fitted", "clone", "validate_data"]
