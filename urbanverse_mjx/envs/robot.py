"""Loads the robot of an environment's config."""

from ml_collections import ConfigDict

from ..datatypes import RobotSpec


def make_robot(config: ConfigDict) -> RobotSpec:
    """Loads the robot of a config: "coco", "coco_arm", "coco_parcel", "go2", "wheelchair", a name of
    `robots.catalogue`, or the path of a robot.json (see `robots.load`)."""
    from .. import robots

    if config.robot == "go2":
        return robots.make_go2(config.get("menagerie") or None)
    if config.robot == "coco":
        return robots.make_coco(drive=config.drive)
    if config.robot == "coco_arm":
        return robots.make_coco_arm()
    if config.robot == "coco_parcel":
        return robots.make_coco_parcel()
    return robots.load(config.robot)
