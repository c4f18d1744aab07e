"""Selects assets by label, box and appearance, and searches all collections."""
