"""Drives our robots with the graphs of published models.

In:   observations of n robots (image, goal, proprioception), and for image goals the image at the goal. Out: actions
(n, 2), waypoints as our environments take them. When: every control step, outside jit; all robots in one call of the
graph if it takes more than one at a time.
"""

import pathlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...datatypes import ValidationError
from ..onnx_agent import IMAGE, PROPRIO, open_session, run_rows
from .contracts import CONTRACTS, IMAGENET, ZooContract

#: m, the largest waypoint of our actions.
_REACH = 1.0


class ZooAgent:
    """An adapter; subclasses turn images and goal into a velocity.

    Args:
      contract: of the model.
      weights: its first graph, or the folder with all of them.
      max_speed: m/s, max_yaw_rate: rad/s, of the robot.
      period: s, of a control step.

    Raises:
      ValidationError: a file is missing or is no graph, or its inputs or outputs are not those of the contract.
    """

    #: Number of axes of the output that is driven.
    output_axes = 3

    def __init__(
        self, contract: ZooContract, weights: pathlib.Path, max_speed: float, max_yaw_rate: float, period: float
    ) -> None:
        self.contract = contract
        self.max_speed, self.max_yaw_rate, self.period = max_speed, max_yaw_rate, period
        self._goal_images: np.ndarray | None = None
        folder = weights if weights.is_dir() else weights.parent
        paths = [folder / contract.files[0] if weights.is_dir() else weights]
        paths += [folder / name for name in contract.files[1:]]
        self._sessions = [open_session(path, accelerated=True) for path in paths]
        self._paths = paths
        self._images: list[np.ndarray] = []
        self._goals: np.ndarray | None = None
        #: (n, 3) x, y (m), yaw (rad) in the frame of the episode's beginning, one for each control step.
        self._poses: list[np.ndarray] = []

    @property
    def observations(self) -> tuple[str, ...]:
        """The observations of an environment that it needs."""
        return (IMAGE, "goal", PROPRIO)

    @property
    def sees_goal(self) -> bool:
        """Whether it takes camera images at the goals."""
        return self.contract.goal == "image"

    def see_goal(self, images: np.ndarray) -> None:
        """Takes (n, H, W, 3) u8, camera images at the goals of the robots that begin next; called before `begin`."""
        self._goal_images = images

    def begin(self, count: int) -> None:
        """Forgets the images and positions of the episodes before.

        Raises:
          ValidationError: the goal is an image, and there are not as many as robots.
        """
        self._images, self._poses = [], [np.zeros((count, 3))]
        if self.sees_goal:
            images = self._goal_images
            if images is None or images.shape != (count, *self.contract.size, 3):
                shape, needed = None if images is None else images.shape, (count, *self.contract.size, 3)
                raise ValidationError(f"{self.contract.title}: found goal images of shape {shape}, needed {needed}.")
            self._goals = self._normalised(images)

    def __call__(self, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        """Actions (n, 2)."""
        # Each image is normalised once.
        self._images.append(self._normalised(obs[IMAGE][..., :3]))
        keep = (self.contract.frames - 1) * self.contract.stride + 1
        del self._images[:-keep]
        speed, turn = self._velocity(obs).T
        self._integrate(obs[PROPRIO])
        del self._poses[:-keep]
        return self._action(speed, turn)

    def _velocity(self, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        """(n, 2) m/s ahead and rad/s to the left."""
        raise NotImplementedError

    def _normalised(self, images: np.ndarray) -> np.ndarray:
        """(n, 3, H, W) f32."""
        if images.shape[1:3] != self.contract.size:
            raise ValidationError(
                f"{self.contract.title}: found images of {images.shape[1:3]}, needed {self.contract.size}."
            )
        scaled = images.astype(np.float32) / np.float32(255.0)
        if self.contract.imagenet:
            mean, deviation = (np.array(x, np.float32) for x in IMAGENET)
            scaled = (scaled - mean) / deviation
        return np.ascontiguousarray(np.moveaxis(scaled, -1, 1))

    def _history(self, values: Sequence[np.ndarray]) -> list[np.ndarray]:
        """The contract's number of values at its spacing, the oldest first; before the beginning, the first one."""
        last = len(values) - 1
        rows = [max(0, last - back * self.contract.stride) for back in reversed(range(self.contract.frames))]
        return [values[row] for row in rows]

    def _integrate(self, proprio: np.ndarray) -> None:
        """Appends the pose after a control step with the present velocities: those at its beginning."""
        x, y, yaw = self._poses[-1].T
        ahead, left, turn = proprio[:, :3].astype(np.float64).T
        middle = yaw + 0.5 * turn * self.period
        cos, sin = np.cos(middle), np.sin(middle)
        new = [x + (cos * ahead - sin * left) * self.period, y + (sin * ahead + cos * left) * self.period]
        self._poses.append(np.stack([*new, yaw + turn * self.period], -1))

    def _run(self, session: Any, inputs: Mapping[str, np.ndarray]) -> list[np.ndarray]:
        """All outputs; row by row for a graph of one robot."""
        single = any(i.shape[:1] == [1] for i in session.get_inputs())
        rows = len(next(iter(inputs.values()))) if single else None
        return run_rows(session, [o.name for o in session.get_outputs()], inputs, rows)

    def _output(self, outputs: list[np.ndarray], points: int) -> np.ndarray:
        """(n, at least `points`, at least 2): the output of waypoints, by its number of axes."""
        found = [x for x in outputs if x.ndim == self.output_axes and x.shape[1] >= points and x.shape[2] >= 2]
        if len(found) != 1:
            shapes = [x.shape for x in outputs]
            raise ValidationError(f"{self._paths[0]}: found outputs {shapes}, needed those of {self.contract.outputs}.")
        return found[0].astype(np.float64)

    def _named(self, session: Any, **axes: tuple[int, int]) -> dict[str, str]:
        """Names of a graph's inputs: by their own names, else by (number of axes, size of axis 1).

        Raises:
          ValidationError: an input is missing, or there is one more.
        """
        given, names = list(session.get_inputs()), {}
        for wanted, (ndim, size) in axes.items():
            match = [i for i in given if i.name == wanted]
            match = match or [i for i in given if len(i.shape) == ndim and (ndim < 2 or i.shape[1] in (size, None))]
            if len(match) == 1:
                names[wanted] = match[0].name
                given.remove(match[0])
        if given or len(names) < len(axes):
            shown = {i.name: i.shape for i in session.get_inputs()}
            raise ValidationError(f"{self._paths[0]}: found the inputs {shown}, needed {self.contract.inputs}.")
        return names

    def _arc(self, waypoint: np.ndarray, seconds: float) -> np.ndarray:
        """(n, 2) velocities of the arc through a waypoint (n, 2) (ahead, left) m; behind the robot it turns."""
        x, y = waypoint.T
        bearing = np.arctan2(y, x)
        # The arc's length is the chord's times the bearing divided by its sine.
        length = np.hypot(x, y) / np.sinc(np.clip(bearing, -1.5, 1.5) / np.pi)
        speed = np.where(np.abs(bearing) < np.pi / 2, length / seconds, 0.0)
        # A robot that is at its limit drives the same arc for longer.
        share = np.minimum(1.0, self.max_speed / np.maximum(speed, 1e-9))
        turn = np.where(speed > 0.0, share * 2.0 * bearing / seconds, np.sign(bearing) * self.max_yaw_rate)
        return np.stack([share * speed, turn], -1)

    def _action(self, speed: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Waypoints that the ideal PD (`robots.waypoint.pd_velocity`) turns into the velocities."""
        speed = np.clip(speed, 0.0, self.max_speed)
        turn = np.clip(turn, -self.max_yaw_rate, self.max_yaw_rate)
        horizon = max(_REACH / self.max_speed, self.period)
        bearing = np.clip(turn * horizon, -1.5, 1.5)
        ahead = speed * horizon
        # A turn on the spot is a near waypoint to that side: 1 cm ahead is less than 3 cm/s.
        near = (ahead < 0.01) & (np.abs(bearing) > 1e-3)
        ahead = np.where(near, 0.01, ahead)
        left = ahead * np.tan(bearing)
        # A waypoint beyond the range is brought nearer in its direction: the robot turns as asked and drives slower.
        share = np.minimum(1.0, 1.0 / np.maximum(np.maximum(np.abs(ahead), np.abs(left)), 1e-9))
        return np.stack([share * ahead, share * left], -1).astype(np.float32)


class _Steps(ZooAgent):
    """Models whose waypoints are steps of the robot: GNM, ViNT and NoMaD."""

    def _drive(self, waypoints: np.ndarray) -> np.ndarray:
        x, y = waypoints[:, 2, :2].T
        rate = self.contract.rate_hz
        ahead = np.abs(x) + np.abs(y) > 1e-8
        turn = np.where(ahead, np.arctan2(y, x) * rate, 0.0)
        return np.stack([np.maximum(x, 0.0) * self.max_speed, turn], -1)

    def _observed(self) -> np.ndarray:
        """(n, 3 · frames, H, W)."""
        return np.concatenate(self._history(self._images), 1)


class GoalImageAgent(_Steps):
    """GNM and ViNT."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._names = self._named(self._sessions[0], obs_img=(4, 3 * self.contract.frames), goal_img=(4, 3))

    def _velocity(self, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        values = {"obs_img": self._observed(), "goal_img": self._goals}
        outputs = self._run(self._sessions[0], {self._names[k]: x for k, x in values.items() if x is not None})
        return self._drive(self._output(outputs, 3))


#: Training steps of NoMaD's diffusion; range of its waypoints' differences, in steps (train/vint_train/data).
_DIFFUSION, _LOW, _HIGH = 10, np.array([-2.5, -4.0]), np.array([5.0, 4.0])


def cosine_alphas(steps: int = _DIFFUSION) -> np.ndarray:
    """(steps,) cumulated products of 1 - beta of the cosine schedule (Nichol and Dhariwal 2021), beta at most 0.999."""
    f = np.cos((np.arange(steps + 1) / steps + 0.008) / 1.008 * np.pi / 2) ** 2
    return np.cumprod(1.0 - np.minimum(1.0 - f[1:] / f[:-1], 0.999))


def ddpm_previous(sample: np.ndarray, noise: np.ndarray, step: int, alphas: np.ndarray, draw: np.ndarray) -> np.ndarray:
    """The sample of the step before (Ho et al. 2020, equations 7 and 15), with the clean sample clipped to [-1, 1].

    Args:
      sample, noise: of this step, and predicted for it.
      step: 0 is the last one, which adds no noise.
      alphas: see `cosine_alphas`.
      draw: standard normal numbers.
    """
    now, before = alphas[step], alphas[step - 1] if step else 1.0
    beta = 1.0 - now / before
    clean = np.clip((sample - np.sqrt(1.0 - now) * noise) / np.sqrt(now), -1.0, 1.0)
    mean = (np.sqrt(before) * beta * clean + np.sqrt(now / before) * (1.0 - before) * sample) / (1.0 - now)
    return mean + np.sqrt(beta * (1.0 - before) / (1.0 - now)) * draw


class NomadAgent(_Steps):
    """NoMaD: an encoder, and a denoiser that is called ten times."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        frames = self.contract.frames
        self._names = self._named(self._sessions[0], obs_img=(4, 3 * frames), goal_img=(4, 3), goal_mask=(1, 0))
        self._denoiser = self._named(self._sessions[1], sample=(3, 8), global_cond=(2, 256), timestep=(0, 0))
        self._alphas, self._rng = cosine_alphas(), np.random.default_rng(0)

    def begin(self, count: int) -> None:
        super().begin(count)
        self._rng = np.random.default_rng(0)

    def _velocity(self, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        seen, count = self._observed(), len(obs["goal"])
        values = {"obs_img": seen, "goal_img": self._goals, "goal_mask": np.zeros(count, np.int64)}
        condition = self._run(self._sessions[0], {self._names[k]: x for k, x in values.items() if x is not None})[0]
        sample = self._rng.normal(size=(count, 8, 2))
        for step in reversed(range(_DIFFUSION)):
            inputs = {"sample": sample.astype(np.float32), "global_cond": condition, "timestep": np.int64(step)}
            named = {self._denoiser[k]: np.asarray(x) for k, x in inputs.items()}
            names = [o.name for o in self._sessions[1].get_outputs()]
            noise = self._output(self._sessions[1].run(names, named), 8)
            sample = ddpm_previous(sample, noise, step, self._alphas, self._rng.normal(size=sample.shape))
        return self._drive(np.cumsum((sample + 1.0) / 2.0 * (_HIGH - _LOW) + _LOW, 1))


class CityWalkerAgent(ZooAgent):
    """CityWalker."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        frames = self.contract.frames
        self._names = self._named(self._sessions[0], obs=(5, frames), cord=(3, frames + 1))
        self._step = 0.5 * self.max_speed

    def _velocity(self, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        now = self._poses[-1]
        cos, sin = np.cos(now[:, 2]), np.sin(now[:, 2])
        rows = []
        for pose in self._history(self._poses):
            dx, dy = (pose - now)[:, :2].T
            rows.append(np.stack([sin * dx - cos * dy, cos * dx + sin * dy], -1))
        ahead, left = obs["goal"].astype(np.float64).T
        rows.append(np.stack([-left, ahead], -1))
        places = (np.stack(rows, 1) / self._step).astype(np.float32)
        values = {"obs": np.stack(self._history(self._images), 1), "cord": places}
        outputs = self._run(self._sessions[0], {self._names[k]: x for k, x in values.items()})
        right, ahead = self._output(outputs, 5)[:, 0, :2].T * self._step
        return self._arc(np.stack([ahead, -right], -1), 1.0)


class S2EAgent(ZooAgent):
    """S2E."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._names = self._named(self._sessions[0], obs_images=(5, self.contract.frames), goal=(2, 3))

    def _velocity(self, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        ahead, left = obs["goal"].astype(np.float64).T
        distance, bearing = np.clip(np.hypot(ahead, left), 0.1, 200.0), np.arctan2(left, ahead)
        goal = np.stack([distance / 200.0, np.cos(bearing), np.sin(bearing)], -1).astype(np.float32)
        values = {"obs_images": np.stack(self._history(self._images), 1), "goal": goal}
        outputs = self._run(self._sessions[0], {self._names[k]: x for k, x in values.items()})
        return self._arc(0.25 * self._output(outputs, 10)[:, 4, :2], 1.0)


class MimicAgent(ZooAgent):
    """MIMIC."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._names = self._named(self._sessions[0], obs=(5, self.contract.frames))

    def _velocity(self, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        outputs = self._run(self._sessions[0], {self._names["obs"]: np.stack(self._history(self._images), 1)})
        return self._arc(self._output(outputs, 15)[:, 3, :2], 1.2)


_AGENTS: dict[str, type[ZooAgent]] = {
    "gnm": GoalImageAgent,
    "vint": GoalImageAgent,
    "nomad": NomadAgent,
    "citywalker": CityWalkerAgent,
    "s2e": S2EAgent,
    "mimic": MimicAgent,
}


def zoo_agent(name: str, weights: pathlib.Path, max_speed: float, max_yaw_rate: float, period: float) -> ZooAgent:
    """The adapter of a model of `CONTRACTS`; see `ZooAgent`."""
    return _AGENTS[name](CONTRACTS[name], weights, max_speed, max_yaw_rate, period)
