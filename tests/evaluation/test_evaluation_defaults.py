"""Constants, defaults of functions and of fields in `evaluation`: whoever changes one acknowledges it."""

from tests.support import defaults, figures


def test_figures_of_defaults() -> None:
    modules = defaults.modules_of("evaluation")
    found = {module.partition(".")[2]: defaults.defaults_of(module) for module in modules}
    figures.check("defaults/evaluation", {module: values for module, values in found.items() if values}, tolerance=1e-5)
