"""The documentation's pages: links lead somewhere, Python runs, commands and options exist."""

import pathlib
import re
import shlex
import subprocess
from typing import Any

import pytest
import yaml

from urbanverse_mjx.cli import main
from urbanverse_mjx.datatypes import SceneBank

ROOT = pathlib.Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = ("index", "installation", "quickstart", "concepts", "faq", "training_report", "included")
#: Pages whose Python is run by a test of their subject, which names them; the last are notes on a prototype, whose
#: code is not here.
ELSEWHERE = {
    "onnx": "tests/training/test_export_onnx.py",
    "playground": "tests/support/playground_page.py",
    **{f"tutorials/{path.stem}": "tests/project/test_tutorials.py" for path in (DOCS / "tutorials").glob("*.md")},
    **{f"tasks/{path.stem}": "tests/envs/navigation/tasks/test_pages.py" for path in (DOCS / "tasks").glob("*.md")},
    "sources/brax_over_warp": None,
}
every_page = pytest.mark.parametrize("name", PAGES)
#: A comment above a block marks it as run by the README's test.
MARKER = re.compile(
    r"^<!-- not executed by the test of this page: [^\n]+-->\n```python\n(.*?)^```", re.MULTILINE | re.DOTALL
)


def text_of(name: str) -> str:
    return (DOCS / f"{name}.md").read_text(encoding="utf-8")


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


@every_page
def test_the_python_of_a_page_runs(
    name: str, tmp_path: pathlib.Path, small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch
) -> None:
    small_bank.save(tmp_path / "bank.npz")
    monkeypatch.setenv("URBANVERSE_BANK", str(tmp_path / "bank.npz"))
    text = text_of(name)
    elsewhere = MARKER.findall(text)
    readme = blocks((ROOT / "README.md").read_text(encoding="utf-8"), "python")
    assert [block for block in elsewhere if block not in readme] == []
    space: dict[str, object] = {}
    for block in blocks(text, "python"):
        if block not in elsewhere:
            exec(compile(block, f"{name}.md", "exec"), space)


def test_no_python_of_a_page_is_left_out() -> None:
    holding = {
        path.relative_to(DOCS).with_suffix("").as_posix()
        for path in DOCS.rglob("*.md")
        if blocks(path.read_text(encoding="utf-8"), "python")
    }
    assert holding <= {*PAGES, *ELSEWHERE}
    for name, test in ELSEWHERE.items():
        if test is not None:
            text = (ROOT / test).read_text(encoding="utf-8")
            assert f"{name}.md" in text or 'glob("*.md")' in text, (name, test)


def help_of(words: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    with pytest.raises(SystemExit):
        main.main([*words, "--help"])
    return capsys.readouterr().out


def command_lines() -> list[list[str]]:
    pages = [path.read_text(encoding="utf-8") for path in DOCS.rglob("*.md")]
    code = [line for text in pages for block in blocks(text, "sh") for line in block.splitlines()]
    return [shlex.split(line, comments=True) for line in code if line.startswith("urbanverse ")]


def test_every_command_in_a_block_has_the_options_that_it_is_given(capsys: pytest.CaptureFixture[str]) -> None:
    known: dict[tuple[str, ...], set[str]] = {}
    for _, command, *words in command_lines():
        nested = command in ("scene", "assets", "dataset") or words[:1] in (["batch"], ["import"])
        called = (command, words[0]) if nested else (command,)
        if called not in known:
            known[called] = set(re.findall(r"--[a-z][a-z-]+", help_of(list(called), capsys)))
        assert {word for word in words if word.startswith("--")} <= known[called], (called, words)
    assert len(known) > 5


def test_every_target_of_make_exists() -> None:
    targets = set(re.findall(r"^([a-z-]+):.*## ", (ROOT / "Makefile").read_text(encoding="utf-8"), flags=re.MULTILINE))
    code = "\n".join(
        part for name in PAGES for part in [*blocks(text_of(name), "sh"), *re.findall(r"`[^`\n]+`", text_of(name))]
    )
    named = set(re.findall(r"\bmake ([a-z-]+)", code))
    assert named
    assert named <= targets


@pytest.mark.parametrize("path", sorted(DOCS.rglob("*.md")), ids=lambda path: path.relative_to(DOCS).as_posix())
def test_links_lead_to_files_of_the_site(path: pathlib.Path) -> None:
    links = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", path.read_text(encoding="utf-8"))
    for link in links:
        if not link.startswith(("https:", "http:")):
            target = (path.parent / link).resolve()
            assert target.is_file(), link
            assert DOCS in target.parents, f"{link} lies outside the site"


def names(entry: Any) -> list[str]:
    if isinstance(entry, str):
        return [entry]
    children = entry.values() if isinstance(entry, dict) else entry
    return [name for child in children for name in names(child)]


def test_the_navigation_holds_every_page_and_no_other() -> None:
    config = yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
    reached: set[pathlib.Path] = set()
    for name in names(config["nav"]):
        if name != "CHANGELOG.md":  # a hook takes it from the root
            found = set(DOCS.glob(name))
            assert found, name
            reached |= found
    assert set(DOCS.rglob("*.md")) - reached == set(), "pages without a place in mkdocs.yml"


@pytest.mark.slow
def test_the_site_builds(tmp_path: pathlib.Path) -> None:
    """A name that the API's pages give and no module defines is found here alone; fetches what builds the site."""
    command = ["make", "docs", f"ARGS=--site-dir {tmp_path / 'site'}"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]
    for page in ("index.html", "api/envs.html", "CHANGELOG.html"):
        assert (tmp_path / "site" / page).stat().st_size > 2000, page
