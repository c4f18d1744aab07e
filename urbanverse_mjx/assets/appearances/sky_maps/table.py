"""Table of 306 skies: 17 moments of the day and year times 18 kinds of weather, each with small random deviations."""

import dataclasses
import functools

import numpy as np

from urbanverse_mjx.datatypes import validation as v

from .. import noise


@dataclasses.dataclass(frozen=True)
class Moment:
    """season, time of day, height of the sun in degrees, brightness of a white surface on the image, words."""

    season: str
    time: str
    elevation: float
    exposure: float
    words: str


#: Sun heights are those of a city at 45 degrees north within a few degrees: 68 at the summer noon, 21 at the winter's.
MOMENTS: dict[str, Moment] = {
    "spring_dawn": Moment("spring", "dawn", -3.0, 0.42, "before sunrise in spring"),
    "summer_sunrise": Moment("summer", "dawn", 1.5, 0.55, "at a summer sunrise"),
    "autumn_sunrise": Moment("autumn", "dawn", 3.5, 0.60, "shortly after an autumn sunrise"),
    "winter_morning": Moment("winter", "morning", 9.0, 0.72, "on a winter morning"),
    "spring_morning": Moment("spring", "morning", 18.0, 0.80, "on a spring morning"),
    "autumn_morning": Moment("autumn", "morning", 24.0, 0.80, "on an autumn morning"),
    "summer_morning": Moment("summer", "morning", 33.0, 0.84, "on a summer morning"),
    "winter_noon": Moment("winter", "noon", 21.0, 0.80, "at noon in winter"),
    "autumn_noon": Moment("autumn", "noon", 37.0, 0.84, "at noon in autumn"),
    "spring_noon": Moment("spring", "noon", 50.0, 0.86, "at noon in spring"),
    "summer_noon": Moment("summer", "noon", 67.0, 0.88, "at noon in summer"),
    "summer_afternoon": Moment("summer", "afternoon", 44.0, 0.85, "on a summer afternoon"),
    "autumn_afternoon": Moment("autumn", "afternoon", 14.0, 0.76, "on a late autumn afternoon"),
    "summer_evening": Moment("summer", "evening", 8.0, 0.70, "in the golden light of a summer evening"),
    "spring_sunset": Moment("spring", "dusk", 2.0, 0.56, "at a spring sunset"),
    "winter_dusk": Moment("winter", "dusk", -4.0, 0.36, "at dusk in winter"),
    "night": Moment("autumn", "night", 38.0, 0.20, "at night over the glow of lamps"),
}


@dataclasses.dataclass(frozen=True)
class Weather:
    """kind: clear, hazy, cumulus, cirrus, stratus or overcast; turbidity; cover of the sky in [0, 1]; words."""

    kind: str
    turbidity: float
    cover: float
    words: str


WEATHERS: dict[str, Weather] = {
    "crisp": Weather("clear", 1.25, 0.0, "Deep blue cloudless sky in very clear air"),
    "clear": Weather("clear", 1.6, 0.0, "Cloudless sky"),
    "hazy": Weather("hazy", 3.0, 0.0, "Pale hazy sky without clouds"),
    "smog": Weather("hazy", 6.0, 0.0, "Milky sky full of smog"),
    "few_cumulus": Weather("cumulus", 1.45, 0.11, "A few small fair-weather clouds"),
    "scattered_cumulus": Weather("cumulus", 1.5, 0.32, "Scattered cumulus clouds"),
    "broken_cumulus": Weather("cumulus", 1.6, 0.58, "Broken cumulus clouds with gaps of sky"),
    "towering_cumulus": Weather("cumulus", 1.5, 0.34, "Towering cumulus clouds with dark bases"),
    "cirrus": Weather("cirrus", 1.4, 0.45, "Mares' tails of high cirrus"),
    "veil": Weather("cirrus", 1.7, 0.95, "A thin veil of cirrostratus with a halo round the sun"),
    "mackerel": Weather("cirrus", 1.4, 0.55, "A mackerel sky of small high rolls"),
    "cumulus_under_cirrus": Weather("cumulus", 1.5, 0.45, "Low cumulus under streaks of cirrus"),
    "stratocumulus": Weather("stratus", 1.7, 0.70, "Grey rolls of stratocumulus with bright seams"),
    "closed_stratocumulus": Weather("stratus", 1.8, 0.92, "A nearly closed layer of stratocumulus"),
    "thin_overcast": Weather("overcast", 2.0, 1.0, "Thin overcast, the sun a pale disc"),
    "overcast": Weather("overcast", 2.0, 1.0, "Even grey overcast"),
    "rain": Weather("overcast", 2.0, 1.0, "Dark ragged rain clouds"),
    "mist": Weather("overcast", 4.0, 1.0, "Mist and low cloud"),
}


