"""Reads the table of cities, `profiles/*.toml`: one file per continent and one with the mixes that cities share."""

import dataclasses
import functools
import pathlib
from collections.abc import Mapping
from typing import Any

from ...datatypes import validation as v
from ...datatypes.toml_table import table
from .profile import CityProfile, Mix, mix

FOLDER = pathlib.Path(__file__).parent / "profiles"
_FIELDS = {field.name: field.type for field in dataclasses.fields(CityProfile)}


def read_profiles(path: pathlib.Path) -> tuple[CityProfile, ...]:
    """Returns the profiles of a file, `[[profiles]]` with the fields of `CityProfile`.

    A mix has the syntax of `mix`, or "@name" refers to one of `mixes.toml`.

    Raises:
      ValidationError: a field or a shared mix that does not exist, or a value that is out of range.
    """
    return tuple(_profile(row, f"{path.name}: {row.get('city')}") for row in table(path)["profiles"])


def _profile(row: Mapping[str, Any], where: str) -> CityProfile:
    if unknown := sorted(row.keys() - _FIELDS):
        raise v.fail(f"{where}: field", v.show(unknown), "fields of `CityProfile`", "correct or remove them")
    return CityProfile(**{name: _value(name, value, where) for name, value in row.items()})


def _value(name: str, value: Any, where: str) -> Any:
    if _FIELDS[name] is not Mix:
        return value
    if not value.startswith("@"):
        return mix(value)
    return _shared()[v.choice(value[1:], f"{where}: {name}", _shared())]


@functools.cache
def _shared() -> dict[str, Mix]:
    return {name: mix(text) for name, text in table(FOLDER / "mixes.toml").items()}
