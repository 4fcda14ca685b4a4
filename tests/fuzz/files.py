"""``PYTHONPATH=tests python -m fuzz.files --count 3000``: mutants of files, and what came of them.

Each is refused by an error of labcal's own, or read to what an independent reader finds in it.
"""

import argparse
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path

from fuzz.faithful import readings
from fuzz.faithful_documents import DOCUMENTS
from fuzz.faithful_tables import TABLES, table_readings
from fuzz.stated_cameras import READERS
from fuzz.stated_forms import FORMS
from fuzz.stated_robots import ROBOTS

_SHOWN = 10


def main() -> int:
    """Run a campaign and print its faults."""
    parser = argparse.ArgumentParser(prog="fuzz.files", description=__doc__)
    parser.add_argument("names", nargs="*", help="formats of cameras, and kinds of tables; all if left out")
    parser.add_argument("--count", type=int, default=300, help="mutants of each")
    parser.add_argument(
        "--seed", type=int, default=int(time.strftime("%Y%m%d")), help="today's date if left out"
    )
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    every = {**TABLES, **DOCUMENTS}
    cameras = [*READERS, *ROBOTS, *FORMS]
    faults = 0
    for name in arguments.names or [*cameras, *every]:
        counts: Counter[str] = Counter()
        started = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            how = Path(folder), arguments.seed, arguments.count
            for one in readings(name, *how) if name in cameras else table_readings(every[name], *how):
                counts["refused" if one.refused else "read"] += 1
                counts["faults"] += bool(one.faults)
                if one.faults and counts["faults"] <= _SHOWN:
                    print(
                        f"{name} {one.number} {one.file}: {'; '.join(one.faults)}\n{one.mutant!r}", flush=True
                    )
        faults += counts["faults"]
        told = ", ".join(f"{count} {what}" for what, count in sorted(counts.items()))
        print(f"{name}, seed {arguments.seed}, {time.monotonic() - started:.0f} s: {told}", flush=True)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
