"""Detectors whose weights others published in packages: a second opinion about objects, and faces for `--blur`."""
