"""The paper's rows and claims, and benchmarks."""
