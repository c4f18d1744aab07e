"""Measures of car bodies, and where on them glass, lamps and grille lie (see `vehicle_body` for s)."""

from urbanverse_mjx.datatypes.toml_table import table

from .vehicle_body import BodyShape

Places = dict[str, tuple[float, float]]

_TABLE = table(__file__)


def _car(name: str) -> tuple[BodyShape, Places]:
    return BodyShape(**_TABLE[name]["shape"]), _TABLE[name]["places"]


SEDAN, SEDAN_PLACES = _car("sedan")
HATCHBACK, HATCHBACK_PLACES = _car("hatchback")
SUV, SUV_PLACES = _car("suv")
VAN, VAN_PLACES = _car("van")
MINIVAN, MINIVAN_PLACES = _car("minivan")
PICKUP, PICKUP_PLACES = _car("pickup")
SEDAN_GLASS = _TABLE["sedan"]["glass"]
