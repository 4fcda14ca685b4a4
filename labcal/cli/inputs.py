"""What several commands are given: a shoot or its detections, and the target that it shows."""

from argparse import Namespace
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.options import refuse_option
from labcal.cli.session import Session

if TYPE_CHECKING:
    from labcal.correspond.detections import Detections
    from labcal.correspond.sources import Source
    from labcal.shoot.dataset import Shoot
    from labcal.targets.catalogue import AnyTarget


def read_or_detect(source: str, target: "AnyTarget | None", workers: int, session: Session) -> "Detections":
    """Return the dots in a table, or find them in the pictures of a shoot.

    A shoot brings its own target where none is given. Pictures without ids are told as warnings.
    """
    from labcal.correspond.detections import read_detections
    from labcal.correspond.measure import detections_of, refusals
    from labcal.correspond.refused_pictures import shared_reasons
    from labcal.correspond.sources import shoot_sources
    from labcal.pipeline import measure
    from labcal.shoot.dataset import open_shoot

    require_shoot_or_table(source)
    if Path(source).is_file():
        return read_detections(Path(source))
    shoot = open_shoot(Path(source))
    say_whether_compiling(session)
    with session.progress() as progress:
        measurements = measure(shoot_sources(shoot), target or shoot.target, workers, progress)
    found = detections_of(measurements)
    for shared in shared_reasons(refusals(measurements)):
        session.warn(shared.words)
    return found


def shoot_or_none(source: str) -> "Shoot | None":
    """Return the shoot that a source is; None where it is a table."""
    from labcal.shoot.dataset import is_shoot, open_shoot

    require_shoot_or_table(source)
    return open_shoot(Path(source)) if is_shoot(Path(source)) else None


def dots_of(arguments: Namespace, target: "AnyTarget", session: Session) -> "Detections":
    """Return the dots of the source that is named, or of its shoot those in ``--detections``.

    Raises
    ------
    InputError
        ``--detections`` does not go with the source.
    """
    from labcal.correspond.detections import read_detections
    from labcal.errors import InputError

    if arguments.detections is None:
        return read_or_detect(arguments.source, target, arguments.workers, session)
    if shoot_or_none(arguments.source) is None:
        raise InputError("--detections goes with the folder of a shoot. Give the table alone.")
    return read_detections(arguments.detections)


def say_roles(detections: "Detections", verb: str, session: Session) -> None:
    """Say where a table is of a shoot that has views to test on, since all views in the table enter."""
    from labcal.errors import InputError
    from labcal.shoot.dataset import is_shoot, open_shoot
    from labcal.shoot.manifest import Role
    from labcal.wording import listed

    home = Path(str(detections.image[0])).parent.parent if len(detections) else Path()
    if not is_shoot(home):
        return
    try:
        tested = [view.name for view in open_shoot(home).views(Role.TEST) if view.name in detections.views]
    except InputError:  # nothing is wanted of that shoot
        return
    if tested:
        session.warn(
            f"the views {listed(tested)} enter, which the shoot {home} keeps to test on. To leave them "
            f"out: labcal {verb} {home} --detections TABLE"
        )


def require_shoot_or_table(source: str) -> None:
    """Raise unless there is a shoot or a file.

    Raises
    ------
    InputError
        There is not.
    """
    from labcal.errors import InputError
    from labcal.shoot.dataset import is_shoot

    if not Path(source).is_file() and not is_shoot(Path(source)):
        there = "is not a shoot" if Path(source).exists() else "does not exist"
        raise InputError(
            f"{source} {there}. Give a shoot's folder, or the table that 'labcal detect' writes of pictures."
        )


