"""Tasks on streets beside point goals: each is a `Task`, composed with `NavEnv` by the name in `config.task`."""

from collections.abc import Callable

from ....datatypes import ValidationError
from .task import Parts, PeopleTask, Task

#: Name in `config.task.name` -> class.
TASKS: dict[str, Callable[[Parts], Task]] = {"point_goal": Task}


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
