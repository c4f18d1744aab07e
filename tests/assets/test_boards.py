"""Boards, vehicles and counters in the language of the street."""

import re

import numpy as np
import pytest

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.meshes import paint
from urbanverse_mjx.assets.meshes.mesh_cache import path_of
from urbanverse_mjx.assets.meshes.recipe import all_recipes
from urbanverse_mjx.assets.recipes.building.regional import boards, words
from urbanverse_mjx.assets.recipes.building.regional.styles import TRADES, traditions
from urbanverse_mjx.assets.records import regional
from urbanverse_mjx.assets.records.index import build_mesh

INDEX = load_index()
TABLE = words.board_table()
#: Leaves whose boards a passer-by reads first.
READ = ("advertising board", "blackboard", "banner", "van", "postbox", "kiosk", "street food stall", "town hall")
#: Number plates, prices, addresses: what no language changes.
PLAIN = re.compile(r"[^A-Za-z]*|.*\d.*|.*www\..*|.")


def texts_of(monkeypatch: pytest.MonkeyPatch, leaf: str) -> list[str]:
    """All texts of the variants of a leaf."""
    found: list[str] = []
    write = paint.text

    def noted(draw: object, text: str, *args: object, **more: object) -> None:
        found.append(text)
        write(draw, text, *args, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(paint, "text", noted)
    for recipe in all_recipes():
        if recipe.leaf == leaf:
            for variant in range(recipe.variants):
                recipe.build(variant)
    return found


@pytest.mark.parametrize("leaf", READ)
def test_no_board_of_a_japanese_street_is_in_latin_letters(leaf: str, monkeypatch: pytest.MonkeyPatch) -> None:
    said = {text for text in texts_of(monkeypatch, leaf) if not PLAIN.fullmatch(text.replace("\n", " "))}
    assert said
    for text in said:
        found = boards.translated(text, "japanese")
        assert found, f"{text!r} has no Japanese words"
        assert not re.search("[A-Za-z]", found)
    assert leaf in TABLE["lettered"]["leaves"]


@pytest.mark.parametrize("language", TABLE["columns"])
def test_every_text_has_its_words_in_every_language(language: str) -> None:
    assert language in TABLE["places"]
    for text in TABLE["texts"]:
        assert text == boards.key_of(text)
        found = boards.translated(text, language)
        assert found
        for line in words.lines(found):
            mask = np.asarray(words.mask(f"boards/{language}", line))
            assert mask.shape[0] == words.BOARD_HEIGHT
            assert 0.03 < (mask > 0).mean() < 0.97


def test_languages_with_a_script_of_their_own_use_it() -> None:
    scripts = {
        "japanese": "[\u3040-\u30ff\u4e00-\u9fff]", "chinese": "[\u4e00-\u9fff]", "taiwanese": "[\u4e00-\u9fff]",
        "korean": "[\uac00-\ud7a3]", "thai": "[\u0e00-\u0e7f]", "hindi": "[\u0900-\u097f]",
        "arabic": "[\u0600-\u06ff]", "russian": "[\u0400-\u04ff]",
    }  # fmt: skip
    for language, letters in scripts.items():
        for text in TABLE["texts"]:
            found = boards.translated(text, language) or ""
            assert re.search(letters, found), f"{language}: {found!r}"
            assert not re.search("[A-Za-z]", found), f"{language}: {found!r}"


@pytest.mark.parametrize(
    ("text", "key"),
    [("Soup 5", "SOUP"), ("FRESH\nCOFFEE", "FRESH COFFEE"), ("12 CENTRAL STATION", "CENTRAL STATION"),
     ("< Market", "MARKET"), ("TACO 3.50", "TACO"), ("BUS  Centre - Station", "BUS CENTRE - STATION")],
)  # fmt: skip
def test_texts_are_found_without_numbers_and_arrows(text: str, key: str) -> None:
    assert boards.key_of(text) == key


def test_a_board_shows_other_words_in_another_language_and_its_own_without_one() -> None:
    record = next(r for r in INDEX.by_leaf("advertising board") if r.params["variant"] == 0)
    plain = build_mesh(record)
    with boards.in_language("japanese"):
        local = build_mesh(record)
    with boards.in_language(boards.ENGLISH):
        english = build_mesh(record)
    assert np.array_equal(plain.vertices, local.vertices)
    assert np.array_equal(plain.uv, local.uv)
    assert not np.array_equal(plain.texture, local.texture)
    assert np.array_equal(plain.texture, english.texture)
    assert np.array_equal(plain.texture, build_mesh(record).texture)


def test_what_carries_no_text_is_the_same_mesh_in_every_language() -> None:
    record = INDEX.by_leaf("bench")[0]
    plain = build_mesh(record)
    with boards.in_language("japanese"):
        assert build_mesh(record) is plain
    assert path_of("a", "b", 0) != path_of("a", "b", 0, "japanese x")


def test_a_german_town_hall_is_none_in_buenos_aires_or_london() -> None:
    assert boards.translated("RATHAUS", boards.language_of(("Buenos Aires", "Argentina"))) == "MUNICIPALIDAD"
    assert boards.translated("RATHAUS", boards.language_of(("London", "United Kingdom"))) == "CITY HALL"


@pytest.mark.parametrize(
    ("city", "country", "language"),
    [("Istanbul", "Turkey", "turkish"), ("Bangkok", "Thailand", "thai"), ("Lisbon", "Portugal", "portuguese"),
     ("Taipei", "Taiwan", "taiwanese")],
)  # fmt: skip
def test_signs_of_houses_are_in_the_language_of_the_country_not_of_their_tradition(
    city: str, country: str, language: str
) -> None:
    name = regional.tradition_of(city, country)
    assert name is not None
    assert traditions()[name].language != language
    assert boards.language_of((city, country)) == language
    record = next(r for r in regional.of_tradition(name) if r.params["trade"])
    plain = build_mesh(record)
    with boards.in_language(language):
        assert boards.shop_language(traditions()[name].language) == language
        local = build_mesh(record)
    assert np.array_equal(plain.vertices, local.vertices)
    assert not np.array_equal(plain.texture, local.texture)
    assert set(TRADES) <= set(words.languages()[language])


def test_every_city_of_a_tradition_has_a_language_of_its_country() -> None:
    """A place of two languages would be found in the order of the table."""
    listed = [place for places in TABLE["places"].values() for place in places]
    assert len(listed) == len(set(listed))
