"""The procedural set `procedural`: streets from five templates with random sizes, filled zone by zone."""

from .generator import COUNT, build, template_of

__all__ = ["COUNT", "build", "template_of"]
