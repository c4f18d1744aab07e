"""Constants, defaults of functions and of fields in `scene`: whoever changes one acknowledges it."""

from tests.support import defaults, figures


def test_figures_of_defaults() -> None:
    modules = defaults.modules_of("scene")
    found = {module.partition(".")[2]: defaults.defaults_of(module) for module in modules}
    figures.check("defaults/scene", {module: values for module, values in found.items() if values}, tolerance=1e-5)
