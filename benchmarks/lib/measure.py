"""Measurements of one configuration: the whole step, its parts, the most expensive physics, the policy, the
training."""

import concurrent.futures
import dataclasses
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.lib import placing, timing
from benchmarks.lib.cases import Case
from urbanverse_mjx.envs import registry, wrap_for_training
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.work_folder import work_folder


@dataclasses.dataclass
class Run:
    """An environment under measurement and its compiled functions.

    Attributes:
      env, case: of the measurement.
      batch: its auto-resetting batch.
      first: states after a reset.
      actions: (T, n, action) of an untrained policy that drives forward.
      state: states in the middle of episodes.
      sims: the engine's states up to there, (T, n, ...).
    """

    env: Any
    case: Case
    batch: Any = None
    first: Any = None
    actions: Any = None
    state: Any = None
    sims: Any = None
    compile_s: dict[str, float] = dataclasses.field(default_factory=dict)

    def compile_(self, name: str, function: Callable[..., Any], *arguments: Any) -> Callable[..., Any]:
        done = timing.compile_(function, *arguments)
        self.compile_s[name] = done.seconds
        return done.call


def start(env: Any, case: Case) -> Run:
    """Resets the environments; compiles only the reset."""
    run = Run(env, case, wrap_for_training(env, env.config.episode_length))
    keys = jax.random.split(jax.random.key(case.seed), case.num_envs)
    run.first = run.compile_("reset", run.batch.reset, keys)(keys)
    # Forward with a random turn: the motion of an untrained policy, so that episodes also end by hits.
    shape = (case.steps, case.num_envs, env.action_size)
    actions = jax.random.uniform(jax.random.key(case.seed + 1), shape, minval=-1.0, maxval=1.0)
    run.actions = actions.at[..., 0].set(0.5 + 0.5 * actions[..., 0])
    return run


def command(env: Any, waypoint: jax.Array) -> jax.Array:
    """(nu,) actuator commands towards a waypoint (2,) m in the body frame."""
    return env.robot.command(jnp.stack(env.robot.waypoint_to_velocity(waypoint, env.dt)))


def drive_with(engine: Any) -> Callable[..., Any]:
    """A function (states, commands (T, n, nu)) -> (states, (T, n) bool hit) that runs the physics alone."""

    def drive(sim: Any, ctrl: Any) -> tuple[Any, Any]:
        return jax.lax.scan(lambda s, u: ((new := jax.vmap(engine.step)(s, u)), new.contacts.hit), sim, ctrl)

    return drive


def draw_with(renderer: Any) -> Callable[..., Any]:
    """A function of states (T, n, ...) that draws each of them once."""

    def draw(sims: Any) -> Any:
        def frame(total: Any, sim: Any) -> tuple[Any, None]:
            pixels = jax.vmap(renderer)(sim.scene, sim.xpos, sim.xquat)["rgb"]
            # A sum over a few pixels prevents the compiler from removing the frame, at no cost.
            return total + pixels[:, 0, 0].astype(jnp.float32).sum(), None

        return jax.lax.scan(frame, jnp.float32(0.0), sims)[0]

    return draw


def step(run: Run) -> tuple[dict[str, Any], Callable[[], Any]]:
    """Env-steps/s with auto-reset as in PPO, and the function to time them again."""

    def whole(state: Any, actions: Any) -> tuple[Any, Any]:
        def one(s: Any, a: Any) -> tuple[Any, Any]:
            new = run.batch.step(s, a)
            return new, (new.data.sim, new.done, new.metrics["slot_overflow"])

        return jax.lax.scan(one, state, actions)

    call = run.compile_("step", whole, run.first, run.actions)
    # The first call advances past the states in which all robots stand at their starts.
    (run.state, (run.sims, _, _)), first = timing.first_call(call, run.first, run.actions)
    _, (_, done, overflow) = call(run.state, run.actions)
    sample = timing.time_(call, run.state, run.actions, repeats=run.case.repeats)
    count = run.case.steps * run.case.num_envs
    figures = {
        "env_steps_per_s": sample.rate(count),
        "env_steps_per_s_spread": sample.spread,
        "first_call_s": first,
        "ended_share": float(done.mean()),
        "slot_overflow": float(overflow.max()),
        "slot_overflow_share": float((overflow > 0).mean()),
    }
    return figures, lambda: call(run.state, run.actions)


