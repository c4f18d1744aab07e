"""Constants, defaults of functions and of fields of whole packages: whoever changes one acknowledges it."""

import pytest

from tests.support import defaults, figures

PACKAGES = ("crowds", "envs", "evaluation", "scene", pytest.param("simulation", marks=pytest.mark.mjx), "training")


@pytest.mark.parametrize("package", PACKAGES)
def test_figures_of_defaults(package: str) -> None:
    found = {name.partition(".")[2]: defaults.defaults_of(name) for name in defaults.modules_of(package)}
    figures.check(f"defaults/{package}", {name: values for name, values in found.items() if values}, tolerance=1e-6)
