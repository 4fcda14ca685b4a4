"""The interface of a least-squares problem to the Levenberg-Marquardt loop."""

from collections.abc import Sequence
from typing import Protocol, TypeVar, runtime_checkable

Parameters = TypeVar("Parameters")
"""Whatever a problem optimises: a tensor, an array, cameras and poses. The loop never looks inside."""

Produced_co = TypeVar("Produced_co", covariant=True)
"""The same, where a class only gives them out."""


@runtime_checkable  # so that tests can check annotations
class Linearization(Protocol[Produced_co]):
    """A problem's residuals r and their Jacobian J at one point, ready to be solved for steps."""

    @property
    def gradient_norm(self) -> float:
        """Return the largest absolute component of J'r, or another norm of it that the problem prefers."""

    def stepped(self, mu: float) -> Produced_co | None:
        """Return the parameters after the step that solves (J'J + mu I) step = -J'r, in the problem's units.

        How the system is solved is the problem's own affair: dense, or by elimination of views. None means
        that it was not numerically positive definite at this damping.
        """


@runtime_checkable
class Problem(Protocol[Parameters]):
    """A cost to be made small, and how to linearise it."""

    def cost(self, parameters: Parameters) -> float:
        """Return the cost, any increasing function of the sum of squared residuals."""

    def linearize(self, parameters: Parameters) -> Linearization[Parameters]:
        """Return residuals and Jacobian at `parameters`."""


@runtime_checkable
class BatchLinearization(Protocol[Produced_co]):
    """The linearisations of several runs, each at a point of its own."""

    @property
    def gradient_norms(self) -> Sequence[float]:
        """Return the largest absolute component of each run's J'r."""

    def stepped(self, places: Sequence[int], mus: Sequence[float]) -> Sequence[Produced_co | None]:
        """Return the parameters after a damped step of some runs, named by their places in here."""


@runtime_checkable
class Batch(Protocol[Parameters]):
    """Several runs of the same kind that are computed together.

    Members are the numbers of runs that are asked for, in the order in which parameters are given.
    """

    def costs(self, members: Sequence[int], parameters: Sequence[Parameters]) -> Sequence[float]:
        """Return the cost of each."""

    def linearize(
        self, members: Sequence[int], parameters: Sequence[Parameters]
    ) -> BatchLinearization[Parameters]:
        """Return their linearisations; those of an earlier call may be lost."""
