"""Distances of a robot to people, accumulated during an episode."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from ..envs.navigation.dynamic import MAX_PEOPLE_DISTANCE


class PeopleTally(NamedTuple):
    """Sums over the control steps of each env, see `envs.navigation.dynamic.PEOPLE_METRICS`.

    Attributes:
      nearest: m, least distance to a person.
      intimate, personal: steps within these distances.
      speed: m/s, summed over the steps within personal distance.
    """

    nearest: Any
    intimate: Any
    personal: Any
    speed: Any


def no_people(number: int) -> PeopleTally:
    """The initial tally of `number` envs."""
    zero = jnp.zeros(number)
    return PeopleTally(zero + MAX_PEOPLE_DISTANCE, zero, zero, zero)


def counted(tally: PeopleTally, metrics: Mapping[str, Any]) -> PeopleTally:
    """Adds a control step of one env."""
    return PeopleTally(
        jnp.minimum(tally.nearest, metrics["people_distance"]),
        tally.intimate + metrics["intimate_time_per_step"],
        tally.personal + metrics["personal_time_per_step"],
        tally.speed + metrics["personal_speed_per_step"],
    )


def people_fields(tally: PeopleTally, steps: np.ndarray, row: int) -> dict[str, float | None]:
    """The fields of `EpisodeResult` about people; steps: (n,) of each env."""
    nearest, intimate, personal, speed = (float(np.asarray(x)[row]) for x in tally)
    return {
        "people_distance": nearest,
        "intimate_time": min(intimate / float(steps[row]), 1.0),
        "speed_near_people": speed / personal if personal else None,
    }