def paths_read(given: "Iterable[str | Path | None]", sources: "Iterable[Source]" = ()) -> list[Path]:
    """Return what a command reads, for :func:`~labcal.run.claims.claim_outputs`.

    Parameters
    ----------
    given : iterable of str, Path or None
        Words of the command line; names among them that are no paths do no harm. Of a folder everything that
        belongs to a shoot, or might be read as a picture or as cameras, counts as read.
    sources : iterable of Source
        Pictures.
    """
    from labcal.cameras.interop.registry import FORMATS
    from labcal.correspond.sources import shoot_sources
    from labcal.errors import InputError
    from labcal.shoot.dataset import MANIFEST, is_shoot, open_shoot
    from labcal.shoot.pictures import SUFFIXES

    endings = SUFFIXES | {suffix for one in FORMATS.values() for suffix in one.suffixes}
    paths = [Path(source.image) for source in sources]
    for path in (Path(one) for one in given if one):
        paths.append(path)
        if is_shoot(path):
            paths += [path / MANIFEST, path / "run.json", *path.glob("truth/*")]
            with suppress(InputError):  # the command itself will say what is wrong with the shoot
                paths += [Path(source.image) for source in shoot_sources(open_shoot(path))]
        elif path.is_dir():
            paths += [entry for entry in path.iterdir() if entry.suffix.lower() in endings]
    return paths


def say_whether_compiling(session: Session) -> None:
    """Say that the first picture waits for the compiler, where it does."""
    from labcal.detect.compiled import is_kept
    from labcal.detect.edges.gauss_newton import fit_all

    if not is_kept(fit_all):
        session.say("The detector is compiled for this machine now, once: it takes about half a minute.")


def pictures_and_target(arguments: Namespace, session: Session) -> "tuple[list[Source], AnyTarget]":
    """Return the pictures that a command is given, and the target that they show.

    Raises
    ------
    InputError
        There are no such pictures, or no target is named and they are no shoot.
    UnknownNameError
        There is no target of that name.
    """
    return pictures_given(arguments, session), choose_target(arguments.target, arguments.pictures)


def pictures_given(arguments: Namespace, session: Session) -> "list[Source]":
    """Return the pictures that a command is given; those in folders that are left out are told as warnings.

    Raises
    ------
    InputError
        There are none, or their names do not tell which camera took them.
    """
    from labcal.correspond.pictures_left_out import left_out_words
    from labcal.correspond.sources import find_sources, parse_camera_endings
    from labcal.shoot.dataset import is_shoot

    refuse_endings_of_shoot(arguments)
    endings = parse_camera_endings(arguments.cameras) if arguments.cameras else {}
    if not (len(arguments.pictures) == 1 and is_shoot(Path(arguments.pictures[0]))):
        for told in left_out_words(arguments.pictures):
            session.warn(told)
    return find_sources(arguments.pictures, endings)


def refuse_endings_of_shoot(arguments: Namespace) -> None:
    """Raise where ``--cameras`` is given for a shoot.

    Raises
    ------
    InputError
        It is.
    """
    from labcal.shoot.dataset import is_shoot

    if len(arguments.pictures) == 1 and is_shoot(Path(arguments.pictures[0])):
        refuse_option(arguments, "cameras", "is for loose pictures; a shoot says which camera took which")


def refuse_idle_workers(arguments: Namespace) -> None:
    """Raise where ``--workers`` is given and no dots are to be found.

    Raises
    ------
    InputError
        It is.
    """
    if Path(arguments.source).is_file() or getattr(arguments, "detections", None) is not None:
        refuse_option(arguments, "workers", "is for finding dots in pictures; a table holds them")


def choose_target(name: str | None, pictures: Sequence[str]) -> "AnyTarget":
    """Return the target named, or that of the shoot.

    Raises
    ------
    UnknownNameError
        There is no target of that name.
    InputError
        No target is named, and the pictures are no shoot.
    """
    from labcal.errors import InputError
    from labcal.shoot.dataset import is_shoot, open_shoot
    from labcal.targets.catalogue import load_target

    if name is not None:
        return load_target(name)
    if len(pictures) == 1 and is_shoot(Path(pictures[0])):
        return open_shoot(Path(pictures[0])).target
    raise InputError(
        "Say which target the pictures show: --target NAME ('labcal target list' shows the names)."
    )
