"""The blocks of docs/playground.md, each of which one test runs."""

import pathlib
import re
from typing import Any

PAGE = pathlib.Path(__file__).parents[2] / "docs" / "playground.md"
#: Text that identifies a block -> the test that runs it.
MARKERS = {
    "env.render(": "envs/test_render.py",
    "wrapped.step": "envs/test_stock_wrappers.py",
    "load_ppo()": "envs/test_stock_wrappers.py",
    "import urbanverse_mjx.gym\n": "gym/test_gym.py",
    "OnPolicyRunner(": "gym/test_torch_trainers.py",
    "stable_baselines3": "gym/test_torch_trainers.py",
}


def blocks() -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def run_block(marker: str, **names: Any) -> dict[str, Any]:
    """Runs the block that holds a marker, with names that the blocks above it define; returns all its names."""
    assert marker in MARKERS
    (code,) = (block for block in blocks() if marker in block)
    space = dict(names)
    exec(compile(code, PAGE.name, "exec"), space)
    return space
