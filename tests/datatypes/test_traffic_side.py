"""The side of the road in the countries of the scene library, by names and codes."""

import pytest

from urbanverse_mjx.citygen import city_blocks
from urbanverse_mjx.datatypes.traffic_side import keeps_left


def test_every_city_profile_drives_on_the_side_of_its_country() -> None:
    profiles = [profile for name in city_blocks.PROFILES for profile in city_blocks.layouts(name).values()]
    assert {profile.drives for profile in profiles} == {"left", "right"}
    for profile in profiles:
        assert keeps_left(profile.country) is (profile.drives == "left"), profile.country


@pytest.mark.parametrize(
    "name",
    ["The Bahamas", "japan", "JP", "jpn", "UK", "U.K.", "gb", "Isle of Man", "St. Lucia", "Trinidad & Tobago", "Macao"],
)
def test_names_and_codes_where_traffic_keeps_left(name: str) -> None:
    assert keeps_left(name) is True


@pytest.mark.parametrize("name", ["Germany", "DE", "Gambia", "Nigeria", "Portugal", "United States", "US", "Myanmar"])
def test_names_and_codes_where_traffic_keeps_right(name: str) -> None:
    assert keeps_left(name) is False


@pytest.mark.parametrize("name", ["", " ", "unknown", "Unknown", "nowhere"])
def test_nothing_is_said_of_an_unknown_country(name: str) -> None:
    assert keeps_left(name) is None
