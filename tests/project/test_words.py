"""Retired words do not return: each was ambiguous, and more precise terms replace it."""

import io
import pathlib
import re
import tokenize

import pytest

from tests.project.test_style import ROOT, tracked

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
