"""The networks of the study, and one training run of it."""

from dataclasses import dataclass, replace

from labcal.paper.rows import PaperRow, row_named
from labcal.paper.simulated import NoiseReading
from labcal.paper.training_run import TrainingOutcome, TrainingRun, run_training

NEURONS = (5, 10, 20, 30, 40, 60)
LAYERS = (1, 2, 3)
MAX_EPOCHS = 500
"""Accepted steps; the paper allows 5000, most of which a network that does not reach its goal would take."""
STUDIED_ROWS = ("01", "13", "03")
"""A plane, a volume, and a plane with noise: the study has their points, noise and goals."""


def topologies() -> tuple[tuple[int, ...], ...]:
    """Return the neurons of the hidden layers of every network: none, and all in one, two or three layers.

    Neurons are counted over all layers, so that networks of different depth can be compared: the paper's
    [20-30-3] and [50-3] have 50.
    """
    return ((), *(shared_equally(neurons, layers) for layers in LAYERS for neurons in NEURONS))


def shared_equally(neurons: int, layers: int) -> tuple[int, ...]:
    """Return neurons shared among layers, the first layers larger by one where they cannot be equal."""
    each, left = divmod(neurons, layers)
    return tuple(each + (layer < left) for layer in range(layers))


@dataclass(frozen=True)
class StudyRun:
    """The definition of one run: the data of a row of the paper, another network."""

    exp: str
    hidden: tuple[int, ...]
    seed: int
    max_epochs: int

    @property
    def row(self) -> PaperRow:
        """The row with this network."""
        return replace(row_named(self.exp), hidden=self.hidden)

    @property
    def key(self) -> str:
        """The name of the result file."""
        return "-".join(map(str, ("study", self.exp, *(self.hidden or ("none",)), "seed", self.seed)))


def study_runs(seeds: range, max_epochs: int) -> list[StudyRun]:
    """Return every run of the study.

    Networks of one seed see the same points and the same noise.

    Parameters
    ----------
    seeds : range
    max_epochs : int
        At most :data:`MAX_EPOCHS` are used.
    """
    return [
        StudyRun(exp, hidden, seed, min(max_epochs, MAX_EPOCHS))
        for exp in STUDIED_ROWS
        for hidden in topologies()
        for seed in seeds
    ]


def train_topology(case: StudyRun) -> TrainingOutcome:
    """Train and test one network."""
    noise = NoiseReading.SPREAD if case.row.noisy else NoiseReading.NONE
    return run_training(TrainingRun(case.row, "mlp", noise, "", None, case.seed, case.max_epochs))
