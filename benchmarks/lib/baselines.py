"""Other simulators on the same scene with the same robot: each row states what it includes and omits.

None of them uses different scenes per env, and none resets, so their figures do not include these costs.
"""

import dataclasses
import statistics
import time
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import mujoco.rollout
import numpy as np
from mujoco import mjx

from benchmarks.lib import timing
from benchmarks.lib.cases import Case
from benchmarks.lib.street_model import HIT, ROBOT, SEEN, street_model
from urbanverse_mjx.datatypes import RobotSpec, SceneBank
from urbanverse_mjx.settings import num_threads

#: Scene of the bank for all baselines.
SCENE = 0
#: MJX compiles a collision function for every distinct mesh (docs/sources/measured.md: 256 take 54 s), so its scene is
#: cut.
MJX_HULLS, MJX_PRISMS = 48, 8
#: Contacts that MJX solves, as many as the product's own engine; without it every pair of geoms gets rows.
MJX_CONTACTS = 12
#: Room for contacts and constraint rows per world in MuJoCo Warp: twice the measured maximum.
WARP_CONTACTS, WARP_ROWS = 64, 256
#: Largest number of envs per core for C MuJoCo, and number of frames; its rates do not grow beyond.
ENVS_PER_CORE, FRAMES = 64, 40


@dataclasses.dataclass(frozen=True)
class Drive:
    """The common steps of all baselines.

    Attributes:
      bank, robot: the scene is row `SCENE`.
      size: height and width of frames, None without.
      timestep: s.
      substeps: per control step.
      qpos: (n, nq) starts.
      ctrl: (T, n, nu) commands.
    """

    bank: SceneBank
    robot: RobotSpec
    size: tuple[int, int] | None
    timestep: float
    substeps: int
    qpos: np.ndarray
    ctrl: np.ndarray

    @property
    def count(self) -> int:
        """Returns the env-steps of one run."""
        return self.ctrl.shape[0] * self.ctrl.shape[1]

    def model(self, **options: Any) -> mujoco.MjModel:
        options = {"size": self.size, **options} if self.size else options
        return street_model(self.bank, SCENE, self.robot, self.timestep, **options)


def make_drive(env: Any, case: Case) -> Drive:
    """Returns a drive of the case's number of robots from starts of the scene, forward with random turns."""
    bank, robot = env.bank, env.robot
    rows = np.arange(case.num_envs) % int(bank.num_episodes[SCENE])
    start = bank.episode_start[SCENE, rows]
    qpos = np.tile(env.mj_model.qpos0, (case.num_envs, 1))
    qpos[:, :3] = start[:, :3] + (0.0, 0.0, robot.spawn_height)
    qpos[:, 3], qpos[:, 4:6], qpos[:, 6] = np.cos(start[:, 3] / 2), 0.0, np.sin(start[:, 3] / 2)
    rng = np.random.default_rng(case.seed)
    waypoint = rng.uniform(-1, 1, (case.steps, case.num_envs, 2)).astype(np.float32)
    waypoint[..., 0] = 0.5 + 0.5 * waypoint[..., 0]
    velocity = jax.vmap(jax.vmap(lambda w: robot.command(jnp.stack(robot.waypoint_to_velocity(w, env.dt)))))
    return Drive(bank, robot, case.size, env.sim_dt, env.n_substeps, qpos, np.asarray(velocity(waypoint)))


def _row(drive: Drive, seconds: float, does: str, **more: Any) -> dict[str, Any]:
    """Returns the figures of one run of all env-steps."""
    rate = drive.count / seconds
    return {"physics_steps_per_s": rate * drive.substeps, "does": does, **more}


