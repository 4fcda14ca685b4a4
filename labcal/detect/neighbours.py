"""Where a grid node should be, told by the nodes around it."""

from dataclasses import dataclass

import numpy as np

Node = tuple[int, int]

_WINDOWS = (2, 3)  # nodes to either side: the wider one where the near ones are too few
_FEWEST = 5  # known nodes for a prediction


@dataclass(frozen=True)
class Prediction:
    """A node's predicted position (px) and the local steps along both axes (columns of `steps`, px)."""

    position: np.ndarray
    steps: np.ndarray

    def miss(self, position: np.ndarray) -> float:
        """Return how many steps `position` is from the prediction; infinite on a degenerate grid."""
        determinant = np.linalg.det(self.steps)
        if abs(determinant) < 1e-6 * float((self.steps**2).sum()):
            return np.inf
        return float(np.linalg.norm(np.linalg.solve(self.steps, position - self.position)))


def around(node: Node, known: dict[Node, int], window: int = _WINDOWS[0]) -> list[Node]:
    """Return the known nodes around `node`, itself left out."""
    a, b = node
    span = range(-window, window + 1)
    return [(a + i, b + j) for i in span for j in span if (i or j) and (a + i, b + j) in known]


def predict(node: Node, known: dict[Node, int], positions: np.ndarray) -> Prediction | None:
    """Predict a node from its neighbours by a polynomial of the degree that they support.

    The second degree follows perspective and distortion locally; with too few neighbours, or all in few rows
    or columns, the terms that these cannot tell are left out.

    Parameters
    ----------
    node : tuple of int
        Which node; what is known at itself does not enter.
    known : dict
        Index into `positions` by node.
    positions : ndarray, shape (n, 2)
        px.

    Returns
    -------
    Prediction or None
        None where the neighbours are too few or lie on one line.
    """
    for window in _WINDOWS:
        nodes = around(node, known, window)
        if len(nodes) < _FEWEST:
            continue
        a, b = (np.array(nodes, dtype=np.float64) - node).T
        distinct = (len(np.unique(a)), len(np.unique(b)))
        if min(distinct) > 1:
            break
    else:
        return None
    terms = [np.ones_like(a), a, b]
    three, spare = 3, len(nodes) - 4
    if spare > 0:
        terms.append(a * b)
        spare -= 1
    if distinct[0] >= three and spare > 0:
        terms.append(a * a)
        spare -= 1
    if distinct[1] >= three and spare > 0:
        terms.append(b * b)
    design = np.stack(terms, axis=-1)
    solution, _, rank, _ = np.linalg.lstsq(design, positions[[known[n] for n in nodes]], rcond=1e-6)
    if rank < design.shape[1]:
        design = design[:, :three]
        solution, _, rank, _ = np.linalg.lstsq(design, positions[[known[n] for n in nodes]], rcond=1e-6)
        if rank < three:
            return None
    return Prediction(solution[0], solution[1:3].T)
