"""CITATION.cff names the version that the package has."""

import pathlib

import yaml

import urbanverse_mjx

ROOT = pathlib.Path(__file__).parents[2]


def test_the_citation_is_of_this_version() -> None:
    cff = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    preferred = cff["preferred-citation"]
    assert cff["version"] == preferred["version"] == urbanverse_mjx.__version__
    assert (cff["type"], preferred["type"], cff["license"]) == ("software", "software", "Apache-2.0")
    assert [(paper["year"], "ICLR" in paper["conference"]["name"]) for paper in cff["references"]] == [(2026, True)]