def stock_mjx(drive: Drive, repeats: int) -> dict[str, Any]:
    """Measures MJX-JAX with the scene cut around one start, where all robots begin."""
    start = drive.bank.episode_start[SCENE, 0, :2]
    limits = {"max_contact_points": MJX_CONTACTS}
    model = drive.model(near=start, hulls=MJX_HULLS, prisms=MJX_PRISMS, numeric=limits)
    device, data = mjx.put_model(model), mjx.make_data(model)
    qpos = jnp.tile(jnp.asarray(drive.qpos[0], jnp.float32), (len(drive.qpos), 1))
    ctrl = jnp.asarray(drive.ctrl)
    state = jax.vmap(lambda q: data.replace(qpos=q))(qpos)

    def control_step(state: Any, ctrl: Any) -> tuple[Any, None]:
        state = jax.vmap(lambda d, u: d.replace(ctrl=u))(state, ctrl)
        step = jax.vmap(lambda d: mjx.step(device, d))
        return jax.lax.scan(lambda d, _: (step(d), None), state, None, length=drive.substeps)[0], None

    run = timing.compile_(lambda s, u: jax.lax.scan(control_step, s, u)[0].qpos, state, ctrl)
    sample = timing.time_(run.call, state, ctrl, repeats=repeats)
    does = f"one scene for all, cut to {MJX_HULLS} hulls and {MJX_PRISMS} ground prisms around one start; no RGB"
    return _row(drive, sample.median, does, hulls=MJX_HULLS, compile_s=run.seconds)


def direct_warp(drive: Drive, repeats: int) -> dict[str, Any]:
    """Measures MuJoCo Warp called from Python without JAX, with its renderer if frames are requested."""
    import mujoco_warp as mjw
    import warp as wp

    begin = time.perf_counter()
    model = drive.model(seen=drive.size is not None)
    count = len(drive.qpos)
    device, data = mjw.put_model(model), mjw.make_data(model, nworld=count, nconmax=WARP_CONTACTS, njmax=WARP_ROWS)
    qpos, ctrl = wp.array(drive.qpos, dtype=float), [wp.array(u, dtype=float) for u in drive.ctrl]
    context = None if drive.size is None else _warp_context(mjw, model, count, drive.size)

    def physics() -> None:
        for _ in range(drive.substeps):
            mjw.step(device, data)

    def draw() -> None:
        mjw.refit_bvh(device, data, context)
        mjw.render(device, data, context)

    calls = {"physics": physics, **({"render": draw} if context is not None else {})}
    for call in calls.values():  # kernels are loaded outside of a capture
        call()
    ready = _captured(wp, calls) if wp.get_device().is_cuda else calls
    wp.synchronize()
    compile_s = time.perf_counter() - begin

    def run(*names: str) -> float:
        wp.copy(data.qpos, qpos)
        data.qvel.zero_()
        wp.synchronize()
        start = time.perf_counter()
        for u in ctrl:
            wp.copy(data.ctrl, u)
            for name in names:
                ready[name]()
        wp.synchronize()
        return time.perf_counter() - start

    seconds = statistics.median(run("physics") for _ in range(repeats))
    does = "one scene for all; hits, observations and rewards are not computed"
    found = _row(drive, seconds, does, hulls=_hulls(drive), compile_s=compile_s)
    if context is not None:
        both = statistics.median(run("physics", "render") for _ in range(repeats))
        found |= {"env_steps_per_s": drive.count / both, "frames_per_s": drive.count / max(both - seconds, 1e-9)}
        found["does"] = f"{does}; stock renderer, packed RGB, textures, no shadows, no sky"
    return found


def _warp_context(mjw: Any, model: mujoco.MjModel, count: int, size: tuple[int, int]) -> Any:
    return mjw.create_render_context(
        model, nworld=count, cam_res=(size[1], size[0]), render_rgb=True, render_depth=False, enabled_geom_groups=[SEEN]
    )


def _captured(wp: Any, calls: dict[str, Callable[[], None]]) -> dict[str, Callable[[], None]]:
    """Returns the same launches as CUDA graphs."""
    graphs = {}
    for name, call in calls.items():
        with wp.ScopedCapture() as capture:
            call()
        graphs[name] = lambda graph=capture.graph: wp.capture_launch(graph)
    return graphs


