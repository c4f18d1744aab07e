"""A clothed human figure from joint angles.

Segment lengths as shares of the stature follow Drillis and Contini (1966), as tabulated in Winter's
"Biomechanics and Motor Control of Human Movement"; girths are those of the 50th percentile, times `girth`.
"""

import dataclasses
import functools

import numpy as np

from ...meshes import shapes
from ...meshes.mesh_builder import MeshBuilder
from ...meshes.palette import Color, mix, shade
from ...meshes.shapes import Shape

THIGH, SHANK, ANKLE_HEIGHT = 0.245, 0.246, 0.039
UPPER_ARM, FOREARM, HAND = 0.186, 0.146, 0.108
HIP_HALF, SHOULDER_HALF = 0.052, 0.106
SHOULDER_ABOVE_HIP, CHIN_ABOVE_HIP = 0.276, 0.342


@dataclasses.dataclass(frozen=True)
class Pose:
    """Angles in degrees, (left, right); thighs and upper arms positive forwards, knees and elbows as they bend.

    lean: of the trunk forwards; spread: of the arms sideways; turn: of the head to the left.
    """

    thigh: tuple[float, float] = (0.0, 0.0)
    knee: tuple[float, float] = (3.0, 3.0)
    shoulder: tuple[float, float] = (0.0, 0.0)
    elbow: tuple[float, float] = (10.0, 10.0)
    lean: float = 0.0
    spread: tuple[float, float] = (7.0, 7.0)
    turn: float = 0.0


WALKING = Pose((24, -16), (8, 24), (-20, 22), (14, 26), 3.0)
WALKING_OTHER = Pose((-15, 25), (28, 6), (24, -18), (30, 12), 3.0)
STANDING = Pose((1, -2), (2, 3), (3, -2), (12, 14), 0.0)
RUNNING = Pose((48, -18), (62, 78), (-42, 38), (88, 92), 12.0)


@dataclasses.dataclass(frozen=True)
class Person:
    """Clothes and body.

    top: "shirt", "jacket", "coat" or "dress"; bottom: "trousers", "shorts" or "skirt"; hair: "short", "long", "bun",
    "bald", "curly"; head: 1 for adults, larger for children (share of the adult's head to body).
    """

    height: float = 1.75
    girth: float = 1.0
    skin: Color = "skin light"
    hair: str = "short"
    hair_color: Color = "#3a2a1e"
    top: str = "shirt"
    top_color: Color = "blue"
    bottom: str = "trousers"
    bottom_color: Color = "dark blue"
    shoes: Color = "black"
    sleeves: str = "long"
    head: float = 1.0


