"""Retired words do not return: each was ambiguous, and more precise terms replace it."""

import ast
import functools
import io
import json
import pathlib
import re
import tokenize
from collections.abc import Callable

import pytest

from tests.project.test_style import ROOT, tracked
from urbanverse_mjx.cli import main

#: Word -> what to call it instead.
RETIRED = {
    "eye": "perception_model, camera_position",
    "footing": "traversability, placement",
    "living": "dynamic",
    "mend": "fix",
    "noun": "datatype",
    "patience": "deadlock",
    "picture": "image, texture",
    "renew": "reset_episode",
    "rival": "baseline",
    "settle": "resolve_collisions",
    "settling": "stability",
    "thing": "object",
    "tour": "capture, trajectory",
    "truth": "ground_truth, reference",
    "watcher": "observer",
    "way": "path, route, trajectory, offset",
    "wish": "preferred_velocity",
}
#: Names of flags, of stored keys, and of options that mirror them; and terms of others.
ALLOWED = {
    "eye": "numpy's identity matrix, and --perception eye",
    "_eyes": "those of people and animals in recipes",
    "_one_way_face": "a face that is seen from one side",
    "eyes": "those of people and animals in recipes",
    "eye_level": "the height of a person's eyes",
    "give_way": "what traffic rules say",
    "picture": "--picture",
    "pictures": "--pictures",
    "rivals": "--rivals, and a key of benchmark cases",
    "tour": "the former key of a run's video options",
    "way": "a key of frozen episodes and of city profiles",
}
#: Files in which a name may stand that a flag or a stored key has.
PLACES = {
    "picture": ("urbanverse_mjx/cli/robot.py",),
    "rivals": ("benchmarks/throughput.py", "benchmarks/lib/cases.py", "tests/benchmarks/test_throughput.py"),
    "tour": ("urbanverse_mjx/pipeline/generation/stages.py",),
    "way": (
        "tests/evaluation/test_benchmark.py",
        "urbanverse_mjx/evaluation/frozen.py",
    ),
}
PART = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
GROUND_TRUTH = re.compile(r"ground_?truth", re.IGNORECASE)
FORMS = {form: word for word in RETIRED for form in (word, f"{word}s", f"{word}es")}
IDENTIFIER = re.compile(r"[A-Za-z_]\w*")


def retired_in(name: str) -> str | None:
    """The first retired word that is a part of an identifier."""
    return next((FORMS[p.lower()] for p in PART.findall(GROUND_TRUTH.sub("", name)) if p.lower() in FORMS), None)


def found_in(source: str, path: str) -> list[str]:
    """Identifiers with retired words in the source of a file, but those of tests, which are sentences."""
    words = {name: word for name in set(IDENTIFIER.findall(source)) if (word := retired_in(name))}
    if not words:
        return []
    found = []
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        name = token.string
        if token.type != tokenize.NAME or name not in words or name.startswith("test_"):
            continue
        if not (name in ALLOWED and path in PLACES.get(name, (path,))):
            found.append(f"{path}:{token.start[0]}: found {name!r}, needed a name of {RETIRED[words[name]]}")
    return found


def test_no_identifier_has_a_retired_word() -> None:
    found = []
    for file in tracked():
        if file.suffix == ".py":
            found += found_in(file.read_text(encoding="utf-8"), file.relative_to(ROOT).as_posix())
    assert not found


@pytest.mark.parametrize(
    ("source", "path", "names"),
    [
        ("way = 1\n", "urbanverse_mjx/scene/maps.py", 1),
        ("def f(episode):\n    return episode.way\n", "urbanverse_mjx/evaluation/frozen.py", 0),
        ("class OldPicture: ...\nMAX_EYES = 2\n", "benchmarks/bank.py", 2),
        ("import numpy as np\nground_truth = np.eye(3)\naway = always = something = 0\n", "benchmarks/bank.py", 0),
        ("x = 0  # the way there\ntruths = 'a picture'\n", "benchmarks/bank.py", 1),
        ("def test_a_way(): ...\n", "tests/scene/test_maps.py", 0),
    ],
)
def test_the_scan_finds_what_it_should(source: str, path: str, names: int) -> None:
    assert len(found_in(source, path)) == names


