"""`Task`: what distinguishes a task on streets from point-goal navigation, as a few functions that `NavEnv` calls.

In:   an environment's parts at construction; states of one env.
Out:  changes of its state, further endings, rewards, scores and observations.
When: inside jit, per env, at reset and in every control step.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Float, Int, Int32, Key
from ml_collections import ConfigDict

from ....crowds.crossings import Precedence
from ....crowds.crowd import Crowd
from ....datatypes import RobotSpec, SceneBank, SimState
from ....geometry import rotations
from ...types import NavState
from .. import terms
from ..dynamic import DynamicStreet
from ..surroundings import Surroundings


class Parts(NamedTuple):
    """Parts of an environment.

    Attributes:
      config: its whole configuration; `config.task` is the task's section.
      bank: the scenes.
      scenes: (n,) rows of it in use.
      robot: its robot.
      model: the robot's model without scene.
      root: id of its free body.
      surroundings: distances to hulls and edges.
      dynamic: the crowd; None in a scenario without one.
      own: what `Task.episodes` found beside the episodes.
    """

    config: ConfigDict
    bank: SceneBank
    scenes: Int32[np.ndarray, " n"]
    robot: RobotSpec
    model: mujoco.MjModel
    root: int
    surroundings: Surroundings
    dynamic: DynamicStreet | None
    own: Any = None


class RobotPose(NamedTuple):
    """Attributes: xy: (2,) m. yaw: () rad. velocity: (2,) m/s in the world frame."""

    xy: Float[Array, "2"]
    yaw: Float[Array, ""]
    velocity: Float[Array, "2"]


class Task:
    """Point-goal navigation, and base class of other tasks; every method here changes nothing.

    A task is a composition over `NavEnv`: it may change the goal and the crowd, end episodes, add terms of reward and
    observations, and count scores in its own part of the state, `NavState.task`. All values stay finite, and arrays
    keep their shapes.
    """

    #: Scores of an ended episode, see `scores`; the first one is the task's headline.
    SCORES: tuple[str, ...] = ()
    #: Word for the goal in captions.
    GOAL_NAME = "goal"

    def __init__(self, parts: Parts) -> None:
        self.parts = parts
        self.dt = float(parts.config.ctrl_dt)
        self.episode_length = int(parts.config.episode_length)

    def pose(self, sim: SimState) -> RobotPose:
        """The robot's pose and velocity in a state."""
        root = self.parts.root
        return RobotPose(sim.xpos[root, :2], rotations.yaw_of(sim.xquat[root]), sim.qvel[:2])

    @classmethod
    def furnished(cls, config: ConfigDict, bank: SceneBank, robot: RobotSpec) -> SceneBank:
        """The bank with what the task adds to the scenes of a config, before an engine and a renderer are made for it.

        Raises:
          ValidationError: the scenes have no place for it, or the task's options are out of their ranges.
        """
        del config, robot
        return bank

    @classmethod
    def episodes(
        cls, config: ConfigDict, bank: SceneBank, robot: RobotSpec, scenes: Int32[np.ndarray, " n"]
    ) -> tuple[SceneBank, Int32[np.ndarray, " n"], Any]:
        """The bank with the episode table of the task, those of the scenes (n,) that have episodes, and what the
        constructor finds in `Parts.own`.

        Raises:
          ValidationError: none of them has any.
        """
        del config, robot
        return bank, scenes, None

    @classmethod
    def street(
        cls, config: ConfigDict, bank: SceneBank, scenes: Int32[np.ndarray, " n"], robot: RobotSpec, own: Any
    ) -> DynamicStreet:
        """The moving agents of the scenario `dynamic` in scenes (n,) of a bank; own: what `episodes` found.

        Raises:
          ValidationError: `config.crowd` is not possible.
        """
        del own
        return DynamicStreet(bank, scenes, config.crowd, float(config.ctrl_dt), robot)

    def rights(self, nav: NavState) -> Precedence | None:
        """Signals at crosswalks and the robot's right of way in the step after a state; None for neither."""
        del nav
        return None

    def completed(
        self, nav: NavState, p_xy: Float[Array, "2"], distance: Float[Array, ""], driven: Float[Array, ""]
    ) -> Float[Array, ""]:
        """() m of the route completed at (2,) m, of which the largest counts.

        Args:
          nav: the state before the step with the goal after it.
          distance: () m to the goal. driven: () m.
        """
        return terms.route_completed(p_xy, nav.start, nav.waypoints, nav.route_length, distance, driven)

    def begin(self, key: Key[Array, ""], nav: NavState) -> NavState:
        """The first state of an episode; key: typed, which can be reused."""
        del key
        return nav

    def advance(self, nav: NavState, sim: SimState, crowd: Crowd | None) -> dict[str, Any]:
        """Changed fields of the state after a control step from `nav` to `sim` and `crowd`, before the end of the
        episode is decided: `task`, and where they move `goal`, `waypoints` and `route_length`."""
        del nav, sim, crowd
        return {}

    def result(self, nav: NavState, result: Int[Array, ""]) -> Int[Array, ""]:
        """() i32, how the episode ends; `result` is that of point-goal navigation, and `nav` the new state."""
        del nav
        return result

    def goal_name(self, scene: int, row: int) -> str:
        """What captions call the goal of an episode of the task's table."""
        del scene, row
        return self.GOAL_NAME

    def rewards(self, old: NavState, new: NavState) -> dict[str, Float[Array, ""]]:
        """Values of the reward terms that the task adds, by their names in `reward_config.scales`."""
        del old, new
        return {}

    def scores(self, nav: NavState) -> dict[str, Float[Array, ""]]:
        """Values of `SCORES` of an episode that ended in this state."""
        del nav
        return {}

    def holds(self, nav: NavState) -> Float[Array, ""]:
        """() 1 while the hand of a robot with a parcel holds it in the step after a state, else 0."""
        del nav
        return jnp.float32(1.0)

    def observed_goal(self, nav: NavState) -> Float[Array, "3"]:
        """(3,) m, the goal as a policy knows it."""
        return nav.goal

    def goal_observation(self, nav: NavState) -> Float[Array, " n"] | None:
        """What the observation `goal` is in place of a vector to a goal; None for that vector."""
        del nav
        return None

    def proprio(self, nav: NavState) -> Sequence[Float[Array, " n"]]:
        """Additions to the observation `proprio`, of order one."""
        del nav
        return ()

    def privileged(self, nav: NavState) -> Sequence[Float[Array, " n"]]:
        """Additions to the observation `privileged`, of order one."""
        del nav
        return ()

    def shown(self, nav: NavState) -> dict[str, Array]:
        """Values () of a state that `note` tells; none here."""
        del nav
        return {}

    def note(self, values: Mapping[str, float]) -> str:
        """Addition to the caption of a film's frame; values: of `shown`."""
        del values
        return ""
