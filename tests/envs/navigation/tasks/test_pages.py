"""The Python of docs/tasks/*.md."""

import pathlib
import re
from typing import Any

import pytest

from tests.support.compiling import optimized
from urbanverse_mjx.datatypes import SceneBank

PAGES = sorted((pathlib.Path(__file__).parents[4] / "docs" / "tasks").glob("*.md"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_code_of_a_page_makes_the_task_it_describes(page: pathlib.Path, small_bank: SceneBank) -> None:
    text = page.read_text(encoding="utf-8")
    (code,) = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    names: dict[str, Any] = {"bank": small_bank}
    with optimized():  # the crowd's tables take seconds
        exec(compile(code, page.name, "exec"), names)
    scores = names["env"].task.SCORES
    assert scores
    for name in scores:
        assert name in text
