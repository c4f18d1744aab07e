"""The robot that an environment's config names."""

from ml_collections import ConfigDict

from ..datatypes import RobotSpec


def make_robot(config: ConfigDict) -> RobotSpec:
    """The robot a config names: "coco", "go2", "wheelchair", or a robot.json of one's own (see `robots.load`)."""
    from .. import robots

    if config.robot == "go2":
        return robots.make_go2(config.get("menagerie") or None)
    if config.robot == "coco":
        return robots.make_coco(drive=config.drive)
    return robots.load(config.robot)
