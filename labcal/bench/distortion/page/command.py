"""The command line that measures a plan again."""

import shlex

from labcal.bench.settings import BenchSettings
from labcal.paths import as_text


def command_line(settings: BenchSettings) -> str:
    """Return the command; how cases are spread, and what is replaced, does not belong to it.

    Parameters
    ----------
    settings : BenchSettings

    Examples
    --------
    >>> from labcal.pipeline import BenchSettings
    >>> command_line(BenchSettings(quick=True, overrides=("strengths=0,1",), seeds=2))
    'labcal bench distortion --quick --set strengths=0,1 --seeds 2 -o DIR'
    """
    words = ["labcal", "bench", "distortion"]
    if settings.quick:
        words.append("--quick")
    if settings.plan is not None:
        words += ["--plan", as_text(settings.plan)]
    for change in settings.overrides:
        words += ["--set", change]
    if settings.rendered:
        words.append("--rendered")
    if settings.detections:
        words += ["--detections", ",".join(map(as_text, settings.detections))]
    if settings.methods:
        words += ["--method", ",".join(settings.methods)]
    if settings.seeds is not None:
        words += ["--seeds", str(settings.seeds)]
    if settings.seed:
        words += ["--seed", str(settings.seed)]
    return shlex.join([*words, "-o", "DIR"])
