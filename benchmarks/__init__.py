"""Runnable measurements; `python -m benchmarks.<name> --help` explains each."""
