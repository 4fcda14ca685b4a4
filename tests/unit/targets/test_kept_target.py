"""The target that a calibration keeps in its rig."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from labcal import InputError, Rig, examples, load_target, pipeline
from labcal.calibrate.calibration import Calibration
from labcal.cameras.target_record import TargetRecord
from labcal.targets.kept_target import kept_target, other_target_note, target_record


@pytest.fixture(scope="module")
def made() -> Calibration:
    """Return a calibration with the target of the examples."""
    return pipeline.calibrate(examples.TARGET, examples.detections())


def without_target(rig: Rig) -> Rig:
    """Return the rig as an older version would have written it."""
    return rig.model_copy(update={"target": None})


def test_the_whole_description_stands_in_the_file(made: Calibration, tmp_path: Path) -> None:
    """It is read as it was written, and is the target itself."""
    made.save(tmp_path / "rig.json")
    rig = Rig.load(tmp_path / "rig.json")
    assert rig == made.rig
    assert kept_target(rig) == load_target(examples.TARGET)


def test_an_older_file_states_none_and_goes_on_as_before(made: Calibration, tmp_path: Path) -> None:
    """The key is left out, and the points are those of centroids, with a warning."""
    without_target(made.rig).save(tmp_path / "rig.json")
    assert '"target"' not in (tmp_path / "rig.json").read_text()
    found = pipeline.reconstruct(tmp_path / "rig.json", examples.detections())
    assert found.eccentricity is None
    assert "`target='NAME'`" in found.warnings[0]


def test_points_are_those_of_the_named_target(made: Calibration) -> None:
    """Eccentricity is corrected without a name, to the same bytes as with it."""
    kept = pipeline.reconstruct(made.rig, examples.detections())
    named = pipeline.reconstruct(without_target(made.rig), examples.detections(), examples.TARGET)
    assert kept.eccentricity is not None
    assert kept.warnings == named.warnings == ()
    assert kept.points.point.tobytes() == named.points.point.tobytes()
    assert kept.points.covariance.tobytes() == named.points.covariance.tobytes()


def test_a_named_target_wins_and_the_difference_is_said(made: Calibration) -> None:
    """Another pitch is named by its key; a different text for people is no difference."""
    target = load_target(examples.TARGET)
    other = target.model_copy(update={"name": "mine", "dot_diameter_mm": 8.0})
    found = pipeline.reconstruct(made.rig, examples.detections(), other)
    assert any("they differ in dot_diameter_mm" in words for words in found.warnings)
    renamed = target.model_copy(update={"name": "mine", "description": "on glass"})
    assert other_target_note(made.rig, renamed) is None
    assert other_target_note(without_target(made.rig), other) is None


def test_the_shoot_comes_before_the_rig(made: Calibration, tmp_path: Path) -> None:
    """Its target is taken, and the contradiction is said; a shoot without one takes that of the rig."""
    shoot = examples.shoot(tmp_path / "shoot")
    target = load_target(examples.TARGET)
    smaller = made.rig.model_copy(
        update={"target": target_record(target.model_copy(update={"dot_diameter_mm": 2.0}))}
    )
    plain = pipeline.reconstruct(made.rig, shoot)
    contradicted = pipeline.reconstruct(smaller, shoot)
    assert any("dot_diameter_mm" in words for words in contradicted.warnings)
    assert contradicted.points == plain.points
    manifest = shoot.manifest.model_copy(update={"target": None})
    assert pipeline.reconstruct(made.rig, replace(shoot, manifest=manifest)).points == plain.points


def test_lengths_are_those_of_the_kept_target(made: Calibration) -> None:
    """`evaluate` takes the target of the rig where nothing else is named, and refuses a rig without one."""
    points = pipeline.reconstruct(made.rig, examples.detections()).points
    kept = pipeline.evaluate(points, rig=made.rig)
    assert kept == pipeline.evaluate(points, examples.TARGET, rig=made.rig)
    with pytest.raises(InputError, match="not known what the points are of"):
        pipeline.evaluate(points, rig=without_target(made.rig))


def test_check_and_frames_take_it(made: Calibration, tmp_path: Path) -> None:
    """New pictures are of the rig's target, and so is a board that lies in the frame."""
    dots = examples.detections()
    kept = pipeline.check(made.rig, dots)
    assert kept.p_value == pipeline.check(made.rig, dots, examples.TARGET).p_value
    board = dots.where(dots.view == dots.views[0])
    board.save(tmp_path / "board.csv")
    frame = pipeline.MeasureSettings(frame=f"board:{tmp_path / 'board.csv'}")
    found = pipeline.measure(made.rig, examples.pixels(), settings=frame)
    named = pipeline.measure(made.rig, examples.pixels(), examples.TARGET, frame)
    assert np.array_equal(found.points.point, named.points.point, equal_nan=True)


def test_a_damaged_description_is_refused_where_it_is_needed(made: Calibration) -> None:
    """A named target is taken without a look at it."""
    damaged = made.rig.model_copy(update={"target": TargetRecord({"name": "x", "kind": "stones"})})
    with pytest.raises(InputError, match="stones"):
        pipeline.reconstruct(damaged, examples.detections())
    assert pipeline.reconstruct(damaged, examples.detections(), examples.TARGET).points.ok.all()
