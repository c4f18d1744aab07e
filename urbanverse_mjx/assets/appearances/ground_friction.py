"""Sliding friction of ground materials: that of a dry hard sole or tyre on the surface as it is.

The 32 materials of the shipped streets are rows of `assets_index/materials.csv` in a condition of `grounds.weathering`;
the 288 of `grounds` have it in their records.
"""

import functools

from ...datatypes import validation as v
from ..categories.materials import material
from .grounds import ground_records
from .grounds.weathering import CONDITIONS

#: id: (material, condition). Grass slides like leaves; half of a zebra crossing is paint.
_SURFACES: dict[str, tuple[str, str]] = {
    "asphalt_new": ("asphalt", "dry"),
    "asphalt_old": ("asphalt", "dry"),
    "asphalt_patched": ("asphalt", "dry"),
    "asphalt_light": ("asphalt", "dry"),
    "asphalt_wet": ("asphalt", "wet"),
    "concrete_road": ("concrete", "dry"),
    "cobble_grey": ("stone", "dry"),
    "brick_road": ("brick", "dry"),
    "slabs_grey": ("concrete", "dry"),
    "slabs_warm": ("stone", "dry"),
    "concrete_squares": ("concrete", "dry"),
    "concrete_tiles_small": ("concrete", "dry"),
    "brick_herringbone": ("brick", "dry"),
    "herringbone_grey": ("concrete", "dry"),
    "brick_running": ("brick", "dry"),
    "granite_setts": ("stone", "dry"),
    "mosaic_two_tone": ("limestone", "dry"),
    "flagstones": ("stone", "dry"),
    "tactile_yellow": ("concrete", "dry"),
    "asphalt_walk": ("asphalt", "dry"),
    "terracotta_checks": ("terracotta", "dry"),
    "zebra_new": ("asphalt", "painted_red_worn"),
    "zebra_worn": ("asphalt", "painted_red_worn"),
    "zebra_yellow": ("asphalt", "painted_red_worn"),
    "zebra_red": ("asphalt", "painted_red"),
    "grass": ("leaves", "dry"),
    "grass_dry": ("soil", "dry"),
    "gravel": ("gravel", "dry"),
    "earth": ("soil", "dry"),
    "plaza_tiles": ("marble", "dry"),
    "paint_white": ("asphalt", "painted_red"),
    "paint_yellow": ("asphalt", "painted_red"),
}


@functools.cache
def ground_friction(material_id: str) -> float:
    """Friction coefficient of a material by its id; see `ground_materials.build_material`.

    Raises:
      ValidationError: no such material.
    """
    if material_id.startswith(("road/", "sidewalk/")):
        records = {record.uid: record for record in ground_records()}
        v.choice(material_id, "ground material", records)
        return records[material_id].friction
    v.choice(material_id, "ground material", _SURFACES)
    name, condition = _SURFACES[material_id]
    return round(CONDITIONS[condition].friction(material(name).friction), 3)
