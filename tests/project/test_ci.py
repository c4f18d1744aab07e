"""`.ci/run`: all gates run, the output ends with pytest's summary, and any gate's failure is the script's."""

import pathlib
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).parents[2]
MAKEFILE = """
check:
\t@echo checking; exit {check}
docs:
\t@echo building; exit {docs}
test:
\t@echo testing; echo a warning >&2; echo '{summary}'; exit {test}
"""


@pytest.mark.parametrize(("check", "docs", "test"), [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)])
def test_the_output_ends_with_the_summary(check: int, docs: int, test: int, tmp_path: pathlib.Path) -> None:
    summary = f"{test} failed, 3 passed in 0.10s"
    (tmp_path / ".ci").mkdir()
    shutil.copy2(ROOT / ".ci" / "run", tmp_path / ".ci" / "run")
    (tmp_path / "Makefile").write_text(MAKEFILE.format(check=check, docs=docs, test=test, summary=summary))
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
    order = [lines.index(said) for said in ("checking", "building", "testing", "a warning")]
    assert order == sorted(order)
    assert (done.returncode != 0) == bool(check or docs or test)
