"""`.ci/run`: all gates run, the output ends with pytest's summary, and any gate's failure is the script's."""

import pathlib
import re
import shutil
import subprocess
import types
from typing import Any

import pytest

from tests import conftest

ROOT = pathlib.Path(__file__).parents[2]
MAKEFILE = """
check:
\t@echo checking; exit {check}
docs:
\t@echo building; exit {docs}
setup-torch:
\t@echo installing; exit {install}
test-torch:
\t@echo with PyTorch; exit {torch}
test-extended:
\t@echo taking seconds; exit {extended}
test:
\t@echo testing; echo a warning >&2; echo '{summary}'; exit {test}
"""
GATES = ("check", "docs", "install", "torch", "extended", "test")
#: Modules that only `make test-torch` installs.
PYTORCH = ("torch", "torchvision", "transformers", "tensordict", "rsl_rl", "stable_baselines3")


@pytest.mark.parametrize("failing", [(), *((gate,) for gate in GATES), GATES])
def test_the_output_ends_with_the_summary(failing: tuple[str, ...], tmp_path: pathlib.Path) -> None:
    fails = {gate: int(gate in failing) for gate in GATES}
    summary = f"{fails['test']} failed, 3 passed in 0.10s"
    (tmp_path / ".ci").mkdir()
    shutil.copy2(ROOT / ".ci" / "run", tmp_path / ".ci" / "run")
    (tmp_path / "Makefile").write_text(MAKEFILE.format(summary=summary, **fails))
    done = subprocess.run(
        [str(tmp_path / ".ci" / "run")],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
        timeout=60,
    )
    lines = done.stdout.splitlines()
    assert lines[-1] == summary
    torch = "run: PyTorch could not be installed (see above), so the tests marked torch did not run."
    torch = torch if fails["install"] else "with PyTorch"
    order = [
        lines.index(said)
        for said in ("checking", "building", "installing", torch, "taking seconds", "testing", "a warning")
    ]
    assert order == sorted(order)
    assert ("with PyTorch" in lines) is not bool(fails["install"])
    # What cannot be installed is no fault of the code.
    assert (done.returncode != 0) is bool(set(failing) - {"install"})


def test_a_test_that_needs_pytorch_is_marked_so_that_it_runs_where_pytorch_is() -> None:
    """`make test-torch` runs what is marked `torch`; a test that skipped itself would run nowhere."""
    skipping = re.compile(r"importorskip\(\s*[\"'](" + "|".join(PYTORCH) + r")[\"']")
    found = [path for path in (ROOT / "tests").rglob("*.py") if skipping.search(path.read_text(encoding="utf-8"))]
    assert found == []


@pytest.mark.parametrize(
    ("expression", "outcome"),
    [
        ("not slow and not gpu", pytest.skip.Exception),
        ("not torch", pytest.skip.Exception),
        ("torch and not slow and not gpu", pytest.fail.Exception),
    ],
)
def test_a_missing_package_skips_a_test_and_fails_it_where_it_was_asked_for(expression: str, outcome: type) -> None:
    marks = {"torch": [pytest.mark.torch("no_such_package").mark, pytest.mark.torch("numpy").mark]}
    option = types.SimpleNamespace(markexpr=expression)
    item: Any = types.SimpleNamespace(
        iter_markers=lambda name: marks.get(name, []), config=types.SimpleNamespace(option=option)
    )
    with pytest.raises(outcome, match=r"found no package no_such_package.*; `make test-torch` installs it"):
        conftest.pytest_runtest_setup(item)
    marks.clear()
    conftest.pytest_runtest_setup(item)


@pytest.mark.parametrize(
    ("item", "marks"),
    [
        ({"callspec": types.SimpleNamespace(params={"impl": "jax"}), "fixturenames": ["impl"]}, ["mjx"]),
        ({"callspec": types.SimpleNamespace(params={"impl": "warp"}), "fixturenames": ["impl"]}, []),
        ({"fixturenames": ["small_bank", "jax_step"]}, ["mjx"]),
        ({"fixturenames": ["small_bank"]}, []),
        ({}, []),
    ],
)
def test_what_runs_the_mjx_engine_is_marked_and_skipped_where_mujoco_has_no_mjx(
    item: dict[str, Any], marks: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    added = list[str]()
    collected: Any = types.SimpleNamespace(add_marker=added.append, **item)
    conftest.pytest_itemcollected(collected)
    assert added == marks
    collected.get_closest_marker = lambda name: name in added
    collected.iter_markers = lambda _: []
    conftest.pytest_runtest_setup(collected)
    monkeypatch.setattr(conftest, "HAS_MJX", False)
    if marks:
        with pytest.raises(pytest.skip.Exception, match="needs mujoco-mjx"):
            conftest.pytest_runtest_setup(collected)
    else:
        conftest.pytest_runtest_setup(collected)