def parts(run: Run, whole: Callable[[], Any]) -> dict[str, Any]:
    """Seconds of a step and of its parts, each run alone over the same states, by turns."""
    env, steps = run.env, run.case.steps
    ctrl = jax.vmap(jax.vmap(lambda waypoint: command(env, waypoint)))(run.actions[..., :2])
    keys = jax.random.split(jax.random.key(run.case.seed + 2), (steps, run.case.num_envs))

    def begin(keys: Any) -> Any:
        return jax.lax.scan(lambda _, k: (jax.vmap(env.begin)(k), None), jax.vmap(env.begin)(keys[0]), keys)[0]

    sim = run.state.data.sim
    physics = run.compile_("physics", drive_with(env.engine), sim, ctrl)
    reset = run.compile_("begin", begin, keys)
    calls = {"total": whole, "physics": lambda: physics(sim, ctrl), "reset": lambda: reset(keys)}
    if env.renderer is not None:
        frames = run.compile_("render", draw_with(env.renderer), run.sims)
        calls["render"] = lambda: frames(run.sims)
    samples = timing.time_in_turn(calls, run.case.repeats)
    seconds = {name: sample.median / steps for name, sample in samples.items()}
    seconds["rest"] = 2 * seconds["total"] - sum(seconds.values())
    return {
        "seconds_per_step": seconds,
        "seconds_per_step_spread": {name: sample.spread for name, sample in samples.items()},
        "share": {name: s / seconds["total"] for name, s in seconds.items() if name != "total"},
        "physics_steps_per_s": samples["physics"].rate(steps * env.n_substeps * run.case.num_envs),
        **({"frames_per_s": samples["render"].rate(steps * run.case.num_envs)} if "render" in samples else {}),
    }


def refit(run: Run) -> dict[str, Any]:
    """Measures the cost of a frame without its pixels: a renderer of one pixel also places objects and refits search
    trees."""
    from urbanverse_mjx.simulation.rendering.renderer import Renderer

    env, view = run.env, run.env.config.vision_config
    options = {"shadows": view.shadows, "sky": view.sky, "shading": view.shading, "light": view.get("light", "direct")}
    small = Renderer(env.bank, env.robot, 1, 1, **options)
    call = run.compile_("refit", draw_with(small), run.sims)
    sample = timing.time_(call, run.sims, repeats=run.case.repeats)
    return {"seconds_per_step": sample.median / run.case.steps, "spread": sample.spread}


def active(run: Run) -> dict[str, Any]:
    """Measures physics alone with robots driven into the nearest object, and the same robot without hull slots."""
    env, steps, num_envs = run.env, run.case.steps, run.case.num_envs
    config, robot = env.config, env.robot
    poses = placing.crowded_poses(env.bank, robot, num_envs, config.ctrl_dt)
    qpos = np.tile(env.qpos0, (num_envs, 1))
    qpos[:, :3] = poses.position + np.array([0.0, 0.0, robot.spawn_height])
    qpos[:, 3:7] = rotations.from_yaw(poses.yaw)
    ahead = command(env, jnp.array([1.0, 0.0]))
    ctrl = jnp.broadcast_to(ahead, (steps, num_envs, *ahead.shape))
    without = registry.with_overrides(config, {"num_slots": 0, "vision": False})
    bare = registry.load_nav_env(run.case.env, without, env.bank).engine
    place = (jnp.asarray(poses.scene), jnp.asarray(qpos), jnp.zeros((num_envs, env.mj_model.nv)))
    engines = {"active": env.engine, "bare": bare}
    first = {name: jax.jit(jax.vmap(engine.init))(*place) for name, engine in engines.items()}
    calls = {n: run.compile_(f"physics_{n}", drive_with(e), first[n], ctrl) for n, e in engines.items()}
    # Drive up to the obstacle first: the timed part is spent pushing against it.
    pushing = {name: call(first[name], ctrl)[0] for name, call in calls.items()}
    samples = timing.time_in_turn(
        {name: lambda name=name: calls[name](pushing[name], ctrl) for name in calls}, run.case.repeats
    )
    count = steps * env.n_substeps * num_envs
    return {
        "physics_steps_per_s": samples["active"].rate(count),
        "physics_steps_per_s_spread": samples["active"].spread,
        "no_slots_physics_steps_per_s": samples["bare"].rate(count),
        "cost_ratio_to_no_slots": samples["active"].median / samples["bare"].median,
        "num_slots": int(config.num_slots),
        "hulls_in_reach_at_start": float(poses.in_reach.mean()),
        "share_of_envs_in_contact": float(np.asarray(calls["active"](pushing["active"], ctrl)[1]).mean()),
    }


