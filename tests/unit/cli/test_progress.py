"""The bar of a command: what an earlier run has done, and the time that remains."""

import io

from rich.console import Console

from labcal.cli.progress import RichProgress


def test_what_an_earlier_run_has_done_is_shown_and_does_not_enter_the_remaining_time() -> None:
    with RichProgress(Console(file=io.StringIO())) as bar:
        bar.start("cases", 100, done=90)
        task = bar._bars.tasks[0]
        now = 1000.0
        bar._bars.get_time = lambda: now
        for step in range(4):
            now = 1000.0 + 60.0 * step
            bar.advance()
        assert task.completed == 94
        assert task.time_remaining is not None
        # Four steps that take a minute each, in which the first one began the measurement.
        assert 5 * 60 < task.time_remaining < 9 * 60
