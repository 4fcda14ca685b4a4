"""``PYTHONPATH=tests python -m fuzz 10000 --seed 1``: mutants, and what came of them."""

import argparse
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from fuzz.campaign import run
from fuzz.seeds import make_seeds


def main() -> int:
    """Run a campaign and print its faults."""
    parser = argparse.ArgumentParser(prog="fuzz", description=__doc__)
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first mutant")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        seeds = make_seeds(Path(folder) / "seeds")
        started = time.monotonic()
        counts: Counter[str] = Counter()
        slowest = largest = 0.0
        for outcome in run(seeds, Path(folder) / "home", arguments.seed, arguments.count, arguments.first):
            counts[f"status {outcome.status}"] += 1
            slowest, largest = max(slowest, outcome.seconds), max(largest, outcome.peak_bytes / 2**20)
            if (outcome.number - arguments.first) % 1000 == 999:
                print(f"{outcome.number + 1} in {time.monotonic() - started:.0f} s", flush=True)
            if outcome.faults:
                counts["faults"] += 1
                print(
                    f"{outcome.number} {outcome.job} [{outcome.what}]: {'; '.join(outcome.faults)}",
                    flush=True,
                )
        told = ", ".join(f"{count} {what}" for what, count in sorted(counts.items()))
        seconds = time.monotonic() - started
        print(f"{arguments.count} mutants of seed {arguments.seed} in {seconds:.0f} s: {told}; slowest "
              f"{slowest:.2f} s, largest {largest:.0f} MiB")  # fmt: skip
    return 1 if counts["faults"] else 0


if __name__ == "__main__":
    sys.exit(main())