class Figure:
    """A figure under construction; its joints are computed first, so that objects can be put into its hands."""

    def __init__(
        self, builder: MeshBuilder, person: Person, pose: Pose, hip: tuple[float, float, float] | None = None
    ) -> None:
        self.builder, self.person, self.pose = builder, person, pose
        h = person.height
        drop = [
            THIGH * np.cos(np.radians(a)) + SHANK * np.cos(np.radians(a - k))
            for a, k in zip(pose.thigh, pose.knee, strict=True)
        ]
        self.hip = np.array(hip if hip is not None else (0.0, 0.0, (max(drop) + ANKLE_HEIGHT) * h))
        self.knees, self.ankles, self.elbows, self.wrists, self.hands, self.shoulders = [], [], [], [], [], []
        for side, k in ((1.0, 0), (-1.0, 1)):
            start = self.hip + [0, side * HIP_HALF * h, 0]
            knee = start + THIGH * h * _down(pose.thigh[k])
            self.knees.append(knee)
            self.ankles.append(knee + SHANK * h * _down(pose.thigh[k] - pose.knee[k]))
            shoulder = self.trunk(SHOULDER_ABOVE_HIP) + [0, side * SHOULDER_HALF * h * person.girth**0.5, 0]
            aside = side * np.sin(np.radians(pose.spread[k]))
            upper = _down(pose.shoulder[k]) * np.cos(np.radians(pose.spread[k])) + [0, aside, 0]
            lower = _down(pose.shoulder[k] + pose.elbow[k]) * np.cos(np.radians(pose.spread[k] / 2)) + [0, aside / 2, 0]
            elbow = shoulder + UPPER_ARM * h * upper
            wrist = elbow + FOREARM * h * lower
            self.shoulders.append(shoulder)
            self.elbows.append(elbow)
            self.wrists.append(wrist)
            self.hands.append(wrist + 0.45 * HAND * h * lower)

    def trunk(self, share: float) -> np.ndarray:
        """A point of the trunk's axis, a share of the stature above the hips."""
        lean = np.radians(self.pose.lean)
        return self.hip + share * self.person.height * np.array([np.sin(lean), 0.0, np.cos(lean)])

    def build(self) -> None:
        """All of the body and its clothes."""
        self._legs()
        self._torso()
        self._arms()
        self._head()

    # Parts ----------------------------------------------------------------------------------------------------

    def ring(
        self, share: float, half_width: float, half_depth: float, forward: float = 0.0, points: int = 12
    ) -> np.ndarray:
        """A cross section of the trunk (superellipse), sizes as shares of the stature."""
        h, g = self.person.height, self.person.girth
        a = np.arange(points) * 2 * np.pi / points
        c, s = np.cos(a), np.sin(a)
        x = np.sign(c) * np.abs(c) ** 0.85 * half_depth * h * g + forward * h
        y = np.sign(s) * np.abs(s) ** 0.85 * half_width * h * g**0.8
        lean = np.radians(self.pose.lean)
        return self.trunk(share) + np.stack([x * np.cos(lean), y, -x * np.sin(lean)], 1)

    def hem(self, share: float, half_width: float) -> np.ndarray:
        """The lower edge of a skirt or coat, wide enough for both thighs as they are posed."""
        reach = [-share * np.tan(np.radians(np.clip(a, -50, 50))) for a in self.pose.thigh]
        # 6 % of the stature is half a clothed thigh's thickness, with room for the cloth's flat facets.
        front, back = max(0.066, max(reach) + 0.068), max(0.066, 0.066 - min(reach))
        return self.ring(share, half_width, (front + back) / 2, (front - back) / 2)

    def _torso(self) -> None:
        person = self.person
        thick = {"shirt": 1.0, "dress": 1.0, "jacket": 1.10, "coat": 1.15}[person.top]
        rows = [
            (0.015, 0.094, 0.066, 0.0),
            (0.055, 0.088, 0.062, 0.002),
            (0.105, 0.079, 0.056, 0.004),
            (0.16, 0.086, 0.061, 0.004),
            (0.215, 0.097, 0.066, 0.003),
            (0.250, 0.108, 0.064, -0.001),
            (0.280, 0.096, 0.054, -0.005),
            (0.300, 0.066, 0.044, -0.006),
            (0.316, 0.036, 0.034, -0.004),
        ]
        if person.top in ("jacket", "coat"):
            rows[2] = (0.105, 0.090, 0.064, 0.004)  # cloth hangs straight over the waist
        sections = [self.ring(z, w * thick, d * thick, f) for z, w, d, f in rows]
        if person.top == "coat":
            sections[0] = self.hem(-0.04, 0.108)
            sections.insert(0, self.hem(-0.17, 0.118))
        elif person.top == "jacket":
            sections.insert(0, self.ring(-0.03, 0.108, 0.078))
        elif person.top == "dress":
            sections[0] = self.hem(-0.05, 0.108)
            sections.insert(0, self.hem(-0.14, 0.120))
            sections.insert(0, self.hem(-0.235, 0.130))
        self.builder.loft(sections, person.top_color, crease_deg=60)
        neck = [self.trunk(0.295), self.trunk(CHIN_ABOVE_HIP + 0.012) + [0.006 * person.height, 0, 0]]
        self.builder.tube(neck, [0.031 * person.height * person.girth**0.5] * 2, person.skin, sides=10)
        if person.top in ("jacket", "coat"):  # the collar, and the shirt that shows in its opening
            self.builder.loft(
                [self.ring(0.290, 0.052, 0.050), self.ring(0.322, 0.040, 0.042)], shade(person.top_color, 0.85)
            )
            h = person.height
            front = [self.trunk(z) + [d * h * person.girth, 0, 0] for z, d in ((0.300, 0.050), (0.20, 0.084))]
            self.builder.quad(
                [
                    front[1] - [0, 0.004, 0],
                    front[1] + [0, 0.004, 0],
                    front[0] + [0, 0.026, 0],
                    front[0] - [0, 0.026, 0],
                ],
                "white",
                both_sides=True,
            )

    def _legs(self) -> None:
        person, h, g = self.person, self.person.height, self.person.girth
        bare = person.bottom != "trousers"
        # What a coat or skirt hides is left away, so that no thigh shows through its cloth.
        hidden = max({"coat": 0.17, "dress": 0.235}.get(person.top, 0.0), 0.23 if person.bottom == "skirt" else 0.0)
        start = max(0.0, hidden - 0.05) / THIGH
        for k, side in ((0, 1.0), (1, -1.0)):
            top = self.hip + [0, side * HIP_HALF * h * 0.92, 0.01 * h]
            knee, ankle = self.knees[k], self.ankles[k]
            top = top + (knee - top) * start
            path = [top, top + (knee - top) * 0.5, knee, knee + (ankle - knee) * 0.35, ankle]
            radii = np.array([0.054 - 0.014 * start, 0.046 - 0.006 * start, 0.033, 0.034, 0.023]) * h * g**0.6
            if bare:
                self.builder.tube(path, list(radii), person.skin, sides=8)
            else:
                self.builder.tube(
                    path, list(radii * np.array([1.04, 1.08, 1.16, 1.18, 1.5])), person.bottom_color, sides=8
                )
            if person.bottom == "shorts":
                end = top + (knee - top) * 0.78
                self.builder.tube(
                    [top, (top + end) / 2, end],
                    list(radii[:3] * np.array([1.1, 1.18, 1.5])),
                    person.bottom_color,
                    sides=8,
                )
            self._shoe(ankle, self.pose.thigh[k] - self.pose.knee[k])
        if person.top == "dress":
            return
        # The seat joins the legs.
        seat = [
            self.ring(-0.055, 0.060, 0.050),
            self.ring(-0.025, 0.090, 0.066),
            self.ring(0.02, 0.093, 0.066),
            self.ring(0.045, 0.088, 0.061),
        ]
        self.builder.loft(seat, person.bottom_color, crease_deg=60)
        if person.bottom == "skirt":
            self.builder.loft(
                [self.hem(-0.23, 0.122), self.hem(-0.14, 0.114), self.hem(-0.05, 0.104), self.ring(0.06, 0.088, 0.062)],
                person.bottom_color,
                crease_deg=60,
            )

    def _shoe(self, ankle: np.ndarray, shin: float) -> None:
        """A shoe whose sole follows the shin half way (a lifted heel when the leg is behind)."""
        h = self.person.height
        pitch = np.radians(np.clip(-shin * 0.75, -18, 55)) if shin < 0 else np.radians(np.clip(-shin * 0.4, -18, 0))
        with self.builder.frame(tuple(ankle), (0, float(np.degrees(pitch)), 0)):
            length, width = 0.150 * h, 0.029 * h
            low = -ANKLE_HEIGHT * h
            profile = [
                (-0.27, 0.030, 0.030),
                (-0.24, 0.050, 0.85),
                (0.0, 0.056, 0.95),
                (0.25, 0.042, 1.0),
                (0.55, 0.034, 1.05),
                (0.68, 0.028, 0.85),
                (0.73, 0.014, 0.4),
            ]
            sections = []
            for x, top, wide in profile:
                a = np.arange(8) * 2 * np.pi / 8 + np.pi / 8
                y = np.clip(np.cos(a) * 1.15, -1, 1) * width * min(wide, 1.05)
                z = low + (np.clip(np.sin(a) * 1.15, -1, 1) + 1) / 2 * top * h
                sections.append(np.stack([np.full(8, x * length), y, z], 1))
            self.builder.loft(sections, self.person.shoes, crease_deg=50)

    def _arms(self) -> None:
        person, h, g = self.person, self.person.height, self.person.girth
        cloth = {"shirt": 1.12, "dress": 1.08, "jacket": 1.25, "coat": 1.3}[person.top]
        for k in (0, 1):
            shoulder, elbow, wrist = self.shoulders[k], self.elbows[k], self.wrists[k]
            radii = np.array([0.0285, 0.0265, 0.0235, 0.0225, 0.0165]) * h * g**0.6
            path = [shoulder - [0, 0, 0.006 * h], (shoulder + elbow) / 2, elbow, elbow + (wrist - elbow) * 0.4, wrist]
            if person.sleeves == "long":
                self.builder.tube(path, list(radii * cloth), person.top_color, sides=8)
            else:
                self.builder.tube(path[1:], list(radii[1:]), person.skin, sides=8)
                self.builder.tube(
                    path[:2] + [path[1] + (elbow - shoulder) * 0.12],
                    list(radii[[0, 1, 1]] * cloth * 1.08),
                    person.top_color,
                    sides=8,
                )
            self.builder.ball(
                (0.027 * h * cloth, 0.029 * h * cloth, 0.026 * h * cloth),
                tuple(shoulder - [0, 0, 0.004 * h]),
                person.top_color,
                segments=8,
                rings=6,
            )
            lower = (wrist - elbow) / np.linalg.norm(wrist - elbow)
            path = [
                wrist - lower * 0.01,
                wrist + lower * 0.035 * h,
                wrist + lower * 0.075 * h,
                wrist + lower * 0.10 * h,
            ]
            self.builder.tube(path, [0.0155 * h, 0.024 * h, 0.021 * h, 0.009 * h], person.skin, sides=7)

    @functools.cached_property
    def head_center(self) -> np.ndarray:
        h = self.person.height
        return self.trunk(CHIN_ABOVE_HIP) + np.array([0.014, 0.0, 0.063 * self.person.head]) * h

    @property
    def head_radii(self) -> np.ndarray:
        """Half depth, half width and half height of the skull, m."""
        return np.array([0.057, 0.047, 0.069]) * self.person.height * self.person.head

    def _head(self) -> None:
        person, (rx, ry, rz) = self.person, self.head_radii
        with self.builder.frame(tuple(self.head_center), (0, 0, self.pose.turn)):
            # The face narrows towards the chin.
            skull = shapes.ellipsoid((rx, ry, rz), 12, 8)
            points = skull.vertices.copy()
            low = np.clip(-points[:, 2] / rz, 0, 1)
            points[:, 1] *= 1 - 0.22 * low
            points[:, 0] = np.where(points[:, 0] < 0, points[:, 0] * (1 - 0.25 * low), points[:, 0])
            self.builder.add(Shape(points, skull.faces), person.skin, crease_deg=60)
            for side in (-1, 1):
                self.builder.ball(
                    (rx * 0.08, ry * 0.17, rz * 0.065),
                    (rx * 0.87, side * ry * 0.40, rz * 0.08),
                    "white",
                    segments=5,
                    rings=3,
                )
                self.builder.ball(
                    (rx * 0.06, ry * 0.08, rz * 0.06),
                    (rx * 0.93, side * ry * 0.40, rz * 0.08),
                    "#2a1d14",
                    segments=5,
                    rings=3,
                )
                self.builder.ball(
                    (rx * 0.05, ry * 0.24, rz * 0.03),
                    (rx * 0.87, side * ry * 0.40, rz * 0.24),
                    person.hair_color,
                    segments=5,
                    rings=3,
                )
                self.builder.ball(
                    (rx * 0.16, ry * 0.10, rz * 0.17),
                    (-rx * 0.05, side * ry * 0.98, 0.0),
                    person.skin,
                    segments=5,
                    rings=3,
                )
            self.builder.convex(
                [
                    (rx * 0.92, 0, rz * 0.12),
                    (rx * 1.16, 0, -rz * 0.16),
                    (rx * 0.9, ry * 0.17, -rz * 0.22),
                    (rx * 0.9, -ry * 0.17, -rz * 0.22),
                ],
                shade(person.skin, 0.96),
            )
            self.builder.ball(
                (rx * 0.06, ry * 0.30, rz * 0.035),
                (rx * 0.82, 0, -rz * 0.46),
                mix(person.skin, "dark red", 0.45),
                segments=8,
                rings=4,
            )
            self._hair()

    def _hair(self) -> None:
        person, (rx, ry, rz) = self.person, self.head_radii
        if person.hair == "bald":
            return
        grow = 1.16 if person.hair == "curly" else 1.09
        cap = shapes.ellipsoid((rx * grow, ry * grow, rz * grow), 12, 8)
        middle = cap.vertices[cap.faces].mean(1)
        # The hairline: high over the forehead, low at the neck.
        keep = middle[:, 2] > 0.42 * rz + 0.95 * (middle[:, 0] - 0.55 * rx) * rz / rx
        used, faces = np.unique(cap.faces[keep], return_inverse=True)
        points = cap.vertices[used] + [-0.05 * rx, 0, 0.03 * rz]
        if person.hair == "curly":
            points = points * (
                1 + 0.06 * np.sin(37 * points[:, :1] / rx + 23 * points[:, 1:2] / ry + 31 * points[:, 2:] / rz)
            )
        both = Shape(points, faces.reshape(-1, 3))
        self.builder.add(both, person.hair_color, crease_deg=60)
        self.builder.add(both.flipped(), shade(person.hair_color, 0.8), crease_deg=60)
        if person.hair == "long":
            self.builder.loft(
                [
                    _oval(-0.62 * rx, -1.75 * rz, 0.30 * rx, 0.85 * ry),
                    _oval(-0.60 * rx, -0.9 * rz, 0.42 * rx, 0.98 * ry),
                    _oval(-0.50 * rx, 0.1 * rz, 0.55 * rx, 1.04 * ry),
                    _oval(-0.35 * rx, 0.6 * rz, 0.4 * rx, 0.8 * ry),
                ],
                person.hair_color,
                crease_deg=60,
            )
        if person.hair == "bun":
            self.builder.ball(0.42 * rx, (-1.15 * rx, 0, 0.45 * rz), person.hair_color, segments=9, rings=6)


def _down(angle_deg: float) -> np.ndarray:
    """Unit vector that hangs down, swung forwards by an angle."""
    return np.array([np.sin(np.radians(angle_deg)), 0.0, -np.cos(np.radians(angle_deg))])


def _oval(x: float, z: float, half_depth: float, half_width: float, points: int = 10) -> np.ndarray:
    a = np.arange(points) * 2 * np.pi / points
    return np.stack([x + half_depth * np.cos(a), half_width * np.sin(a), np.full(points, z)], 1)
