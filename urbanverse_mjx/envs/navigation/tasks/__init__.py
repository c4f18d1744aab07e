"""Tasks on streets beside point goals: each is a `Task`, composed with `NavEnv` by the name in `config.task`."""

from ....datatypes import ValidationError
from .follow import FollowPerson
from .people import PeopleTask
from .social import SocialNav
from .task import Parts, Task

#: Name in `config.task.name` -> class.
TASKS: dict[str, type[Task]] = {
    "point_goal": Task,
    "social_nav": SocialNav,
    "follow_person": FollowPerson,
}


def make_task(parts: Parts) -> Task:
    """Makes the task of a config; point-goal navigation if it names none.

    Raises:
      ValidationError: the task is unknown or does not fit the environment.
    """
    section = parts.config.get("task", None)
    name = "point_goal" if section is None else section.name
    if name not in TASKS:
        raise ValidationError(f"config.task.name: found {name!r}, needed one of {', '.join(TASKS)}.")
    return TASKS[name](parts)


__all__ = ["TASKS", "Parts", "PeopleTask", "Task", "make_task"]
