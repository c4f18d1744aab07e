"""Differences of `benchmarks.transfer` between the simulator that policies were trained in and the one that tests them.

`Shifts` says which of it, within which ranges; `Shifts.draw` draws the `Conditions` of one episode; `Lens`,
`Exposure`, `Odometry`, `Dropouts` and `DelayLine` apply them. Nothing here knows MuJoCo.
"""

import collections
import dataclasses
import math
from typing import Any

import numpy as np

from urbanverse_mjx import srgb
from urbanverse_mjx.datatypes import validation as v

Range = tuple[float, float]


@dataclasses.dataclass(frozen=True)
class Shifts:
    """Shifts of a test; every default is no shift. Ranges (low, high) are drawn uniformly for each episode.

    Where no source is named the number is our choice, large enough to matter and small enough for a robot that is
    still worth sending out.

    Attributes:
      contact: another contact model of MuJoCo: elliptic cones with an impedance ratio of 10, `solref` (0.04, 1) in
        place of (0.02, 1), `solimp` (0.8, 0.9, 0.003) in place of (0.9, 0.95, 0.001), integrator implicitfast, and
        steps of 4 ms (COCO 10 ms, Go2 5 ms otherwise; MuJoCo's documentation, "Solver parameters").
      renderer: MuJoCo's own OpenGL renderer with shadow maps and fog, in place of ours.
      latency: s between what the sensors saw and the moment at which the command that follows from it is obeyed. 0.05
        to 0.25: camera, network, inference and base of small robots together.
      dropped: probability that an image is lost, after which the policy sees the one before it again; a lost image is
        followed by another lost one with probability `BURST`.
      distortion: factor of the radial and tangential coefficients `BROWN` (OpenCV's k1, k2, p1, p2); 1: a wide lens
        that nobody rectified.
      fisheye: an equidistant lens (r = f theta) with the camera's vertical field of view and square pixels, not
        rectified, in place of a pinhole.
      exposure: EV, powers of two by which the camera is exposed too long, in linear light, clipped at white.
      noise: standard deviation of the pixels, of 1.
      drift: standard deviation of the error of odometry's scale, as a share of the distance. 0.02: wheel odometry after
        calibration.
      turn: rad/m, standard deviation of a steady error of odometry's heading; wander: rad/sqrt(m), of a random walk
        beside it.
      slope: rad, by which the whole place is tilted, in a random direction. It is gravity that is turned, so the camera
        sees the same street. 0.07: 7 %, between the 5 % that pavements are built with and the 8.3 % of ramps (ADA
        Standards 403.3, 405.2).
      grip: friction of tyres and feet on the ground as a share of the nominal one. 0.3 to 0.6: wet leaves to wet
        paving.
      battery: voltage as a share of the nominal one: wheels have this share of their no-load speed and of their torque
        at a given speed error, legs this share of their largest torque.
    """

    contact: bool = False
    renderer: bool = False
    latency: Range = (0.0, 0.0)
    dropped: float = 0.0
    distortion: float = 0.0
    fisheye: bool = False
    exposure: Range = (0.0, 0.0)
    noise: float = 0.0
    drift: float = 0.0
    turn: float = 0.0
    wander: float = 0.0
    slope: Range = (0.0, 0.0)
    grip: Range = (1.0, 1.0)
    battery: Range = (1.0, 1.0)

    def __post_init__(self) -> None:
        for name in ("contact", "renderer", "fisheye"):
            if not isinstance(getattr(self, name), bool):
                raise v.fail(f"shifts.{name}", v.show(getattr(self, name)), "true or false")
        for name in ("dropped", "distortion", "noise", "drift", "turn", "wander"):
            v.number(getattr(self, name), f"shifts.{name}", 0.0, 0.9 if name == "dropped" else 10.0)
        for name, most in (("latency", 2.0), ("slope", 0.5), ("grip", 10.0), ("battery", 10.0)):
            low, high = self._range(name)
            v.number(low, f"shifts.{name}[0]", 0.0 if name in ("latency", "slope") else 0.01, most)
            v.number(high, f"shifts.{name}[1]", low, most)
        low, high = self._range("exposure")
        v.number(low, "shifts.exposure[0]", -8.0, 8.0)
        v.number(high, "shifts.exposure[1]", low, 8.0)
        if self.fisheye and self.distortion:
            raise v.fail("shifts", "fisheye and distortion", "one lens", "leave one of them out")

    def _range(self, name: str) -> Range:
        value = getattr(self, name)
        if not isinstance(value, tuple | list) or len(value) != 2:
            raise v.fail(f"shifts.{name}", v.show(value), "two numbers, low and high")
        return float(value[0]), float(value[1])

    def draw(self, seed: tuple[int, ...]) -> "Conditions":
        """The conditions of an episode; each shift has random numbers of its own, so leaving one out changes no
        other."""

        def rng(name: str) -> np.random.Generator:
            return np.random.default_rng([*seed, [f.name for f in dataclasses.fields(Shifts)].index(name)])

        def between(name: str) -> float:
            low, high = self._range(name)
            return float(rng(name).uniform(low, high))

        azimuth = float(rng("slope").uniform(-math.pi, math.pi))
        tilt = rng("slope").spawn(1)[0].uniform(*self.slope)
        down = (math.sin(tilt) * math.cos(azimuth), math.sin(tilt) * math.sin(azimuth), -math.cos(tilt))
        return Conditions(
            latency=between("latency"),
            exposure=between("exposure"),
            gravity=down,
            grip=between("grip"),
            battery=between("battery"),
            scale=1.0 + self.drift * float(rng("drift").normal()),
            turn=self.turn * float(rng("turn").normal()),
            seed=seed,
        )


