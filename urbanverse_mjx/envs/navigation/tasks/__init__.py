"""Tasks on streets beside point goals: each is a `Task`, composed with `NavEnv` by the name in `config.task`."""

from ml_collections import ConfigDict

from ....datatypes import ValidationError
from .cross import CrossStreet
from .deliver import Deliver
from .drop_off import DropOff
from .follow import FollowPerson
from .multi_robot import MultiRobot
from .object_goal import ObjectGoal
from .people import PeopleTask
from .route import FollowRoute
from .social import SocialNav
from .task import Parts, Task

#: Name in `config.task.name` -> class.
TASKS: dict[str, type[Task]] = {
    "point_goal": Task,
    "social_nav": SocialNav,
    "follow_person": FollowPerson,
    "follow_route": FollowRoute,
    "cross_street": CrossStreet,
    "object_goal": ObjectGoal,
    "multi_robot": MultiRobot,
    "deliver": Deliver,
    "drop_off": DropOff,
}


def task_class(config: ConfigDict) -> type[Task]:
    """The class of a config's task; that of point-goal navigation if it names none.

    Raises:
      ValidationError: the task is unknown.
    """
    section = config.get("task", None)
    name = "point_goal" if section is None else section.name
    if name not in TASKS:
        raise ValidationError(f"config.task.name: found {name!r}, needed one of {', '.join(TASKS)}.")
    return TASKS[name]


def make_task(parts: Parts) -> Task:
    """Makes the task of a config.

    Raises:
      ValidationError: the task is unknown or does not fit the environment.
    """
    return task_class(parts.config)(parts)


__all__ = ["TASKS", "Parts", "PeopleTask", "Task", "make_task", "task_class"]