def c_mujoco(drive: Drive, repeats: int) -> dict[str, Any]:
    """Measures C MuJoCo: `mujoco.rollout` on all cores, and its renderer for one robot after the other."""
    cores = num_threads()
    begin = time.perf_counter()
    model = drive.model(seen=drive.size is not None)
    compile_s = time.perf_counter() - begin
    count = min(len(drive.qpos), ENVS_PER_CORE * cores)
    data = [mujoco.MjData(model) for _ in range(cores)]
    states = np.stack([_full_state(model, data[0], q) for q in drive.qpos[:count]])
    ctrl = np.repeat(np.swapaxes(drive.ctrl[:, :count], 0, 1), drive.substeps, 1).astype(np.float64)
    with mujoco.rollout.Rollout(nthread=cores) as pool:
        seconds = []
        for _ in range(repeats + 1):  # the first one starts the threads
            start = time.perf_counter()
            pool.rollout(model, data, states, ctrl)
            seconds.append(time.perf_counter() - start)
    part = dataclasses.replace(drive, qpos=drive.qpos[:count], ctrl=drive.ctrl[:, :count])
    does = f"one scene for all, {count} envs on {cores} cores; hits, observations and rewards are not computed"
    found = _row(part, statistics.median(seconds[1:]), does, hulls=_hulls(drive), compile_s=compile_s)
    if drive.size is not None:
        found |= _c_frames(model, data[0], drive, found, does)
    return found


def _full_state(model: mujoco.MjModel, data: mujoco.MjData, qpos: np.ndarray) -> np.ndarray:
    state = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_resetData(model, data)
    data.qpos[:] = qpos
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    return state


def _c_frames(
    model: mujoco.MjModel, data: mujoco.MjData, drive: Drive, found: dict[str, Any], does: str
) -> dict[str, Any]:
    """Measures frames/s of MuJoCo's renderer, and env-steps/s with every step rendered; reports a missing OpenGL."""
    assert drive.size is not None
    option = mujoco.MjvOption()
    option.geomgroup[:] = 0
    option.geomgroup[SEEN] = 1
    option.geomgroup[HIT] = 0
    try:
        with mujoco.Renderer(model, *drive.size) as renderer:
            seconds = []
            for i in range(FRAMES):
                data.qpos[:] = drive.qpos[i % len(drive.qpos)]
                mujoco.mj_forward(model, data)
                start = time.perf_counter()
                renderer.update_scene(data, camera=ROBOT + drive.robot.camera, scene_option=option)
                renderer.render()
                seconds.append(time.perf_counter() - start)
    except Exception as error:  # each OpenGL library fails with its own
        return {"does": f"{does}; no RGB, for its renderer found no OpenGL here ({type(error).__name__}: {error})"}
    rate = 1.0 / statistics.median(seconds[FRAMES // 4 :])
    physics = found["physics_steps_per_s"] / drive.substeps
    together = 1.0 / (1.0 / rate + 1.0 / physics)
    remark = f"{does}; OpenGL renderer, one frame after the other"
    return {"frames_per_s": rate, "env_steps_per_s": together, "does": remark}


def _hulls(drive: Drive) -> int:
    return int((drive.bank.inst_hull[SCENE] >= 0).sum())


BASELINES: dict[str, Callable[[Drive, int], dict[str, Any]]] = {
    "mjx": stock_mjx,
    "warp": direct_warp,
    "c": c_mujoco,
}


def measure(name: str, env: Any, case: Case) -> dict[str, Any]:
    """Returns the row of one baseline for a case."""
    row = BASELINES[name](make_drive(env, case), case.repeats)
    return {"rival": {"mjx": "stock MJX", "warp": "MuJoCo Warp, no JAX", "c": "C MuJoCo, mujoco.rollout"}[name], **row}
