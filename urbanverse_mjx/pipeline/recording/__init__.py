"""Policies drive, and their episodes become a dataset: `record`."""