def ppo_config(case: Case) -> Any:
    """Returns the preset's training config with the case's envs and the steps of `iterations`, with one checkpoint at
    the end."""
    from urbanverse_mjx.training.config import default_ppo_config

    sizes = {"num_envs": case.num_envs, "num_checkpoints": 1, "seed": case.seed, **case.ppo}
    config = registry.with_overrides(default_ppo_config(case.preset, case.env), sizes)
    total = case.iterations * config.unroll_length * case.num_envs
    return registry.with_overrides(config, {"num_timesteps": total})


def policy(run: Run) -> dict[str, Any]:
    """The policy's network over a batch of observations, and env-steps/s with it in the loop."""
    from urbanverse_mjx.training.policy import initial_params, make_policy_function

    env, config = run.env, ppo_config(run.case)
    sizes = {name: tuple(x.shape[1:]) for name, x in run.first.obs.items()}
    params = initial_params(sizes, env.action_size, config, run.case.seed)

    def act(params: Any, obs: Any, key: Any) -> Any:
        return make_policy_function(sizes, env.action_size, config, params, deterministic=False)(obs, key)

    def rollout(params: Any, state: Any, keys: Any) -> Any:
        return jax.lax.scan(lambda s, k: (run.batch.step(s, act(params, s.obs, k)), None), state, keys)[0]

    state = run.state if run.state is not None else run.first
    keys = jax.random.split(jax.random.key(run.case.seed + 3), run.case.steps)
    alone = run.compile_("inference", act, params, state.obs, keys[0])
    together = run.compile_("rollout", rollout, params, state, keys)
    seconds = timing.time_(alone, params, state.obs, keys[0], repeats=run.case.repeats)
    sample = timing.time_(together, params, state, keys, repeats=run.case.repeats)
    return {
        "inference_s": seconds.median,
        "env_steps_per_s_with_policy": sample.rate(run.case.steps * run.case.num_envs),
        "env_steps_per_s_with_policy_spread": sample.spread,
    }


def learn(case: Case, env: Any) -> dict[str, Any]:
    """Measures env-steps/s of the package's training (rollout, updates, logging), without compilation.

    Of a preset in stages (`best`) the two with images are measured, one after the other, under their names.
    """
    if "teacher" in registry.get_ppo_config(case.env, case.preset):
        return _learn_in_stages(case, env)
    from urbanverse_mjx.training.run import train

    config = ppo_config(case)
    with work_folder("urbanverse-throughput-") as folder:
        result = train(case.env, env, config, Path(folder) / "run", quiet=True)
    return {
        "env_steps_per_s": result.steps_per_second,
        "steps": result.steps,
        "seconds": result.seconds,
        "compile_s": result.seconds - result.steps / result.steps_per_second if result.steps_per_second else None,
        **{name: config[name] for name in ("unroll_length", "num_updates_per_batch", "minibatch")},
    }


def _learn_in_stages(case: Case, env: Any) -> dict[str, Any]:
    """Rates of imitation and of the PPO after it. The teacher's weights are random, which changes no cost of a step."""
    from urbanverse_mjx.training.policy import initial_params
    from urbanverse_mjx.training.teacher_student import TeacherStudent

    sizes = {"num_envs": case.num_envs, "seed": case.seed, **case.ppo}
    config = registry.with_overrides(registry.get_ppo_config(case.env, case.preset), sizes)
    with work_folder("urbanverse-throughput-") as folder:
        training = TeacherStudent(case.env, env, lambda: env, config, Path(folder))
        shapes = {name: tuple(shape) for name, shape in env.observation_size.items()}
        _, teacher, _ = initial_params(shapes, env.action_size, training.teacher_config(), case.seed)
        stages = {"imitation": training.imitation(teacher), "finetune": training.finetuning(teacher)}
    student = jax.eval_shape(stages["imitation"].begin).params
    begin = time.monotonic()
    # Together: compilation takes minutes, most of it on one core each.
    with concurrent.futures.ThreadPoolExecutor() as pool:
        list(pool.map(lambda learner: learner.compile(student), stages.values()))
    found: dict[str, Any] = {"compile_s": time.monotonic() - begin}
    actor = None
    for name, learner in stages.items():
        state = learner.begin(actor)
        times = []
        # The first iteration moves data and is not counted.
        for number in range(case.iterations + 1):
            start = time.monotonic()
            state, reported = learner.iterate(state, jnp.float32(number / (case.iterations + 1)))
            jax.block_until_ready((state, reported))
            times.append(time.monotonic() - start)
        actor = jax.device_get(learner.actor(state))
        del state
        seconds = statistics.median(times[1:])
        found[name] = {
            "env_steps_per_s": learner.steps_per_iteration / seconds,
            "env_steps_per_s_spread": (max(times[1:]) - min(times[1:])) / seconds,
            "steps": learner.steps_per_iteration,
        }
    return found
