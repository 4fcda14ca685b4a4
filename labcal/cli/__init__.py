"""The command line: ``labcal VERB ...``, one file a verb.

How a verb is added
-------------------
1. Name it in :data:`VERBS` with one line of help.
2. Write ``labcal/cli/<verb>.py`` with two functions. At the top it imports only the standard library and
   ``labcal.cli``; what it works with is imported inside ``run``, so that ``labcal --help`` stays quick::

       def add_parser(commands: CommandGroup) -> None:
           parser = commands.add("detect", run, "Find dots in pictures.", example="labcal detect ...")
           parser.add_argument("shoot", type=Path, metavar="SHOOT")
           add_output(parser, "FILE", "detections.csv to write")  # -o and --force
           add_workers(parser)

       def run(arguments: Namespace, session: Session) -> ExitStatus:
           from labcal.pipeline import detect

           with session.progress() as progress:
               result = detect(arguments.shoot, progress)
           session.emit(result, "text or a rich table for people")
           return ExitStatus.DONE if result.refused == 0 else ExitStatus.PARTIAL

``commands.add`` gives every verb ``--json`` and ``--quiet``; other shared options are in
:mod:`labcal.cli.options`. A verb with commands of its own (``labcal target list``) begins with
``commands.add_group`` instead. ``session.emit`` is called once, with a pydantic model or a dataclass that is
the JSON document. Errors are raised, never printed: :mod:`labcal.cli.failure` turns them into a message and
an exit status.
"""

import sys
from collections.abc import Sequence
from importlib import import_module

from labcal import __version__
from labcal.cli.failure import report_failure
from labcal.cli.log_messages import logged_as_warnings
from labcal.cli.parser import CommandGroup, Parser, UsageError
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.cli.streams import result_stream
from labcal.cli.termination import orderly_termination

VERBS = {
    "doctor": "what works on this machine, and what to install for the rest",
    "target": "printable targets at exact scale",
    "scene": "what stands in the rendered laboratory",
    "lens": "the lens models, and which files hold them",
    "method": "the methods of 'fit', and what each needs",
    "format": "the files of other systems that 'convert' reads and writes",
    "render": "a shoot from the rendered laboratory",
    "capture": "a shoot from real cameras, replayed or simulated ones",
    "inspect": "a contact sheet of a shoot",
    "detect": "find the dots in pictures",
    "calibrate": "calibrate cameras from a hand-held target",
    "fit": "fit methods to views of a target",
    "reconstruct": "points in space from dots",
    "measure": "points in space from named pixels, in a frame of one's own",
    "evaluate": "errors of points in millimetres",
    "check": "whether a calibration is still valid, and what changed",
    "diagnose": "what is wrong with a shoot, and how to mend it",
    "certify": "an acceptance test by known lengths, with a certificate",
    "compare": "how two calibrations differ, in pixels and in millimetres",
    "twin": "a shoot rendered again with its calibrated rig: what simulation does not explain",
    "rehearse": "the errors to expect of a planned rig, before anything is bought",
    "convert": "cameras and detections from and to the files of other systems",
    "undistort": "pictures as ideal cameras would have taken them",
    "reproduce": "the paper: every row",
    "bench": "benchmarks, every figure against its limit",
    "report": "one page of a folder of results",
}
"""Every verb with its line in ``labcal --help``; the module of a verb has its name."""


def build_parser(verb: str | None) -> Parser:
    """Return the parser of the whole command line, with the arguments of `verb` alone filled in."""
    parser = Parser(
        prog="labcal",
        description="Measure in 3-D with two cameras and a target of dots, with a rendered lab built in.",
        epilog="example:\n  labcal doctor\n\n'labcal COMMAND --help' explains a command.",
    )
    parser.add_argument("--version", action="version", version=f"labcal {__version__}")
    commands = CommandGroup(parser)
    for name, summary in VERBS.items():
        if name == verb:
            import_module(f"labcal.cli.{name}").add_parser(commands)
        else:
            commands.name(name, summary)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    argv : sequence of str, optional
        The arguments after the program's name; those of the process where left out.

    Returns
    -------
    int
        0 done; 1 done in part; 2 wrong use, or nothing usable given; 3 a device or the program itself
        failed; 130 interrupted; 141 nobody reads the output any more; 143 terminated.
    """
    words = list(sys.argv[1:] if argv is None else argv)
    # Known before the arguments are understood, since wrong ones are reported in JSON, too.
    json, quiet = "--json" in words, "--quiet" in words
    try:
        if not words:
            build_parser(None).print_help(sys.stderr)
            return ExitStatus.UNUSABLE
        arguments = build_parser(words[0]).parse_args(words)
    except SystemExit as stop:  # argparse, after --help and --version
        return stop.code if isinstance(stop.code, int) else ExitStatus.DONE
    except UsageError as error:
        return report_failure(error, Session(sys.stdout, json=json, quiet=quiet))
    with orderly_termination(), result_stream() as stream:
        session = Session(stream, json=json, quiet=quiet, words=words)
        try:
            with logged_as_warnings(session):
                return int(arguments.run(arguments, session))
        except BrokenPipeError:
            return ExitStatus.NOBODY_READS
        except (Exception, KeyboardInterrupt) as error:  # noqa: BLE001 - the one place where every error ends
            return report_failure(error, session)
