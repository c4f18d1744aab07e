"""Comparison of the engines with C MuJoCo on drives of one robot."""
