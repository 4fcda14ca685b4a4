"""All files that a piece of work reads, so that none of them is replaced by what it writes."""

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from labcal.cameras.interop.registry import READ
from labcal.correspond.sources import Source, shoot_sources
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.shoot.dataset import MANIFEST, is_shoot, open_shoot
from labcal.shoot.pictures import SUFFIXES


def paths_read(given: Iterable[AnyPath | list[str] | None], sources: Iterable[Source] = ()) -> list[Path]:
    """Return what is read, for :func:`~labcal.run.claims.claim_outputs`.

    Parameters
    ----------
    given : iterable of path, list of path, or None
        What was given; names among them that are no paths do no harm. Of a folder everything that
        belongs to a shoot, or might be read as a picture or as cameras, counts as read.
    sources : iterable of Source
        Pictures.
    """
    endings = SUFFIXES | {suffix for one in READ.values() for suffix in one.suffixes}
    paths = [Path(source.image) for source in sources]
    every = [name for one in given for name in (one if isinstance(one, list) else [one])]
    for path in (as_path(one) for one in every if one):
        paths.append(path)
        if is_shoot(path):
            paths += [path / MANIFEST, path / "run.json", *path.glob("truth/*")]
            with suppress(InputError):  # the work itself will say what is wrong with the shoot
                paths += [Path(source.image) for source in shoot_sources(open_shoot(path))]
        elif path.is_dir():
            paths += [entry for entry in path.iterdir() if entry.suffix.lower() in endings]
    return paths
