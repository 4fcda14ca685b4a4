"""The paper's claims C1 to C8 as hypotheses, each with its plan, its runs and its verdict."""
