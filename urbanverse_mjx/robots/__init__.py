"""Robot descriptions: MJCF, drive and gait of each robot."""

from .coco import make_coco
from .coco_arm import make_coco_arm
from .coco_parcel import make_coco_parcel
from .description import gait_of, load
from .go2 import make_go2

__all__ = ["gait_of", "load", "make_coco", "make_coco_arm", "make_coco_parcel", "make_go2"]
