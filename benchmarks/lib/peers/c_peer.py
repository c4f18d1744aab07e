"""C MuJoCo on all cores: `mujoco.rollout`, or processes that step and draw their envs one after the other.

Nothing here imports JAX: each process that draws would pay for it.
"""

import multiprocessing
import multiprocessing.connection
import os
import pathlib
from typing import Any

import mujoco
import mujoco.rollout
import numpy as np

from benchmarks.lib.peers.street import ROBOT, SEEN, Drive, hulls_of, street_spec, with_robot
from urbanverse_mjx.datatypes import RobotSpec
from urbanverse_mjx.work_folder import work_folder

#: State of an env between control steps; the accelerations are what the solver starts from.
_STATE = mujoco.mjtState.mjSTATE_INTEGRATION
#: s that a process may take for its start, and for one run.
_TIMEOUT = 300.0


def starting_states(model: mujoco.MjModel, qpos: np.ndarray, which: int) -> np.ndarray:
    """Returns (n, size) states at rest at positions (n, nq)."""
    data = mujoco.MjData(model)
    states = np.zeros((len(qpos), mujoco.mj_stateSize(model, which)))
    for row, place in zip(states, qpos, strict=True):
        data.qpos[:] = place
        mujoco.mj_getState(model, data, row, which)
    return states


class Rollout:
    """`mujoco.rollout` with a thread per core.

    Attributes:
      does, hulls: see `timed.Peer`.
    """

    def __init__(self, folder: pathlib.Path, robot: RobotSpec, drive: Drive, cores: int) -> None:
        self._model = with_robot(street_spec(folder, seen=False), robot, drive.timestep)
        self.hulls = hulls_of(self._model)
        self.does = f"mujoco.rollout, {cores} threads; one street for all envs; no observations, rewards or hits"
        self._drive, self._step, full = drive, 0, mujoco.mjtState.mjSTATE_FULLPHYSICS
        self._first = starting_states(self._model, drive.qpos, full)
        self._state = self._first.copy()
        self._warm = np.zeros((drive.count, self._model.nv))
        self._data = [mujoco.MjData(self._model) for _ in range(cores)]
        self._pool = mujoco.rollout.Rollout(nthread=cores)

    def run(self, steps: int) -> None:
        for _ in range(steps):
            begins = self._drive.begins(self._step)
            self._state[begins] = self._first[begins]
            ctrl = np.repeat(self._drive.commands(self._step)[:, None], self._drive.substeps, 1).astype(np.float64)
            states, _ = self._pool.rollout(self._model, self._data, self._state, ctrl)
            self._state = np.ascontiguousarray(states[:, -1])
            self._step += 1

    def qpos(self) -> np.ndarray:
        return self._state[:, 1 : 1 + self._model.nq]

    def image(self, env: int) -> np.ndarray:
        """There are none: `Processes` draws."""
        raise NotImplementedError

    def close(self) -> None:
        self._pool.close()


class Processes:
    """A process per core, each with its share of the envs, and its own OpenGL where images are asked for.

    Attributes:
      does, hulls: see `timed.Peer`.
    """

    def __init__(
        self,
        folders: list[pathlib.Path],
        robot: RobotSpec,
        drive: Drive,
        size: tuple[int, int] | None,
        cores: int,
        gl: str,
    ) -> None:
        """gl: what MuJoCo draws with, "egl" or "osmesa"."""
        models = [with_robot(street_spec(f, seen=size is not None), robot, drive.timestep, size) for f in folders]
        self.hulls = max(hulls_of(model) for model in models)
        cores = min(cores, drive.count)
        streets = "one street for all envs" if len(models) == 1 else "the street of its own for each env"
        self.does = f"{cores} processes; {streets}; no observations, rewards or hits"
        if size is not None:
            self.does += f"; mujoco.Renderer by {gl}, textures, sky, no shadows"
        self._drive, self._step = drive, 0
        self._qpos = drive.qpos.copy()
        self._rows = np.array_split(np.arange(drive.count), cores)
        self._pipes: list[multiprocessing.connection.Connection] = []
        self._processes: list[Any] = []
        context = multiprocessing.get_context("spawn")
        before = os.environ.get("MUJOCO_GL")
        os.environ["MUJOCO_GL"] = "disable" if size is None else gl  # processes take it from here
        try:
            with work_folder("urbanverse-peers-") as kept:
                files = []
                for number, model in enumerate(models):
                    files.append(f"{kept}/{number}.mjb")
                    mujoco.mj_saveModel(model, files[-1])
                for rows in self._rows:
                    here, there = context.Pipe()
                    process = context.Process(
                        target=_serve, args=(there, files, ROBOT + robot.camera, drive, rows, size), daemon=True
                    )
                    process.start()
                    there.close()
                    self._pipes.append(here)
                    self._processes.append(process)
                for pipe in self._pipes:  # files are read
                    _answer(pipe)
        except BaseException:
            self.close()
            raise
        finally:
            if before is None:
                del os.environ["MUJOCO_GL"]
            else:
                os.environ["MUJOCO_GL"] = before

    def run(self, steps: int) -> None:
        for pipe in self._pipes:
            pipe.send((self._step, steps))
        for pipe, rows in zip(self._pipes, self._rows, strict=True):
            self._qpos[rows] = _answer(pipe)
        self._step += steps

    def qpos(self) -> np.ndarray:
        return self._qpos

    def image(self, env: int) -> np.ndarray:
        """Returns (height, width, 3) uint8: what the env's robot sees at its start."""
        number = next(i for i, rows in enumerate(self._rows) if env in rows)
        self._pipes[number].send(int(np.flatnonzero(self._rows[number] == env)[0]))
        return _answer(self._pipes[number])

    def close(self) -> None:
        for pipe in self._pipes:
            pipe.close()
        for process in self._processes:
            process.join(5.0)
            if process.is_alive():
                process.kill()


