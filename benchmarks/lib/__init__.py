"""Common parts of the benchmark scripts: cases, measurements, trials and reports."""
