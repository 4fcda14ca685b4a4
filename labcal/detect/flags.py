"""Flags of dots, and the reasons why a picture is refused, each with its advice."""

from enum import StrEnum


class DotFlag(StrEnum):
    """Flag of one dot; only ``ok`` dots are measurements of the declared grid."""

    OK = "ok"
    """Measured, with an id within the declared grid."""
    BEYOND_GRID = "beyond-grid"
    """Measured, with an id, but printed beyond the declared grid."""
    CUT = "cut"
    """Cut by the frame: its centre of area is not in the picture, so it is not measured."""
    HIDDEN = "hidden"
    """Its place is in the picture, but there is no whole dot to be seen there: not measured."""
    SATURATED = "saturated"
    """Part of the board around it, or of the dot, is burnt out or black, which moves its edge."""
    BLURRED = "blurred"
    """Its edge is as wide as the dot: not measured."""
    BAD_FIT = "bad-fit"
    """In its place, but its outline is no clean ellipse (hidden in part, smeared): not measured."""
    NO_ID = "no-id"
    """Looks like a dot but has no certain place in the grid."""


NOT_MEASURABLE = (DotFlag.SATURATED, DotFlag.BLURRED, DotFlag.BAD_FIT)
"""Flags of dots that are whole in the picture, but cannot be measured."""


class Refusal(StrEnum):
    """Reason why a whole picture has no ids, or is not measured."""

    NO_DOTS = "no-dots"
    """Nothing in the picture looks like a dot."""
    SATURATED = "saturated"
    """Half of the picture is burnt out or black, and there is no grid in the rest."""
    BLURRED = "blurred"
    """There are spots or codes, but their edges are as wide as they are."""
    TOO_SMALL = "too-small"
    """The target is seen, but its dots, squares or codes are too small in the picture to be measured."""
    TOO_FEW_DOTS = "too-few-dots"
    """Fewer dots, or corners, are in the frame than a grid needs."""
    NO_GRID = "no-grid"
    """There are dots, but they form no grid."""
    NO_RINGS = "no-rings"
    """There is a grid, but not the three rings in it at the target's steps."""
    AMBIGUOUS_RINGS = "ambiguous-rings"
    """The rings fit the target at more than one place."""
    AMBIGUOUS = "ambiguous"
    """The dots are all alike, and the grid fits the target at more than one place, or not exactly."""
    SEVERAL_TARGETS = "several-targets"
    """A plain grid or a chessboard is seen whole, and more than once."""
    NO_MARKERS = "no-markers"
    """No marker of the target's dictionary is seen."""
    NO_CODED_DOTS = "no-coded-dots"
    """No coded dot of the target is read."""
    MARKERS_UNREADABLE = "markers-unreadable"
    """A marker or more are read, but not the two or more that place the board."""
    AMBIGUOUS_MARKERS = "ambiguous-markers"
    """The same markers are read at two places, where the target has them each time."""
    OTHER_IDS = "other-ids"
    """Markers or coded dots are read, but most have ids that the target has not."""
    TORN_CORNERS = "torn-corners"
    """The board is found, but too few of its corners can be measured."""
    OTHER_BOARD = "other-board"
    """Markers or coded dots are read, but not where the target has them."""
    CORNER_SQUARES = "corner-squares"
    """Tags of an AprilGrid are in place; small squares at their corners are not as the target has them."""
    BORDER_CELLS = "border-cells"
    """Tags of an AprilGrid are in place, but with another black border than the target has."""
    NO_CHESSBOARD = "no-chessboard"
    """No corners of squares are seen, or they form no board."""
    BOARD_IN_PART = "board-in-part"
    """A part of a chessboard is seen, and no marks that number it."""
    OTHER_CHESSBOARD = "other-chessboard"
    """A chessboard is seen, but with more corners than the target, other colours or other marks."""
    MIRRORED = "mirrored"
    """The target is seen as in a mirror."""
    NO_USABLE_DOTS = "no-usable-dots"
    """The grid is found, but hardly any of its dots can be measured; ids and flags state what each one is."""
    GRID_INCONSISTENT = "grid-inconsistent"
    """The dots do not lie on one smooth grid, so their ids cannot be trusted."""