def _answer(pipe: multiprocessing.connection.Connection) -> Any:
    """Raises RuntimeError with what a process says when it fails, or when it is silent."""
    if not pipe.poll(_TIMEOUT):
        raise RuntimeError(f"a process gave no answer within {_TIMEOUT:g} s")
    try:
        answer = pipe.recv()
    except EOFError:
        raise RuntimeError("a process of C MuJoCo ended without an answer") from None
    if isinstance(answer, str):
        raise RuntimeError(answer)
    return answer


def _serve(pipe: Any, files: list[str], camera: str, drive: Drive, rows: np.ndarray, size: Any) -> None:
    """Answers (first step, steps) with the positions of its envs, and the number of an env with its image."""
    try:
        worker = _Worker(files, camera, drive, rows, size)
        pipe.send(np.zeros(0))
        while True:
            asked = pipe.recv()
            pipe.send(worker.image(asked) if isinstance(asked, int) else worker.run(*asked))
    except EOFError:  # the peer is closed
        return
    except Exception as error:  # each OpenGL library fails with its own
        pipe.send(f"{type(error).__name__}: {error}".strip())


class _Worker:
    """The envs of one process."""

    def __init__(self, files: list[str], camera: str, drive: Drive, rows: np.ndarray, size: Any) -> None:
        self._models = [mujoco.MjModel.from_binary_path(file) for file in files]
        self._data = [mujoco.MjData(model) for model in self._models]
        self._drive, self._rows, self._camera = drive, rows, camera
        first = [starting_states(self._models[drive.scene[i]], drive.qpos[i][None], _STATE)[0] for i in rows]
        self._first = np.array(first)
        self._states = self._first.copy()
        self._renderers = [mujoco.Renderer(model, *size) for model in self._models] if size else []
        self._option = mujoco.MjvOption()
        self._option.geomgroup[:] = 0
        self._option.geomgroup[SEEN] = 1
        for renderer in self._renderers:
            renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = 0

    def run(self, step: int, steps: int) -> np.ndarray:
        for t in range(step, step + steps):
            begins, ctrl = self._drive.begins(t), self._drive.commands(t)
            for own, env in enumerate(self._rows):
                if begins[env]:
                    self._states[own] = self._first[own]
                scene = int(self._drive.scene[env])
                model, data = self._models[scene], self._data[scene]
                mujoco.mj_setState(model, data, self._states[own], _STATE)
                data.ctrl[:] = ctrl[env]
                mujoco.mj_step(model, data, self._drive.substeps)
                mujoco.mj_getState(model, data, self._states[own], _STATE)
                if self._renderers:
                    self._draw(scene)
        return self._states[:, 1 : 1 + self._models[0].nq]

    def _draw(self, scene: int) -> np.ndarray:
        model, data, renderer = self._models[scene], self._data[scene], self._renderers[scene]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_camlight(model, data)
        renderer.update_scene(data, camera=self._camera, scene_option=self._option)
        return renderer.render()

    def image(self, own: int) -> np.ndarray:
        scene = int(self._drive.scene[self._rows[own]])
        mujoco.mj_setState(self._models[scene], self._data[scene], self._first[own], _STATE)
        return self._draw(scene)
