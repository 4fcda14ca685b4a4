"""Properties that targets share whose places are corners of black squares."""

from labcal.targets.scaled_print import ScaledPrint


class CornerBoard(ScaledPrint):
    """A black print whose places are corners."""

    @property
    def least_margin_mm(self) -> float:
        """0: nothing reaches beyond what is printed."""
        return 0.0

    @property
    def place_name(self) -> str:
        """A corner."""
        return "corner"

    @property
    def is_white_on_black(self) -> bool:
        """False: its squares are printed black."""
        return False
