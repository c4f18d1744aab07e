"""Which small faults the tests would miss: `python -m tests.support.mutants`, see `make mutants`.

Neither mutmut nor Cosmic Ray fits: the one forks a process in which JAX runs threads, the other runs the same tests for
every fault. Here each fault is planted in a copy of the repository, and the tests that ran its line are run on it.
"""