@dataclasses.dataclass(frozen=True)
class Conditions:
    """Drawn shifts of one episode.

    Attributes:
      latency: s. exposure: EV. gravity: (3,) unit vector. grip, battery: shares.
      scale: of odometry's distances. turn: rad/m of odometry's heading.
      seed: of what is drawn during the episode.
    """

    latency: float
    exposure: float
    gravity: tuple[float, float, float]
    grip: float
    battery: float
    scale: float
    turn: float
    seed: tuple[int, ...]


#: All of them together, as in the table of all policies.
ALL = Shifts(
    contact=True,
    renderer=True,
    latency=(0.05, 0.25),
    dropped=0.1,
    distortion=1.0,
    exposure=(-1.0, 1.0),
    noise=0.02,
    drift=0.02,
    turn=math.radians(0.15),
    wander=math.radians(0.5),
    slope=(0.0, 0.07),
    grip=(0.3, 0.6),
    battery=(0.7, 0.9),
)
#: Name of a row of the table of single shifts -> its shift.
ALONE: dict[str, Shifts] = {
    "none": Shifts(),
    "contact model": Shifts(contact=True),
    "renderer": Shifts(renderer=True),
    "latency": Shifts(latency=ALL.latency),
    "dropped images": Shifts(dropped=ALL.dropped),
    "distortion": Shifts(distortion=ALL.distortion),
    "fisheye": Shifts(fisheye=True),
    "exposure and noise": Shifts(exposure=ALL.exposure, noise=ALL.noise),
    "odometry drift": Shifts(drift=ALL.drift, turn=ALL.turn, wander=ALL.wander),
    "slope": Shifts(slope=ALL.slope),
    "wheel slip": Shifts(grip=ALL.grip),
    "weak battery": Shifts(battery=ALL.battery),
}
#: k1, k2, p1, p2 of a lens of 122 degrees across; OpenCV's order.
BROWN = (-0.06, 0.004, 0.002, -0.002)
#: Probability that the image after a lost one is lost as well.
BURST = 0.5


# Lens.


def pinhole_rays(height: int, width: int, fovy: float) -> np.ndarray:
    """(H, W, 3) unit rays of pixels' centres; x right, y down, z forward."""
    focal = height / (2.0 * math.tan(fovy / 2.0))
    x, y = _centred(height, width)
    return _unit(np.stack([x / focal, y / focal, np.ones_like(x)], -1))


