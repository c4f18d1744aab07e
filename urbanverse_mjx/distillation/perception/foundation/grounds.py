"""Maps classes of street segmenters (Cityscapes, Mapillary Vistas) to the surface codes of a recording."""

from collections.abc import Mapping

import numpy as np

from ....datatypes import KIND_INDEX, ValidationError
from ....datatypes.recording import SKY

#: Words in a class's name -> surface; the first match counts.
_WORDS = (
    ("crosswalk", "crosswalk"),
    ("lane marking", "road_marking"),
    ("sidewalk", "sidewalk"),
    ("pedestrian area", "sidewalk"),
    ("curb", "sidewalk"),
    ("bike lane", "road"),
    ("service lane", "road"),
    ("road", "road"),
    ("parking", "road"),
    ("pothole", "road"),
    ("manhole", "road"),
    ("catch basin", "road"),
    ("terrain", "ground"),
    ("sand", "ground"),
    ("snow", "ground"),
    ("rail track", "ground"),
)


def surface_codes(names: Mapping[int, str]) -> np.ndarray:
    """(most number + 1,) u8 code of every class: 0 for objects, `SKY` for the sky.

    Raises:
      ValidationError: none of the names is a road, so the model was not trained for streets.
    """
    codes = np.zeros(max(names) + 1, np.uint8)
    for number, name in names.items():
        low = name.lower().replace("-", " ").replace("_", " ")
        if low == "sky":
            codes[number] = SKY
        elif "barrier" not in low and "wall" not in low:
            kind = next((kind for word, kind in _WORDS if word in low), None)
            codes[number] = KIND_INDEX[kind] if kind is not None else 0
    if not (codes == KIND_INDEX["road"]).any():
        found = ", ".join(list(names.values())[:5])
        raise ValidationError(
            f"Mask2Former: found the classes {found} ..., needed a model of streets with a class road."
        )
    return codes
