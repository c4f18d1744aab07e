"""Constants, defaults of functions and of fields in `simulation`: whoever changes one acknowledges it."""

import pytest

from tests.support import defaults, figures


@pytest.mark.mjx
def test_figures_of_defaults() -> None:
    modules = defaults.modules_of("simulation")
    found = {module.partition(".")[2]: defaults.defaults_of(module) for module in modules}
    figures.check("defaults/simulation", {module: values for module, values in found.items() if values}, tolerance=1e-5)