@dataclasses.dataclass(frozen=True)
class SkyRecord:
    """One sky.

    Attributes:
      uid: "moment-weather".
      description: one sentence.
      season, time: spring ... winter; dawn, morning, noon, afternoon, evening, dusk or night.
      kind: clear, hazy, cumulus, cirrus, stratus or overcast.
      weather: the narrower name.
      sun_elevation, sun_azimuth: of the sun (at night the moon), degrees; azimuth counter-clockwise from +x.
      turbidity: 1 for pure air, 1.6 clear (optical depth of haze 0.065 at 550 nm), 6 smog.
      cover: share of the sky under clouds.
      horizon: distant silhouette: plain, hills, trees, town or towers.
      snow: whether the land is white.
      exposure: brightness of a white surface on the image.
    """

    uid: str
    description: str
    season: str
    time: str
    kind: str
    weather: str
    sun_elevation: float
    sun_azimuth: float
    turbidity: float
    cover: float
    horizon: str
    snow: bool
    exposure: float


_HORIZONS = {
    "town": "low roofs", "towers": "tall buildings", "trees": "a line of trees", "hills": "hills", "plain": "open land",
}  # fmt: skip


def _record(moment_name: str, weather_name: str) -> SkyRecord:
    moment, weather = MOMENTS[moment_name], WEATHERS[weather_name]
    uid = f"{moment_name}-{weather_name}"
    # Whole numbers drawn and divided: every machine makes the same table.
    draw = noise.generator(f"sky_maps/{uid}").integers(0, 1000, 5) / 1000.0
    horizon = ("town", "town", "towers", "trees", "trees", "hills", "plain")[int(draw[0] * 7)]
    dark = {"rain": 0.55, "overcast": 0.75, "mist": 0.92, "closed_stratocumulus": 0.92}.get(weather_name, 1.0)
    snow = moment.season == "winter" and draw[1] < 0.4
    spread = 1.0 if abs(moment.elevation) < 5 else min(3.0, 0.1 * moment.elevation)
    land = f", {_HORIZONS[horizon]}{' under snow' if snow else ''} on the horizon"
    return SkyRecord(
        uid=uid,
        description=f"{weather.words} {moment.words}{land}",
        season=moment.season,
        time=moment.time,
        kind=weather.kind,
        weather=weather_name,
        sun_elevation=round(moment.elevation + spread * (2 * float(draw[2]) - 1), 2),
        sun_azimuth=round(360.0 * float(draw[3]) - 180.0, 1),
        turbidity=round(weather.turbidity * (0.9 + 0.2 * float(draw[4])), 2),
        cover=weather.cover,
        horizon=horizon,
        snow=bool(snow),
        exposure=round(moment.exposure * dark, 3),
    )


@functools.cache
def _table() -> dict[str, SkyRecord]:
    records = (_record(moment, weather) for moment in MOMENTS for weather in WEATHERS)
    return {record.uid: record for record in records}


def sky_records() -> tuple[SkyRecord, ...]:
    """All 306 skies in a fixed order."""
    return tuple(_table().values())


def find_sky(uid: str) -> SkyRecord:
    """One sky.

    Raises:
      ValidationError: no such sky.
    """
    if uid not in _table():
        moment = str(uid).split("-")[0]
        near = [known for known in _table() if known.startswith(moment + "-")] or list(_table())
        raise v.fail("sky", repr(uid), "a uid such as " + ", ".join(near[:8]))
    return _table()[uid]


def unit_to_sun(record: SkyRecord) -> np.ndarray:
    """(3,) unit from the ground to the sun; below the horizon at dawn and dusk."""
    elevation, azimuth = np.radians(record.sun_elevation), np.radians(record.sun_azimuth)
    return np.array(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    )  # fmt: skip
