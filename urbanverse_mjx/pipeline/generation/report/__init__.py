"""`report.html`: one page with the film of a run beside its cousins, the map, all objects and what was left out."""

from .page import write_report

__all__ = ["write_report"]
