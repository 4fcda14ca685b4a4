"""``{registry} NAME``: lens models, methods, formats, targets, scenes and faults, from their registries."""

from collections.abc import Callable

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from tables import code, table

from labcal.bench.faults.registry import FAULT_KINDS
from labcal.cameras.interop.held_lenses import held_lenses, holding_formats
from labcal.cameras.interop.registry import FORMATS
from labcal.cameras.lens import LENSES
from labcal.cameras.prescription import prescription_names
from labcal.correspond.interop.pixels.registry import PIXEL_FORMATS
from labcal.estimators.registry import method_entries
from labcal.scene.catalogue import load_scene, scene_names
from labcal.targets.catalogue import load_target, target_names


def _codes(names: object) -> str:
    """Return names as code, with commas."""
    return ", ".join(code(name) for name in names)


def lenses() -> str:
    """Return the lens models with their coefficients."""
    rows = [
        [
            code(name),
            " ".join(lens.names) or "none",
            "none" if lens.opencv is None else code(lens.opencv.function),
            "yes" if lens.central else "no",
            _codes(holding_formats(name)),
        ]
        for name, lens in LENSES.items()
    ]
    head = [
        "lens model",
        "coefficients",
        "function of OpenCV",
        "central",
        "formats that hold it",
    ]
    return table(head, rows) + f"\nShipped prescriptions: {_codes(prescription_names())}.\n"


def methods() -> str:
    """Return the methods, the one to begin with first."""
    rows = [[code(name), entry.summary, entry.needs] for name, entry in method_entries().items()]
    return table(["method", "description", "requirements"], rows)


def formats() -> str:
    """Return the formats of other systems with the lens models that they hold."""
    rows = [
        [
            code(name),
            _codes(one.suffixes),
            one.unit.value,
            _codes(held_lenses(one)),
            _codes(f"--{option}" for option in one.options),
        ]
        for name, one in FORMATS.items()
    ]
    return table(["format", "endings", "unit", "lens models", "options of `labcal convert`"], rows)


def pixel_formats() -> str:
    """Return the tables of other programs that hold named pixels."""
    rows = [
        [code(name), one.files, _codes(f"--{option}" for option in one.options)]
        for name, one in PIXEL_FORMATS.items()
    ]
    return table(["format", "files", "options of `labcal convert`"], rows)


def targets() -> str:
    """Return the shipped targets."""
    rows = []
    for name in target_names():
        target = load_target(name)
        rows.append([code(name), f"{target.cols} x {target.rows}", target.description])
    return table(["target", "columns x rows", "description"], rows)


def scenes() -> str:
    """Return the shipped scenes."""
    rows = []
    for name in scene_names():
        scene = load_scene(name)
        rows.append([code(name), code(scene.target.name), scene.placement.kind, scene.description])
    return table(["scene", "target", "placement", "description"], rows)


def faults() -> str:
    """Return the faults that `bench distortion` can make, with the meaning and the bounds of their sizes."""
    rows = [
        [code(name), kind.size, f"{kind.usual:g}", f"{kind.most:g}"]
        if kind.has_size
        else [code(name), "none", "", ""]
        for name, kind in FAULT_KINDS.items()
    ]
    return table(["fault", "size", "where left out", "at most"], rows)


TABLES: dict[str, Callable[[], str]] = {
    "lenses": lenses,
    "methods": methods,
    "formats": formats,
    "pixel-formats": pixel_formats,
    "targets": targets,
    "scenes": scenes,
    "faults": faults,
}


class RegistryTable(SphinxDirective):
    """A registry of labcal as a table."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Return the table."""
        name = self.arguments[0]
        if name not in TABLES:
            raise self.error(f"There is no registry '{name}': {', '.join(TABLES)}.")
        return self.parse_text_to_nodes(TABLES[name]())


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the directive."""
    app.add_directive("registry", RegistryTable)
    return {"parallel_read_safe": True}
