"""Camera images at goals, for policies whose goal is an image.

In:   an environment with a renderer, states at the beginning of episodes. Out: images. When: once per batch of
episodes.
"""

import jax
import jax.numpy as jnp
import numpy as np

from .. import table_arguments
from ..datatypes import ValidationError
from ..envs import NavEnv, NavState
from ..geometry import rotations

IMAGE = "pixels/front"


def at_goal(nav: NavState, root: int) -> NavState:
    """A state with the robot at its goal, in the direction in which the route arrives there.

    Args:
      root: of the robot's bodies.
    """
    last = nav.num_waypoints - 1
    before = jnp.where(last > 0, nav.waypoints[jnp.maximum(last - 1, 0)][:2], nav.start[:2])
    dx, dy = nav.goal[:2] - before
    xpos, xquat = nav.sim.xpos, nav.sim.xquat
    turn = jnp.arctan2(dy, dx) - rotations.yaw_of(xquat[root])
    cos, sin = jnp.cos(turn), jnp.sin(turn)
    x, y, z = (xpos - xpos[root]).T
    here = jnp.concatenate([nav.goal[:2], (nav.goal[2] + xpos[root, 2] - nav.start[2])[None]])
    moved = jnp.stack([cos * x - sin * y, sin * x + cos * y, z], -1) + here
    turned = rotations.product(jnp.broadcast_to(rotations.from_yaw(turn), xquat.shape), xquat)
    # Body 0 is the world.
    sim = nav.sim._replace(xpos=moved.at[0].set(xpos[0]), xquat=turned.at[0].set(xquat[0]))
    return nav._replace(sim=sim)


def goal_images(env: NavEnv, nav: NavState) -> np.ndarray:
    """(n, H, W, 3) u8, what the robots' cameras see at the goals.

    Args:
      nav: states of n robots at the beginning of their episodes.

    Raises:
      ValidationError: the environment has no images.
    """
    if env.renderer is None:
        raise ValidationError("goal images: found an environment without images, needed config.vision.")
    root = env.mj_model.body(env.robot.root_body).id
    seen = table_arguments.jit(jax.vmap(lambda one: env.observe(at_goal(one, root))[IMAGE]))
    return np.asarray(seen(nav))[..., :3]
