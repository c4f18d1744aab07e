"""Maps KITTI-360's classes (Liao, Xie, Geiger 2022; ids of its label images and box files) to labels and surfaces."""

import dataclasses

from ...datatypes import KIND_INDEX
from ...datatypes.recording import SKY


@dataclasses.dataclass(frozen=True)
class Kitti360Class:
    """One class.

    Attributes:
      name, id: as label images have them.
      box_id: its number in the 3D boxes' files, -1 = none.
      label: leaf of the ontology for its instances; None if its instances are not objects.
      surface: code in a recording's surface images; 0 if it is neither ground nor sky.
    """

    name: str
    id: int
    box_id: int
    label: str | None = None
    surface: int = 0


CLASSES = (
    Kitti360Class("ground", 6, -1, surface=KIND_INDEX["ground"]),
    Kitti360Class("road", 7, 1, surface=KIND_INDEX["road"]),
    Kitti360Class("sidewalk", 8, 3, surface=KIND_INDEX["sidewalk"]),
    Kitti360Class("parking", 9, 2, surface=KIND_INDEX["road"]),
    Kitti360Class("rail track", 10, 10, surface=KIND_INDEX["ground"]),
    Kitti360Class("building", 11, 11, "house"),
    Kitti360Class("wall", 12, 7),
    Kitti360Class("fence", 13, 8),
    Kitti360Class("guard rail", 14, 30),
    Kitti360Class("bridge", 15, 31),
    Kitti360Class("tunnel", 16, 32),
    Kitti360Class("pole", 17, 21, "utility pole"),
    Kitti360Class("traffic light", 19, 23, "traffic light"),
    Kitti360Class("traffic sign", 20, 24, "traffic sign"),
    Kitti360Class("vegetation", 21, 5),
    Kitti360Class("terrain", 22, 4, surface=KIND_INDEX["ground"]),
    Kitti360Class("sky", 23, 9, surface=SKY),
    Kitti360Class("person", 24, 19, "pedestrian adult"),
    Kitti360Class("rider", 25, 20, "cyclist"),
    Kitti360Class("car", 26, 13, "car"),
    Kitti360Class("truck", 27, 14, "truck"),
    Kitti360Class("bus", 28, 34, "bus"),
    Kitti360Class("caravan", 29, 16, "caravan"),
    Kitti360Class("trailer", 30, 15, "trailer"),
    Kitti360Class("train", 31, 33),
    Kitti360Class("motorcycle", 32, 17, "motorcycle"),
    Kitti360Class("bicycle", 33, 18, "bicycle"),
    Kitti360Class("garage", 34, 12, "garage"),
    Kitti360Class("gate", 35, 6),
    Kitti360Class("stop", 36, 29, "bus shelter"),
    Kitti360Class("smallpole", 37, 22, "bollard"),
    Kitti360Class("lamp", 38, 25, "street light"),
    Kitti360Class("trash bin", 39, 26, "trash bin"),
    Kitti360Class("vending machine", 40, 27, "vending machine"),
    Kitti360Class("box", 41, 28, "street cabinet"),
    Kitti360Class("unknown construction", 42, 35),
    Kitti360Class("unknown vehicle", 43, 36),
    Kitti360Class("unknown object", 44, 37),
)
BY_ID = {c.id: c for c in CLASSES}
BY_BOX_ID = {c.box_id: c for c in CLASSES if c.box_id >= 0}
#: A pixel of an instance image is `INSTANCES` times its class id plus the instance's number; number 0 is no single
#: instance.
INSTANCES = 1000


def object_id(kind: Kitti360Class, instance: int) -> str:
    """Identifier of an instance, the same in images and boxes."""
    return f"{kind.name.replace(' ', '_')}_{instance}"