_ADVICE = {
    Refusal.NO_DOTS: (
        "No dots were found. Check that the target is in the picture, in focus and neither black nor "
        "burnt out; a dot should be at least 6 px across."
    ),
    Refusal.SATURATED: (
        "Half of the picture is burnt out or black, and the rest shows no grid. Change the exposure time or "
        "the light, so that the bare board is at three quarters of the range."
    ),
    Refusal.BLURRED: (
        "The target's dots, corners or codes are blurred: their edges are as wide as they are. Focus on the "
        "target, and let it be still while the shutter is open."
    ),
    Refusal.TOO_SMALL: (
        "The target is seen, but too small to be measured. Come nearer, or take a longer lens, more pixels "
        "or a target with larger dots or squares: a dot or a square of a chessboard should be 10 px across "
        "or more, a square with a marker 15 px, a cell of a tag 2 px."
    ),
    Refusal.TOO_FEW_DOTS: "Too few dots were found. Move the target so that more of it is in the frame.",
    Refusal.NO_GRID: (
        "Round spots were found, but they form no grid. Check that the picture shows the target, that it is "
        "sharp, and that no more than a third of its dots are hidden."
    ),
    Refusal.NO_RINGS: (
        "A grid of dots was found, but not the three rings at the target's steps from each other. Check that "
        "all three rings are in the frame, that nothing hides them, and that the right target is named."
    ),
    Refusal.AMBIGUOUS_RINGS: (
        "The rings fit the target at more than one place. Show one target only, and remove what looks like a "
        "further ring (a reflection, a hole in a dot)."
    ),
    Refusal.AMBIGUOUS: (
        "The dots are all alike, and their numbering is not determined. Show the whole grid, with nothing "
        "hidden at its edges and all cameras in the same orientation; check that the target has as many "
        "columns and rows as the print; or show the code of the print beside a part; or use a target with "
        "rings, which need not be seen whole."
    ),
    Refusal.SEVERAL_TARGETS: (
        "The target is in the picture more than once, and nothing tells which one is meant. Show one target "
        "only, or cover the others."
    ),
    Refusal.NO_MARKERS: (
        "No marker of the board was found. Check that the board is in the picture, sharp and not mirrored, "
        "that a marker is at least 15 px across, and that the target names the board's dictionary."
    ),
    Refusal.NO_CODED_DOTS: (
        "No coded dot of the target was read. Check that it is in the picture, sharp and not mirrored, that "
        "a dot is at least 10 px across, and that the target names the code and the marks of the print."
    ),
    Refusal.MARKERS_UNREADABLE: (
        "Two markers or more, near to each other, must be read to place the board. Check that its codes are "
        "clean, sharp and at least 15 px across, and that glare or dirt does not cover them."
    ),
    Refusal.AMBIGUOUS_MARKERS: (
        "The board is seen twice. Show one print of it only: cover the other one, or take it out of the "
        "picture."
    ),
    Refusal.OTHER_IDS: (
        "The target does not have these ids. Name the board that is in the picture, or state the id of "
        "its first marker, first_id (of coded dots first_mark), in the target's description."
    ),
    Refusal.TORN_CORNERS: (
        "The board is found, but too few of its corners can be measured. Check that the corners, where "
        "squares touch, are clean, sharp and not covered, and that marker_mm and square_mm, where the target "
        "has them, are those of the print."
    ),
    Refusal.OTHER_BOARD: (
        "Markers were found, but not in the places that the target gives them. Check its numbers of columns "
        "and rows, its sizes and, of a ChArUco board, its pattern: 'legacy' for boards made by OpenCV before "
        "4.6. Where these are right, come nearer: markers less than 15 px across are often read wrongly or "
        "found beside their places."
    ),
    Refusal.NO_CHESSBOARD: (
        "No chessboard was found. Check that the board is in the picture, in focus and flat, and that a "
        "square is at least 10 px across."
    ),
    Refusal.BOARD_IN_PART: (
        "Only a part of the chessboard was found, and nothing numbers it. Show three neighbouring corners at "
        "least of each outermost line; check that the target has as many inner corners as the print; or "
        "show the code of the print beside the part; or use a board with marks, or a ChArUco board."
    ),
    Refusal.CORNER_SQUARES: (
        "Set `corner_squares:` in the target as the print is, and check that it is the target's: prints of "
        "Kalibr's have small black squares at the corners of their tags."
    ),
    Refusal.BORDER_CELLS: (
        "Set `border_cells:` in the target as the print is: 2 on prints of Kalibr's, 1 on most others."
    ),
    Refusal.OTHER_CHESSBOARD: (
        "A chessboard was found that is not the target's. Check its numbers of inner corners (squares less "
        "one), the colour of its lower left square, and its marks."
    ),
    Refusal.MIRRORED: (
        "The target is seen as in a mirror. Check that the picture is not flipped, that the target is "
        "seen from its front and not in a mirror, and that it was printed without mirroring."
    ),
    Refusal.NO_USABLE_DOTS: (
        "The target was found, but none of its dots, or fewer than a tenth of those in sight, can be "
        "measured. See the dots' flags: 'cut' and 'hidden' want more of the target in sight, 'blurred' "
        "focus, 'saturated' another exposure, 'bad-fit' a clean print that nothing covers."
    ),
    Refusal.GRID_INCONSISTENT: (
        "The dots do not lie on one smooth grid. Check that the target is in one piece and flat, and that "
        "its middle is not hidden."
    ),
}


def advice(refusal: Refusal) -> str:
    """Return a sentence for a person: what is wrong with the picture and what to do about it."""
    return _ADVICE[refusal]
