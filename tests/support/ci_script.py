"""Scripts of `.ci`, which is no package, as modules."""

import importlib.util
import pathlib
import sys
import types

FOLDER = pathlib.Path(__file__).parents[2] / ".ci"


def load(name: str) -> types.ModuleType:
    """`.ci/NAME.py`."""
    spec = importlib.util.spec_from_file_location(f"ci_{name}", FOLDER / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # its dataclass looks for its module there
    spec.loader.exec_module(module)
    return module
