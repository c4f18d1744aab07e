"""Stock MJX: the street as one MJX model for all envs, stepped by JAX."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from mujoco import mjx

from benchmarks.lib.peers.street import Drive, hulls_of, street_spec, with_robot
from urbanverse_mjx.datatypes import RobotSpec


class StockMjx:
    """MJX on JAX with its own collision functions.

    Attributes:
      does, hulls: see `timed.Peer`.
    """

    def __init__(self, spec: Any, robot: RobotSpec, drive: Drive, contacts: int) -> None:
        """contacts: contact points that are solved; without a limit every pair of geoms gets rows."""
        model = with_robot(spec, robot, drive.timestep, numeric={"max_contact_points": contacts})
        self.hulls = hulls_of(model)
        self.does = f"one street for all envs; {contacts} contacts solved; no observations, rewards or hits"
        self._drive, self._step = drive, 0
        device, data = mjx.put_model(model), mjx.make_data(model)
        first = jax.vmap(lambda q: data.replace(qpos=q))(jnp.asarray(drive.qpos, jnp.float32))
        self._first, self._state = first, first

        def control_step(state: Any, first: Any, begins: jax.Array, ctrl: jax.Array) -> Any:
            def chosen(new: jax.Array, old: jax.Array) -> jax.Array:
                return jnp.where(begins.reshape(-1, *[1] * (new.ndim - 1)), new, old)

            state = jax.tree.map(chosen, first, state).replace(ctrl=ctrl)
            step = jax.vmap(lambda d: mjx.step(device, d))
            return jax.lax.scan(lambda d, _: (step(d), None), state, None, length=drive.substeps)[0]

        example = (jnp.asarray(drive.begins(0)), jnp.asarray(drive.commands(0)))
        self._call = jax.jit(control_step).lower(first, first, *example).compile()

    def run(self, steps: int) -> None:
        for _ in range(steps):
            begins, ctrl = jnp.asarray(self._drive.begins(self._step)), jnp.asarray(self._drive.commands(self._step))
            self._state = self._call(self._state, self._first, begins, ctrl)
            self._step += 1
        jax.block_until_ready(self._state)

    def qpos(self) -> np.ndarray:
        return np.asarray(self._state.qpos)

    def image(self, env: int) -> np.ndarray:
        """There are none: see `plan.PEERS`."""
        raise NotImplementedError

    def close(self) -> None:
        """Nothing to end."""


def stock_mjx(folders: list[Any], robot: RobotSpec, drive: Drive, contacts: int, cut: Any = None) -> StockMjx:
    """Returns MJX in the first street, whole or cut."""
    return StockMjx(street_spec(folders[0], seen=False, cut=cut), robot, drive, contacts)