def test_every_exception_is_needed() -> None:
    for name, paths in PLACES.items():
        for path in paths:
            assert re.search(rf"\b{name}\b", pathlib.Path(ROOT / path).read_text(encoding="utf-8")), (name, path)


#: Words of `RETIRED` that have no plain sense in our subject, but in these phrases.
PROSE = re.compile(rf"\b({'|'.join(sorted(set(RETIRED) - {'way'}))})(s|es)?\b", re.IGNORECASE)
PHRASES = {
    "eye level": "the height of a person's eyes",
    '"eye"': "value of --perception",
    "(default: eye)": "of --perception, in its help",
    "ground truth": "a term of the field",
    "ground-truth": "a term of the field",
    "truth.json": "a file's name",
    "picture.png": "a file's name",
    "tour.mp4": "a file's name",
    "-pictures": "a flag, and its opposite",
    "--picture": "a flag",
    "pictures:": "an argument with the flag's name",
    "city-tour": "the paper's title",
    "synthetic tour": "stored in the graphs of UrbanVerse-160",
    "the noun ": "a part of speech",
}


def prose_with_retired(text: str) -> list[str]:
    """Places in a text a user reads where a retired word stands, but in `PHRASES`."""
    text = " ".join(text.split())
    for phrase in PHRASES:
        text = re.sub(re.escape(phrase), "", text, flags=re.IGNORECASE)
    return [text[max(m.start() - 30, 0) : m.end() + 30] for m in PROSE.finditer(text)]


@functools.cache
def pages() -> dict[str, str]:
    """The documentation by its file, but the list of changes and copied sources, which name what was renamed."""
    files = [p for p in (ROOT / "docs").rglob("*") if p.suffix in (".md", ".ipynb") and "sources" not in p.parts]
    found = {}
    for path in (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *files):
        text = path.read_text(encoding="utf-8")
        if path.suffix == ".ipynb":
            text = "\n".join("".join(cell["source"]) for cell in json.loads(text)["cells"])
        found[path.relative_to(ROOT).as_posix()] = text
    return found


@functools.cache
def sentences() -> dict[str, str]:
    """Messages, docstrings and help of the package by their file and line, but of recipes, which describe objects."""
    found = {}
    for path in sorted((ROOT / "urbanverse_mjx").rglob("*.py")):
        if "recipes" not in path.parts:
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value:
                    found[f"{path.relative_to(ROOT).as_posix()}:{node.lineno}:{node.col_offset}"] = node.value
    return found


@pytest.mark.parametrize("texts", [pages, sentences], ids=lambda f: f.__name__)
def test_no_text_that_a_user_reads_has_a_retired_word(texts: Callable[[], dict[str, str]]) -> None:
    assert {place: found for place, text in texts().items() if (found := prose_with_retired(text))} == {}


@pytest.mark.parametrize("command", sorted(main.COMMANDS))
def test_no_help_has_a_retired_word(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Also names of flags and values, which are no sentences."""
    with pytest.raises(SystemExit):
        main.main([command, "--help"])
    said = " ".join(capsys.readouterr().out.replace("\u2502", " ").split())
    assert prose_with_retired(said.replace("eye,foundation", "").replace("--rivals", "")) == []


def test_the_scan_of_texts_finds_what_it_should() -> None:
    assert prose_with_retired("a tour of things") == ["a tour of things"] * 2
    assert prose_with_retired("away from something; the ground truth at eye level; --no-pictures") == []


def test_every_phrase_is_needed() -> None:
    texts = "\n".join((*pages().values(), *sentences().values())).lower()
    in_help = {"(default: eye)"}
    assert [phrase for phrase in set(PHRASES) - in_help if phrase.lower() not in " ".join(texts.split())] == []
