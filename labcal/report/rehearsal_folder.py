"""The folder of a rehearsal: document, map, poses, planned cameras and page."""

from pathlib import Path

from labcal.cameras.rig_file import write_rig
from labcal.guide.rehearsal.held_scene import held_scene
from labcal.guide.rehearsal.rehearsal import Rehearsal
from labcal.report.page.document import INNER_PAGE_KIND
from labcal.report.page_maker import PageMaker
from labcal.report.rehearsal_page import rehearsal_page
from labcal.report.rehearsal_result import rehearse_result
from labcal.report.rehearsal_tables import map_table, poses_table
from labcal.run.json_text import to_json
from labcal.run.outputs import write_file

DOCUMENT, PAGE, RIG, SCENE = "rehearsal.json", "index.html", "rig.json", "scene.yaml"


def write_rehearsal(folder: Path, found: Rehearsal, maker: PageMaker) -> None:
    """Write all files of a rehearsal.

    Parameters
    ----------
    folder : Path
    found : Rehearsal
    maker : PageMaker
    """
    write_file(folder / DOCUMENT, to_json(rehearse_result(".", found)), force=True)
    for table in (map_table(found), poses_table(found)):
        write_file(folder / table.file, table.text, force=True)
    write_rig(folder / RIG, found.rig, force=True)
    write_file(folder / SCENE, held_scene(found).to_yaml(), force=True)
    page = rehearsal_page(found, maker).text()
    write_file(folder / PAGE, page, kind=INNER_PAGE_KIND, force=True)
