"""Evidence-based weight decay: the two scales of a Bayesian training (MacKay 1992)."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy.linalg.lapack import dtrtri

from labcal.optim.normal_equations import NormalEquations


@dataclass(frozen=True)
class Evidence:
    """The scales of weights and data in a Bayesian training, and what follows from them.

    The data are taken to be as likely as exp(-beta E_D) and the weights as exp(-alpha E_W), with E_D the sum
    of squared residuals and E_W that of the squared weights.

    Attributes
    ----------
    alpha, beta : float
        Of the weights and of the data. The residuals' variance is 1 / (2 beta).
    effective_parameters : float
        gamma, the effective number of parameters that the data determine.
    log_evidence : float
        Logarithm of the likelihood of the data with the weights integrated out (Laplace's method) under the
        scales that held before these; NaN at the start.
    """

    alpha: float
    beta: float
    effective_parameters: float
    log_evidence: float

    @property
    def decay(self) -> float:
        """The cost of squared weights in units of squared residuals."""
        return self.alpha / self.beta

    def expected_square(self, residuals: int) -> float:
        """Return the mean squared residual expected of new data, by generalised cross-validation.

        Golub, Heath and Wahba 1979, "Generalized cross-validation as a method for choosing a good ridge
        parameter": n E_D / (n - gamma)^2, of so many residuals n.
        """
        left = max(residuals - self.effective_parameters, 1.0)
        return residuals / (2.0 * self.beta * left)

    @classmethod
    def start(cls, square: float, weights: float, counts: tuple[int, int]) -> "Evidence":
        """Return initial scales, as if the data determined every parameter.

        Parameters
        ----------
        square, weights : float
            E_D and E_W.
        counts : (int, int)
            Numbers of residuals and of parameters.
        """
        residuals, parameters = counts
        return cls._of(min(float(parameters), 0.5 * residuals), square, weights, residuals, math.nan)

    def updated(self, equations: NormalEquations, place: int, square: float, residuals: int) -> "Evidence":
        """Return the scales estimated anew at the present weights.

        Foresee and Hagan, "Gauss-Newton approximation to Bayesian learning", IJCNN 1997, after MacKay 1992:
        gamma = p - 2 alpha tr(H^-1) with the Hessian H = 2 beta J'J + 2 alpha I, alpha = gamma / (2 E_W),
        beta = (n - gamma) / (2 E_D).

        Parameters
        ----------
        equations : NormalEquations
            Those of the residuals alone.
        place : int
            Which of their runs.
        square : float
            E_D.
        residuals : int
            Number n of residuals.
        """
        factor = equations.factor(place, self.decay)
        if factor is None:
            return self
        parameters, weights = len(factor), float(equations.parameters[place].square().sum())
        log_determinant = 2.0 * float(np.log(np.diagonal(factor)).sum()) + parameters * math.log(self.beta)
        log_evidence = (
            -self.beta * square
            - self.alpha * weights
            - 0.5 * log_determinant
            + 0.5 * parameters * math.log(self.alpha)
            + 0.5 * residuals * math.log(self.beta / math.pi)
        )
        inverse, _ = dtrtri(factor, overwrite_c=1)
        trace = float(np.square(np.triu(inverse)).sum())
        return self._of(parameters - self.decay * trace, square, weights, residuals, log_evidence)

    def weight_factor(self, equations: NormalEquations, place: int) -> Float64[np.ndarray, "p p"]:
        """Return the lower Cholesky factor of beta J'J + alpha I.

        Where alpha is too small for the matrix to have one, as with exact data, the least one that does is
        taken.
        """
        decay = max(self.decay, 1e-15 * float(equations.diagonal(place).max()))
        while (factor := equations.factor(place, decay)) is None:
            decay *= 10.0
        return np.tril(factor.T) * math.sqrt(self.beta)

    @classmethod
    def _of(
        cls, effective: float, square: float, weights: float, residuals: int, log_evidence: float
    ) -> "Evidence":
        # Exact data would make beta infinite, and no data left over would make it negative.
        beta = max(residuals - effective, 1.0) / (2.0 * max(square, 1e-300))
        return cls(effective / (2.0 * max(weights, 1e-300)), beta, effective, log_evidence)
