"""Nodes and weights of the integral over the correlation of two edges, in compiled code."""

from math import asin, cos, pi, sin

import numpy as np

from labcal.detect.compiled import compiled

_NODES_3, _WEIGHTS_3 = (np.ascontiguousarray(part) for part in np.polynomial.legendre.leggauss(3))
_NODES_4, _WEIGHTS_4 = (np.ascontiguousarray(part) for part in np.polynomial.legendre.leggauss(4))
_NODES_6, _WEIGHTS_6 = (np.ascontiguousarray(part) for part in np.polynomial.legendre.leggauss(6))
_NODES_12, _WEIGHTS_12 = (np.ascontiguousarray(part) for part in np.polynomial.legendre.leggauss(12))
_NODES_20, _WEIGHTS_20 = (np.ascontiguousarray(part) for part in np.polynomial.legendre.leggauss(20))
_LEAST, _FEWER, _FEW, _MORE = 0.2, 0.4, 0.75, 0.95
"""Correlations up to which 3 and 4 nodes leave errors below 1e-9, 6 and 12 below 1e-8."""


@compiled
def quadrature(correlation: float) -> np.ndarray:
    """Return sine, squared inverse cosine and weight of the nodes from correlation 0 on, shape (3, k).

    By Gauss and Legendre, as in Drezner and Wesolowsky 1990 for the normal distribution.
    """
    nodes, weights = _NODES_20, _WEIGHTS_20
    if abs(correlation) < _LEAST:
        nodes, weights = _NODES_3, _WEIGHTS_3
    elif abs(correlation) < _FEWER:
        nodes, weights = _NODES_4, _WEIGHTS_4
    elif abs(correlation) < _FEW:
        nodes, weights = _NODES_6, _WEIGHTS_6
    elif abs(correlation) < _MORE:
        nodes, weights = _NODES_12, _WEIGHTS_12
    half = 0.5 * asin(correlation)
    rule = np.empty((3, len(nodes)))
    for k in range(len(nodes)):
        turn = half * (1.0 + nodes[k])
        rule[0, k], rule[1, k] = sin(turn), 1.0 / cos(turn) ** 2
        rule[2, k] = 2.0 / pi * half * weights[k]
    return rule