def brown_rays(height: int, width: int, fovy: float, coefficients: tuple[float, ...]) -> np.ndarray:
    """(H, W, 3) unit rays of pixels of a lens with OpenCV's model (k1, k2, p1, p2) and the focal length of a pinhole
    with this vertical field of view.

    Raises:
      ValidationError: the model cannot be inverted somewhere in the image, because it folds back there.
    """
    focal = height / (2.0 * math.tan(fovy / 2.0))
    distorted = np.stack([c / focal for c in _centred(height, width)], -1)
    straight = distorted.copy()
    for _ in range(200):
        straight -= 0.7 * (brown(straight, coefficients) - distorted)
        # A point beyond the fold runs away.
        straight = np.clip(straight, -50.0, 50.0)
    off = np.abs(brown(straight, coefficients) - distorted).max()
    if not off < 1e-6:
        raise v.fail(
            "shifts.distortion", f"a lens that folds back ({off:.2g} off)", "a weaker one", "take a smaller factor"
        )
    return _unit(np.concatenate([straight, np.ones_like(straight[..., :1])], -1))


def brown(points: np.ndarray, coefficients: tuple[float, ...]) -> np.ndarray:
    """Distorts (..., 2) points at z = 1 by OpenCV's model with k1, k2, p1, p2."""
    k1, k2, p1, p2 = coefficients
    x, y = points[..., 0], points[..., 1]
    r2 = x * x + y * y
    radial = 1.0 + k1 * r2 + k2 * r2 * r2
    return np.stack(
        [
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        ],
        -1,
    )


def fisheye_rays(height: int, width: int, fovy: float) -> np.ndarray:
    """(H, W, 3) unit rays of an equidistant lens with this vertical field of view (rad), through the middle."""
    x, y = _centred(height, width)
    radius = np.hypot(x, y)
    theta = radius * fovy / height
    share = np.sin(theta) / np.maximum(radius, 1e-12)
    return np.stack([x * share, y * share, np.cos(theta)], -1)


def _centred(height: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, np.arange(height) + 0.5 - height / 2)
    return x, y


def _unit(rays: np.ndarray) -> np.ndarray:
    return rays / np.linalg.norm(rays, axis=-1, keepdims=True)


@dataclasses.dataclass(frozen=True)
class View:
    """A pinhole view from which a part of a lens's image is taken: yaw (rad, to the left), fovy (rad), pixels."""

    yaw: float
    fovy: float
    height: int
    width: int


class Lens:
    """Makes the image of a lens out of pinhole views.

    Attributes:
      views: to be rendered, in this order.
    """

    def __init__(self, rays: np.ndarray) -> None:
        # Rays beyond 60 degrees to a side need two views, of which each has its half.
        wide = bool((np.arctan2(np.abs(rays[..., 0]), rays[..., 2]) > math.radians(65.0)).any())
        self._shape = rays.shape[:2]
        yaws = (math.pi / 4, -math.pi / 4) if wide else (0.0,)
        self._of = (rays[..., 0] > 0.0).astype(int) if wide else np.zeros(self._shape, int)
        self.views, self._at = [], []
        for number, yaw in enumerate(yaws):
            mine = self._of == number
            c, s = math.cos(yaw), math.sin(yaw)
            x, y, z = (rays[mine][:, k] for k in range(3))
            # The view is turned to the left, so its rays are turned to the right in its frame.
            ahead, right = c * z - s * x, c * x + s * z
            if (ahead <= 0.05).any():
                raise v.fail("lens", "rays beyond 90 degrees of a view", "a narrower lens")
            slopes = np.stack([right, y], -1) / ahead[:, None]
            reach = np.abs(slopes).max(0) * 1.02
            # As many pixels per radian as the lens has, at the middle of the view.
            scale = self._shape[0] / (2.0 * _half_height(rays))
            height, width = (max(2, 2 * math.ceil(scale * r)) for r in (reach[1], reach[0]))
            focal = height / (2.0 * reach[1])
            width = max(width, 2 * math.ceil(focal * reach[0]))
            self.views.append(View(yaw, 2.0 * math.atan(reach[1]), height, width))
            self._at.append((slopes[:, 0] * focal + width / 2 - 0.5, slopes[:, 1] * focal + height / 2 - 0.5))

    def image(self, frames: list[np.ndarray]) -> np.ndarray:
        """(H, W, 3) u8 from the frames of `views`."""
        out = np.zeros((*self._shape, 3), np.float32)
        for number, (frame, (x, y)) in enumerate(zip(frames, self._at, strict=True)):
            out[self._of == number] = _bilinear(frame, x, y)
        return np.clip(np.round(out), 0, 255).astype(np.uint8)


