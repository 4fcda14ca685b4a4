"""Dots of a shoot that are found once: the same as those of the finished shoot."""

from pathlib import Path

import pytest

from labcal import examples, pipeline
from labcal.correspond.measure import detections_of
from labcal.errors import InputError
from labcal.guide.diagnosis.finding import Finding
from labcal.live import shoot_dots
from labcal.live.diagnoser import Diagnoser
from labcal.live.shoot_dots import ShootDots


def test_dots_that_were_found_while_capturing_are_those_of_the_shoot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shoot = examples.shoot(tmp_path / "shoot")
    dots = ShootDots(tmp_path / "shoot", shoot.target)
    for view in shoot.views():
        assert set(dots.of_view(view.name)) == set(shoot.cameras)

    def never(*_: object) -> None:
        raise AssertionError("a picture is searched twice")

    measure = shoot_dots.measure_picture
    monkeypatch.setattr(shoot_dots, "measure_picture", never)
    _, found = dots.all()
    again = pipeline.measure_pictures(shoot)
    assert detections_of(found) == detections_of(again)
    assert [one.source for one in found] == [one.source for one in again]
    monkeypatch.setattr(shoot_dots, "measure_picture", measure)
    first = shoot.views()[0].name
    before = dots.of_view(first)
    dots.forget(first)
    assert dots.of_view(first)["left"] is not before["left"]
    assert dots.of_view("no-such-view") == {}


def test_a_shoot_that_is_not_there_yet_has_no_dots(tmp_path: Path) -> None:
    dots = ShootDots(tmp_path / "shoot", examples.shoot(tmp_path / "other").target)
    assert dots.of_view("view-001") == {}
    with pytest.raises(InputError):
        dots.all()


def test_few_views_are_not_accused(tmp_path: Path) -> None:
    shoot = examples.shoot(tmp_path / "shoot")
    reports: list[tuple[Finding, ...]] = []
    diagnoser = Diagnoser(ShootDots(tmp_path / "shoot", shoot.target), reports.append)
    diagnoser.start()
    diagnoser.look()
    diagnoser.stop()
    assert reports[0] == ()
