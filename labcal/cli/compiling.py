"""What is said where the first picture waits for the compiler."""

from labcal.cli.session import Session


def say_whether_compiling(session: Session) -> None:
    """Say that the first picture waits for the compiler, where it does."""
    from labcal.detect.compiled import is_kept
    from labcal.detect.edges.gauss_newton import fit_all

    if not is_kept(fit_all):
        session.say("The detector is compiled for this machine now, once: it takes about half a minute.")
