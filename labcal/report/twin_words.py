"""Words of ``labcal twin`` for people."""

from labcal.report.twin_result import TwinResult
from labcal.wording import counted


def twin_words(result: TwinResult) -> str:
    """Return the result for people."""
    lines = [twin_summary(result)]
    if printed := print_words(result):
        lines.append(printed)
    if result.unexplained:
        lines.append("Not explained, what matters most first:")
        lines += [f"- {share_words(one.share)}{one.words}" for one in result.unexplained]
    else:
        lines.append("Nothing beyond noise is found: simulation explains these pictures.")
    quiet = sum(one.at_noise for one in result.pictures)
    lines.append(f"{quiet} of {counted(len(result.pictures), 'picture')} at noise level.")
    return "\n".join(lines)


def twin_summary(result: TwinResult) -> str:
    """Return the outcome in a sentence."""
    return (
        f"The simulation explains {100.0 * result.explained:.0f}% of the squared residuals of "
        f"{counted(result.dots, 'dot')}: {result.rms_px:.3g} px RMS between photographs and renderings; "
        f"noise alone makes {result.noise_px:.3g} px."
    )


def print_words(result: TwinResult) -> str:
    """Return what of the print is in the simulation; nothing where it is as declared."""
    words = []
    if result.print_measured:
        words.append(
            f"The print is rendered as the calibration measured it: dots are {result.print_rms_um:.2g} um "
            "RMS from their declared places."
        )
    if result.declared is not None:
        causes = "; ".join(f"{share_words(one.share)}{one.words}" for one in result.declared.unexplained)
        words.append(
            f"A simulation of the print as declared would leave {result.declared.rms_px:.3g} px RMS, and not "
            f"explain {causes or 'nothing'}."
        )
    if abs(result.dot_growth_um) >= 1.0:
        larger = "larger" if result.dot_growth_um > 0 else "smaller"
        words.append(f"Radii of dots are {abs(result.dot_growth_um):.2g} um {larger} than declared.")
    return " ".join(words)


def share_words(share: float | None) -> str:
    """Return a share as the beginning of a line; nothing of what moves no dots."""
    return "" if share is None else f"{100.0 * share:.0f}%: "
