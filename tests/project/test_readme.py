"""The README's Python runs as it stands, its commands exist, and its scores are those of the reports that it names."""

import json
import pathlib
import re
import subprocess
import sys

import pytest

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.selection import libraries
from urbanverse_mjx.citygen import craftbench, procedural_places, procedural_streets, validation_streets
from urbanverse_mjx.cli.main import COMMANDS
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.scene import library

ROOT = pathlib.Path(__file__).parents[2]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
INCLUDED = (ROOT / "docs" / "included.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", TEXT, flags=re.MULTILINE | re.DOTALL)


def test_the_python_example_runs_and_sees_eight_images(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In small streets; the test below takes the shipped ones, in a process of its own."""
    small_bank.save(tmp_path / "bank.npz")
    monkeypatch.setenv("URBANVERSE_BANK", str(tmp_path / "bank.npz"))
    (code,) = blocks("python")
    lines = [line for line in code.splitlines() if line.strip()]
    assert len(lines) <= 10
    exec(compile(code, "README.md", "exec"), {})
    assert re.match(r"\(8, \d+, \d+, 3\) \[", capsys.readouterr().out)


@pytest.mark.slow
def test_the_python_example_runs_as_it_stands(bank: SceneBank) -> None:
    del bank  # it lies in the cache, where the example looks for it
    (code,) = blocks("python")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    assert re.match(r"\(8, \d+, \d+, 3\) \[", done.stdout)


def test_every_command_and_target_that_the_readme_names_exists() -> None:
    for command in re.findall(r"`urbanverse ([a-z-]+)|^urbanverse ([a-z-]+)", TEXT + INCLUDED, flags=re.MULTILINE):
        assert "".join(command) in COMMANDS
    targets = set(re.findall(r"^([a-z-]+):.*## ", (ROOT / "Makefile").read_text(), flags=re.MULTILINE))
    # In code alone: "make the" in prose is no target.
    code = "\n".join([*blocks(""), *re.findall(r"`[^`\n]+`", TEXT)])
    named = set(re.findall(r"\bmake ([a-z-]+)", code))
    assert named
    assert named <= targets


def test_every_command_stands_in_the_readme() -> None:
    assert set(re.findall(r"^\| `urbanverse ([a-z-]+)`", TEXT, flags=re.MULTILINE)) == set(COMMANDS)


@pytest.mark.parametrize("link", re.findall(r"\]\(([^)#]+)\)", TEXT))
def test_links_lead_to_files_of_the_repository(link: str) -> None:
    assert (ROOT / link).is_file()


def counted(what: str) -> list[int]:
    """The numbers of the table of assets in the row that begins with `what`."""
    (row,) = re.findall(rf"^\| {what}[^\n]*", INCLUDED, flags=re.MULTILINE)
    return [int(n.replace(",", "")) for n in re.findall(r"\b\d[\d,]*\b", row)]


def test_the_counts_are_those_of_the_tables() -> None:
    counts = json.loads((ROOT / "assets_index" / "catalogue.json").read_text(encoding="utf-8"))
    assert counted("annotated records") == [len(ontology.categories()), counts["records"]]
    assert counted("base shapes") == [len(load_index().records)]
    counts = {name: len(libraries.library(name).get_uids_all()) for name in ("sky", "road", "sidewalk")}
    assert counted("skies") == [counts["sky"]]
    assert counted("ground materials") == [counts["road"] + counts["sidewalk"]]
    sets = {name: library.scene_set(name) for name in library.sets()}
    layouts = {name: len(s.graphs()) for name, s in sets.items()}
    procedural_scenes, by_hand = (
        procedural_streets.COUNT,
        2 * (len(craftbench.BUILDERS) + len(validation_streets.BUILDERS)),
    )
    assert f"{layouts['urbanverse160']} layouts modelled on the paper's cities" in INCLUDED
    assert f"{procedural_scenes} procedural scenes" in INCLUDED
    assert f"{procedural_places.COUNT} procedural places" in INCLUDED
    made = procedural_scenes + procedural_places.COUNT + by_hand
    total = sum(s.cousins * layouts[name] for name, s in sets.items() if not s.builder) + made
    assert f"`make scenes` all {total}" in INCLUDED


def test_scores_are_those_of_the_report_beside_them() -> None:
    """A score depends on streets, machine and versions: each row links the report that names them."""
    assert "URBANVERSE_BANK" in TEXT
    rows = [line for line in TEXT.splitlines() if re.search(r"\d (?:±|\[)", line)]
    for row in rows:
        (report,) = re.findall(r"\]\((docs/[^)]+)\)", row)
        scores = re.findall(r"[\d.]+ (?:± [\d.]+|\[[^]]+\])", row)
        (policy,) = re.findall(r"`(?:benchmarks/policies/)?([a-z0-9_]+)`", row)
        robot = row.split("|")[2].strip()
        text = (ROOT / report).read_text(encoding="utf-8").replace("*", "")
        theirs = [
            line for line in text.splitlines() if policy in line and (robot in line or report.endswith("results.md"))
        ]
        assert scores
        assert any(all(score in line for score in scores) for line in theirs), (policy, scores)
    assert len(rows) == 7


def test_no_other_score_or_speed_stands_in_the_readme() -> None:
    assert set(re.findall(r"\d[\d.]* ?%", TEXT)) == {"95 %"}, "the level of the intervals alone"
    assert not re.findall(r"\d[\d,.]* env-steps/s|\d+ min\b", TEXT), "speeds and times of a machine"


def test_the_readme_stays_short() -> None:
    assert len(TEXT.splitlines()) <= 150
    assert (ROOT / "docs" / "coco_street.webp").stat().st_size < 10**6
