"""Benchmark scripts; `python -m benchmarks.<name> --help` describes each."""
