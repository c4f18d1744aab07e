"""306 skies: equirectangular radiance with sun, generated on demand."""

from .painting import SkyMap, paint_sky
from .table import SkyRecord, sky_records

__all__ = ["SkyMap", "SkyRecord", "paint_sky", "sky_records"]
