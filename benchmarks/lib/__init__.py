"""What the benchmark scripts share: cases, measurements, trials and how results are reported."""
