"""The damping of a step, and its change after success and failure."""

from dataclasses import dataclass

from labcal.errors import InputError


@dataclass(frozen=True)
class Damping:
    """Damping that falls by a factor after a step that helps and rises by one after a step that does not.

    The defaults are those of MATLAB's ``trainlm`` (Hagan and Menhaj 1994), which the paper uses.

    Attributes
    ----------
    start : float
        Damping mu of the first step.
    decrease, increase : float
        Factors after a step that helps, and after one that does not.
    ceiling : float
        Above this damping the optimisation gives up.

    Raises
    ------
    InputError
        A factor or a bound that would never end, or never damp.
    """

    start: float = 1e-3
    decrease: float = 0.1
    increase: float = 10.0
    ceiling: float = 1e10

    def __post_init__(self) -> None:
        """Refuse factors and bounds that are out of range."""
        if not (0 < self.start <= self.ceiling and 0 < self.decrease <= 1 < self.increase):
            raise InputError(
                "Damping needs 0 < start <= ceiling and 0 < decrease <= 1 < increase, but got "
                f"start {self.start:g}, ceiling {self.ceiling:g}, decrease {self.decrease:g}, "
                f"increase {self.increase:g}."
            )

    def after_success(self, mu: float) -> float:
        """Return the damping of the next step when this one has lowered the cost."""
        # Without a floor a long run would underflow to 0, from which no factor leads back.
        return max(mu * self.decrease, 1e-300)

    def after_failure(self, mu: float) -> float:
        """Return the damping to try when this step has not lowered the cost."""
        return mu * self.increase
