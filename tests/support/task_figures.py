"""Figures of a task on streets: its tables, its first states, and what it makes of some steps."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from tests.support import figures
from tests.support.unicycle import one
from urbanverse_mjx.envs import NavEnv


def held(of: object) -> dict[str, Any]:
    """Arrays and records of arrays that an object keeps; not its parts that others keep too."""
    return {name: value for name, value in vars(of).items() if name not in ("parts", "config", "bank", "engine")}


def check_task(env: NavEnv, begun: Any, name: str = "") -> None:
    """Compares the figures of an environment's task with those kept.

    Args:
      begun: first states of episodes, with or without a leading axis.
      name: of the file; default: that of the task's class.
    """
    task, bank = env.task, env.bank
    nav = begun if begun.steps.ndim == 0 else one(begun, 0)
    ahead = jnp.array([[0.0, 0.0], [0.4, 0.1], [3.0, -1.0]], jnp.float32)
    goal = nav.goal[:2] - nav.sim.xpos[task.parts.root, :2]
    shifts = jnp.concatenate([ahead, goal[None]])

    around = nav.sim.xpos[task.parts.root, :2] + jnp.array([[2.0, 0.5], [-1.0, 3.0], [10.0, -4.0], [-15.0, 1.0]])

    @jax.jit
    @jax.vmap
    def after(shift: Any) -> Any:
        place = nav.sim.xpos.at[task.parts.root, :2].add(shift)
        sim = nav.sim._replace(xpos=place, qvel=nav.sim.qvel.at[:2].set(shift).at[5].set(0.2))
        crowd = nav.crowd
        if crowd is not None:  # whose agents have gone on, some of them past the robot
            turned = crowd.bodies._replace(x=crowd.bodies.x + 6.0 * shift[0], heading=crowd.bodies.heading + shift[1])
            crowd = crowd._replace(bodies=turned, anchor_x=crowd.anchor_x + 12.0 * shift[0])
        changes = {"crowd": crowd, **task.advance(nav, sim, crowd)}
        new = nav._replace(sim=sim, steps=nav.steps + 1, **changes)
        seen = {"goal": task.observed_goal(new), "told": task.goal_observation(new)}
        seen |= {"proprio": list(task.proprio(new)), "privileged": list(task.privileged(new))}
        away = jnp.linalg.norm(new.goal[:2] - place[task.parts.root, :2])
        return {
            "changes": changes, "result": task.result(new, nav.result), "rewards": task.rewards(nav, new),
            "scores": task.scores(new), "seen": seen, "shown": task.shown(new),
            "gaps": None if crowd is None or task.parts.dynamic is None else task.parts.dynamic.gaps(crowd, around),
            "completed": task.completed(new, place[task.parts.root, :2], away, nav.driven),
        }  # fmt: skip

    episodes = {key: getattr(bank, key) for key in vars(bank) if key.startswith("episode")}
    figures.check(
        f"tasks/{name or type(task).__name__}",
        {"task": held(task), "bank": episodes, "begun": begun, "after": jax.tree.map(np.asarray, after(shifts))},
        tolerance=1e-3,
    )
