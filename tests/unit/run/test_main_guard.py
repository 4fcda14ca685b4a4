import subprocess
import sys
from pathlib import Path

import pytest

UNGUARDED = """
from pathlib import Path
{imports}

print("at work")
{call}
"""
GUARDED = """
def main():
    from labcal.run.executor import open_executor
    with open_executor(2) as pool:
        print(list(pool.map(abs, [-1, -2, -3])))

if __name__ == "__main__":
    main()
"""
POOL = """
from labcal.run.executor import open_executor
with open_executor(2) as pool:
    print(list(pool.map(abs, [-1, -2, -3])))
"""


def run(*words: str, text: str | None = None) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *words]
    return subprocess.run(command, input=text, capture_output=True, text=True, check=False, timeout=120)


@pytest.mark.parametrize(
    ("imports", "call"),
    [
        ("from labcal.run.executor import open_executor", POOL),
        pytest.param(
            "from labcal.pipeline import RenderSettings, render",
            "render('webcam-plane', Path(__file__).with_name('shoot'), RenderSettings(workers=2))",
            marks=pytest.mark.slow,
        ),
        pytest.param(
            "from labcal.correspond.picture_set import PictureSet\n"
            "from labcal.correspond.sources import Source\n"
            "from labcal.targets.catalogue import load_target\n"
            "from labcal.pipeline import measure_pictures",
            "measure_pictures(PictureSet((Source('a', 'b', 'c.png', None),) * 3, None, 'c.png', ()), "
            "load_target('paper-13x10'), workers=2)",
            marks=pytest.mark.slow,
        ),
    ],
    ids=["pool", "render", "measure"],
)
def test_a_script_without_a_guard_is_told_what_to_write(tmp_path: Path, imports: str, call: str) -> None:
    script = tmp_path / "study.py"
    script.write_text(UNGUARDED.format(imports=imports, call=call))
    done = run(str(script))
    assert done.returncode == 1
    assert "InputError: The script study.py uses several workers" in done.stderr
    assert 'def main():\n    ...\n\nif __name__ == "__main__":\n    main()\n' in done.stderr
    assert done.stdout.count("at work") <= 3  # here, and once in each of two workers
    # Nothing of what the standard library says about it.
    assert "bootstrapping" not in done.stderr
    assert "BrokenProcessPool" not in done.stderr


def test_a_script_that_fails_in_its_workers_is_told_of_the_guard(tmp_path: Path) -> None:
    script = tmp_path / "study.py"
    script.write_text("from pathlib import Path\nPath(__file__).with_name('made').mkdir()\n" + POOL)
    done = run(str(script))
    assert "DeviceError: No worker process can be started" in done.stderr
    assert "with exit status 1" in done.stderr
    assert "keep its code under 'if __name__ == \"__main__\":'" in done.stderr


@pytest.mark.parametrize("way", ["script", "-c", "stdin", "deleted"])
def test_other_ways_to_run_python_work(tmp_path: Path, way: str) -> None:
    script = tmp_path / "study.py"
    script.write_text(GUARDED if way == "script" else "import os\nos.unlink(__file__)\n" + GUARDED)
    match way:
        case "-c":
            done = run("-c", POOL)
        case "stdin":
            done = run("-", text=POOL)
        case _:
            done = run(str(script))
    assert done.stderr == ""
    assert done.stdout == "[1, 2, 3]\n"