def _half_height(rays: np.ndarray) -> float:
    """Slope of the image's upper border at its middle."""
    ray = rays[0, rays.shape[1] // 2]
    return float(abs(ray[1]) / max(ray[2], 1e-3))


def _bilinear(frame: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    height, width = frame.shape[:2]
    x, y = np.clip(x, 0.0, width - 1.0), np.clip(y, 0.0, height - 1.0)
    x0, y0 = np.minimum(x.astype(int), max(width - 2, 0)), np.minimum(y.astype(int), max(height - 2, 0))
    a, b = (x - x0)[:, None], (y - y0)[:, None]
    p = frame.astype(np.float32)
    top = p[y0, x0] * (1 - a) + p[y0, x0 + 1] * a
    low = p[y0 + 1, x0] * (1 - a) + p[y0 + 1, x0 + 1] * a
    return top * (1 - b) + low * b


# Image, odometry, time.


def exposed(image: np.ndarray, ev: float, noise: float, rng: np.random.Generator) -> np.ndarray:
    """(H, W, 3) u8 sRGB exposed `ev` powers of two longer in linear light, with noise (of 1) on the result."""
    if ev == 0.0 and noise == 0.0:
        return image
    encoded = image / np.float32(255.0)
    out = srgb.encoded(srgb.linear(encoded) * 2.0**ev)
    if noise:
        out = out + rng.normal(0.0, noise, out.shape)
    return np.clip(np.round(255.0 * out), 0, 255).astype(np.uint8)


class Dropouts:
    """Loses images: independently with probability `dropped`, and in bursts after that."""

    def __init__(self, dropped: float, rng: np.random.Generator) -> None:
        self._dropped, self._rng = dropped, rng
        self._image: np.ndarray | None = None
        self._lost = False

    def lost(self) -> bool:
        """Whether the next image is lost; the first never is."""
        draw = float(self._rng.random())
        self._lost = self._image is not None and draw < (BURST if self._lost and self._dropped else self._dropped)
        return self._lost

    def seen(self, image: np.ndarray | None) -> np.ndarray:
        """What the policy sees; image: None if it is lost."""
        self._image = self._image if image is None else image
        assert self._image is not None
        return self._image


class Odometry:
    """Pose (x, y, yaw) as odometry estimates it; it begins at the true one.

    Every step ahead has the wrong length by `scale`; the heading turns by `turn` for every metre and by a random walk
    of `wander` rad/sqrt(m).
    """

    def __init__(self, pose: np.ndarray, scale: float, turn: float, wander: float, rng: np.random.Generator) -> None:
        self._true = np.array(pose, np.float64)
        self.pose = self._true.copy()
        self._scale, self._turn, self._wander, self._rng = scale, turn, wander, rng

    def update(self, pose: np.ndarray) -> np.ndarray:
        """The estimate (3,) after the robot has moved to a true pose (3,)."""
        step, turned = pose[:2] - self._true[:2], pose[2] - self._true[2]
        length = float(np.hypot(*step))
        c, s = math.cos(self.pose[2] - self._true[2]), math.sin(self.pose[2] - self._true[2])
        self.pose[:2] += self._scale * np.array([c * step[0] - s * step[1], s * step[0] + c * step[1]])
        error = self._turn * length + (self._wander * math.sqrt(length) * self._rng.normal() if self._wander else 0.0)
        self.pose[2] += turned + error
        self._true[:] = pose
        return self.pose


class DelayLine:
    """Values that take effect `delay` s after they were given; before the first, `first` is in effect."""

    def __init__(self, delay: float, first: Any) -> None:
        self._delay, self._now = delay, first
        self._waiting: collections.deque[tuple[float, Any]] = collections.deque()

    def give(self, time: float, value: Any) -> None:
        self._waiting.append((time + self._delay, value))

    def at(self, time: float) -> Any:
        """The value in effect; times must not go back."""
        while self._waiting and self._waiting[0][0] <= time + 1e-9:
            self._now = self._waiting.popleft()[1]
        return self._now
