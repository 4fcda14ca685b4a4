"""A message if the first picture waits for the compiler."""

from labcal.cli.session import Session


def announce_compiling(session: Session) -> None:
    """Announce that the first picture waits for the compiler, if it does."""
    from labcal.detect.compiled import is_kept
    from labcal.detect.edges.gauss_newton import fit_all

    if not is_kept(fit_all):
        session.say("The detector is compiled for this machine now, once: it takes about half a minute.")
