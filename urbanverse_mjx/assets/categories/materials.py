"""Materials of objects: densities, friction on pavement, stiffness and optics, one reviewed row per material.

The rows are data (`assets_index/materials.csv`); each names its sources by the keys of `assets_index/sources.csv`.
"""

import csv
import dataclasses
import functools
import pathlib
from collections.abc import Iterator

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.settings import asset_root

AIR = "air"
#: The official values of `surface_hardness` and `surface_finish`.
HARDNESS = ("soft", "semi-soft", "hard")
FINISHES = ("rough", "matte", "smooth", "glossy", "sleek", "grippy")


@dataclasses.dataclass(frozen=True)
class Material:
    """One material.

    Attributes:
      name: as in `materials` of a record.
      density: kg/m^3 of the solid or liquid; for loose and woven materials including the air between grains or yarns.
      friction: static friction coefficient on dry concrete pavement.
      youngs_modulus: MPa.
      bounciness, roughness, reflectivity: 0 to 1 (restitution, micro roughness, share of light reflected).
      index_of_refraction: optical index.
      hardness, finish: official words.
      density_source, friction_source: keys of the sources.
      reason: explanation of the row's numbers; may be empty if the sources suffice.
    """

    name: str
    density: float
    friction: float
    youngs_modulus: float
    bounciness: float
    roughness: float
    reflectivity: float
    index_of_refraction: float
    hardness: str
    finish: str
    density_source: str
    friction_source: str
    reason: str


@dataclasses.dataclass(frozen=True)
class Source:
    """Source of a number; `address` is empty if there is no web page."""

    key: str
    title: str
    address: str


def read_rows(path: pathlib.Path, columns: tuple[str, ...]) -> Iterator[tuple[str, dict[str, str]]]:
    """Yields (location for messages, row) for each row of a CSV file with exactly these columns.

    Raises:
      ValidationError: the file is missing, has other columns, or a row has another number of cells.
    """
    if not path.is_file():
        raise ValidationError(f"{path}: found no such file, needed a table of the asset index; restore it from git.")
    with path.open(encoding="utf-8", newline="") as file:
        lines = csv.reader(file)
        head = tuple(next(lines, []))
        if head != columns:
            raise ValidationError(f"{path.name}: found the columns {head}, needed {columns}.")
        for number, cells in enumerate(lines, start=2):
            if len(cells) != len(columns):
                raise ValidationError(f"{path.name}:{number}: found {len(cells)} cells, needed {len(columns)}.")
            yield f"{path.name}:{number}", dict(zip(columns, cells, strict=True))


def number(text: str, where: str, low: float = 0.0, high: float = float("inf")) -> float:
    """The number in a cell, `low <= x <= high`.

    Raises:
      ValidationError: the cell is not a number, or is out of range.
    """
    try:
        value = float(text)
    except ValueError as error:
        raise ValidationError(f"{where}: found {text!r}, needed a number.") from error
    if not low <= value <= high:
        raise ValidationError(f"{where}: found {value:g}, needed a number from {low:g} to {high:g}.")
    return value


@functools.cache
def sources() -> dict[str, Source]:
    """key -> source."""
    rows = read_rows(asset_root() / "sources.csv", ("source", "title", "address"))
    return {row["source"]: Source(row["source"], row["title"], row["address"]) for _, row in rows}


@functools.cache
def materials() -> dict[str, Material]:
    """name -> material, for the whole table.

    Raises:
      ValidationError: a row is not valid, or names a source that is not listed.
    """
    columns = ("material", *(f.name for f in dataclasses.fields(Material) if f.name != "name"))
    limits = {
        "density": (1.0, 20000.0),
        "friction": (0.01, 1.5),
        "youngs_modulus": (1e-3, 1e6),
        "index_of_refraction": (1.0, 3.0),
    }
    table: dict[str, Material] = {}
    for where, row in read_rows(asset_root() / "materials.csv", columns):
        name = row.pop("material")
        if not name or name == AIR or name in table:
            raise ValidationError(f"{where}: found {name!r}, needed a new material name (air has no row).")
        values = {key: number(row[key], f"{where} {key}", *limits[key]) for key in limits}
        values |= {key: number(row[key], f"{where} {key}", 0.0, 1.0) for key in _SHARES}
        words = {key: text for key, text in row.items() if key not in values}
        if words["hardness"] not in HARDNESS or words["finish"] not in FINISHES:
            raise ValidationError(f"{where}: found {words['hardness']!r}, {words['finish']!r}, needed official words.")
        for key in ("density_source", "friction_source"):
            if words[key] not in sources():
                raise ValidationError(f"{where}: found the source {words[key]!r}, needed a key of sources.csv.")
        table[name] = Material(name=name, **values, **words)  # pyright: ignore[reportArgumentType]
    return table


_SHARES = ("bounciness", "roughness", "reflectivity")


def material(name: str) -> Material:
    """One material.

    Raises:
      ValidationError: the table has none of this name.
    """
    if name not in materials():
        raise ValidationError(f"material: found {name!r}, needed one of {', '.join(sorted(materials()))}.")
    return materials()[name]
