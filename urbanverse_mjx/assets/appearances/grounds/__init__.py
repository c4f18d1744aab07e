"""98 road and 190 sidewalk materials: tileable maps at metric scale, generated on demand."""

from .painting import GroundMaps, paint_ground
from .table import GroundRecord, ground_records

__all__ = ["GroundMaps", "GroundRecord", "ground_records", "paint_ground"]
