"""Animals of the street: dog, cat, bird."""

import dataclasses

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, mix, shade
from ...meshes.recipe import Physics, recipe

_REASON = "body masses of common breeds; an animal walks off rather than being pushed; fur slides at about 0.5"
_DOG = Physics(("flesh", "fur"), 1000.0, (6.0, 40.0), 0.5, False, _REASON)
_CAT = Physics(("flesh", "fur"), 1000.0, (2.5, 7.0), 0.5, False, _REASON)
_BIRD = Physics(
    ("flesh", "feathers"),
    900.0,
    (0.2, 3.0),
    0.5,
    False,
    "a pigeon weighs 0.3 kg, a crow 0.5 kg, a gull 1 kg; birds fly off",
)


def ring(
    x: float, z: float, half_width: float, half_height: float, pitch_deg: float = 0.0, points: int = 12
) -> np.ndarray:
    """A cross section of a body, tilted by the pitch of its axis."""
    a = np.arange(points) * 2 * np.pi / points
    up = half_height * np.sin(a)
    p = np.radians(pitch_deg)
    return np.stack([x - up * np.sin(p), half_width * np.cos(a), z + up * np.cos(p)], 1)


@dataclasses.dataclass(frozen=True)
class _Coat:
    """Colours of a four-legged animal: back, belly and legs, patches, ears; `ears` "up", "fold"."""

    back: Color
    belly: Color
    ears: str = "fold"
    collar: Color | None = None
    tail: str = "up"


def _quadruped(
    b: MeshBuilder,
    s: float,
    leg: float,
    body: float,
    girth: float,
    muzzle: float,
    coat: _Coat,
    stride: float,
    cat: bool,
) -> None:
    """A standing or walking dog or cat along +x.

    s: shoulder height, m; leg, body, girth, muzzle: shares of it (length of the legs, length of the trunk, its radius,
    length of the snout); stride: degrees.
    """
    top = s
    low = s * leg
    mid = (top + low) / 2 + 0.02 * s
    half = s * body / 2
    r = s * girth
    trunk = [
        (-half - 0.10 * s, mid + 0.10 * s, 0.25, 0.30),
        (-half, mid + 0.06 * s, 0.75, 0.85),
        (-half * 0.45, mid + 0.03 * s, 0.78, 0.82),
        (0.0, mid, 0.88, 0.98),
        (half * 0.5, mid - 0.01 * s, 1.0, 1.18),
        (half * 0.9, mid + 0.03 * s, 0.92, 1.12),
        (half + 0.10 * s, mid + 0.10 * s, 0.60, 0.80),
    ]
    b.loft([ring(x, z, r * w, r * h) for x, z, w, h in trunk], coat.back, crease_deg=60)
    if coat.belly != coat.back:
        b.loft(
            [ring(x, z - r * 0.16, r * w * 0.96, r * h * 0.92) for x, z, w, h in trunk[2:7]], coat.belly, crease_deg=60
        )
    neck_end = np.array([half + (0.30 if cat else 0.34) * s, 0.0, top + (0.10 if cat else 0.24) * s])
    neck = [
        (half + 0.0, 0, mid + 0.10 * s),
        tuple((np.array([half, 0, mid + 0.10 * s]) + neck_end) / 2),
        tuple(neck_end),
    ]
    b.tube(neck, [r * 0.95, r * 0.72, r * 0.62], coat.back, sides=10)
    if coat.collar is not None:
        c = np.array(neck[1]) * 0.6 + np.array(neck[2]) * 0.4
        b.ring(r * 0.70, 0.018 * s, tuple(c), coat.collar, (0, 52, 0), 14, 5)
    _head(b, s, neck_end, muzzle, coat, cat)
    # Legs: two bones each; diagonal pairs swing together.
    for x, front in ((half * 0.86, True), (-half * 0.92, False)):
        for side in (1, -1):
            swing = stride * (1 if (side > 0) == front else -1)
            _leg(b, np.array([x, side * r * 0.62, mid]), mid, s, swing, front, coat.belly if not cat else coat.back)
    base = np.array([-half - 0.08 * s, 0, mid + 0.14 * s])
    tails = {
        "up": ((-0.16, 0.10), (-0.24, 0.30), (-0.16, 0.46)),
        "down": ((-0.14, -0.04), (-0.24, -0.26), (-0.30, -0.46)),
        "curl": ((-0.10, 0.12), (-0.06, 0.28), (0.08, 0.30)),
        "long": ((-0.26, 0.06), (-0.46, 0.30), (-0.50, 0.66)),
    }
    path = [tuple(base)] + [tuple(base + np.array([dx, 0, dz]) * s) for dx, dz in tails[coat.tail]]
    b.tube(path, [r * 0.30, r * 0.26, r * 0.22, r * 0.10], coat.back, sides=7)


def _leg(b: MeshBuilder, hip: np.ndarray, length: float, s: float, swing: float, front: bool, paw: Color) -> None:
    a = np.radians(swing)
    bend = 0.10 if front else 0.16
    knee = hip + np.array(
        [np.sin(a) * 0.5 * length + (-bend if front else bend) * 0.35 * s, 0, -np.cos(a) * 0.48 * length]
    )
    foot = np.array([hip[0] + np.sin(a) * length + 0.0 * s, hip[1] * 0.9, 0.045 * s])
    hock = knee * 0.45 + foot * 0.55 + np.array([(0.02 if front else -bend * 0.5) * s, 0, 0.02 * s])
    thick = 0.080 if front else 0.098
    b.tube(
        [tuple(hip + [0, 0, 0.03 * s]), tuple(knee), tuple(hock), tuple(foot)],
        [thick * s * 1.15, thick * s * 0.75, 0.045 * s, 0.042 * s],
        paw,
        sides=8,
    )
    b.ball((0.075 * s, 0.052 * s, 0.045 * s), (foot[0] + 0.03 * s, foot[1], 0.045 * s), paw, segments=8, rings=5)


def _head(b: MeshBuilder, s: float, at: np.ndarray, muzzle: float, coat: _Coat, cat: bool) -> None:
    r = (0.17 if cat else 0.165) * s
    with b.frame(tuple(at + np.array([0.06 * s, 0, 0.02 * s])), (0, 8, 0)):
        b.ball((r * 1.1, r * 0.95, r * 0.95), (0, 0, 0), coat.back, segments=12, rings=8)
        m = muzzle * s
        b.loft(
            [
                ring(x, z, w, h)
                for x, z, w, h in (
                    (r * 0.55, -0.18 * r, 0.62 * r, 0.55 * r),
                    (r * 0.9 + m * 0.4, -0.28 * r, 0.46 * r, 0.42 * r),
                    (r * 0.9 + m, -0.28 * r, 0.36 * r, 0.32 * r),
                )
            ],
            coat.belly,
            crease_deg=60,
        )
        b.ball(
            (0.14 * r, 0.20 * r, 0.15 * r),
            (r * 0.92 + m, 0, -0.10 * r),
            "#2a2020" if not cat else "#c88a86",
            segments=8,
            rings=5,
        )
        for side in (-1, 1):
            b.ball(
                (0.10 * r, 0.14 * r, 0.15 * r),
                (r * 0.84, side * r * 0.46, r * 0.28),
                "#1a1410" if not cat else "#9ab84a",
                segments=8,
                rings=5,
            )
            if coat.ears == "up":
                tip = (-0.05 * r, side * r * 0.80, r * 1.75)
                base = [
                    (0.30 * r, side * r * 0.35, r * 0.72),
                    (0.05 * r, side * r * 1.0, r * 0.45),
                    (-0.35 * r, side * r * 0.60, r * 0.62),
                ]
                b.convex([tip, *base], coat.back)
                b.convex(
                    [
                        (0.06 * r, side * r * 0.77, r * 1.50),
                        (0.34 * r, side * r * 0.45, r * 0.72),
                        (0.14 * r, side * r * 0.88, r * 0.55),
                        (0.0, side * r * 0.7, r * 0.7),
                    ],
                    mix(coat.back, "pink", 0.5),
                )
            else:
                b.tube(
                    [
                        (-0.1 * r, side * r * 0.7, r * 0.65),
                        (-0.05 * r, side * r * 1.05, r * 0.25),
                        (0.02 * r, side * r * 1.05, -r * 0.45),
                    ],
                    [0.18 * r, 0.30 * r, 0.20 * r],
                    shade(coat.back, 0.75),
                    sides=6,
                )


@recipe("dog", 4, _DOG, hulls=3, name="animals.dog")
def dog(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.9)
    s, leg, body, girth, muzzle, coat, stride, mass = (
        (0.58, 0.50, 1.02, 0.215, 0.17, _Coat("#c99a54", "#dcb678", "fold", "red", "up"), 14, 28.0),
        (0.60, 0.50, 1.05, 0.210, 0.19, _Coat("#3a322c", "#a87440", "up", None, "down"), 16, 32.0),
        (0.30, 0.42, 1.25, 0.26, 0.20, _Coat("#f0ebe0", "#f0ebe0", "up", "blue", "curl"), 10, 8.0),
        (0.52, 0.50, 1.0, 0.205, 0.15, _Coat("#26241f", "#ece6da", "fold", "green", "up"), 20, 20.0),
    )[variant]
    _quadruped(b, s, leg, body, girth, muzzle, coat, stride, cat=False)
    if variant == 3:  # the white blaze and saddle of a sheepdog
        b.ball((0.05, 0.115, 0.13), (0.21, 0, 0.42), "#ece6da", segments=10, rings=7)
    names = (
        "A golden retriever with a red collar",
        "A German shepherd",
        "A small white terrier",
        "A black and white sheepdog, trotting",
    )
    built = b.build(names[variant], {"shoulder_height": s}, mass=mass)
    return dataclasses.replace(built, volume=mass / 1000.0)


@recipe("cat", 3, _CAT, hulls=2, name="animals.cat")
def cat(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.9)
    coat = (
        _Coat("#c97f38", "#ead2b0", "up", None, "long"),
        _Coat("#2a2a2c", "#2a2a2c", "up", "red", "long"),
        _Coat("#8d8a84", "#e6e2da", "up", None, "long"),
    )[variant]
    mass = (4.5, 4.0, 5.2)[variant]
    if variant == 2:
        _sitting_cat(b, coat)
    else:
        _quadruped(b, 0.26, 0.50, 1.25, 0.20, 0.05, coat, 16 if variant == 0 else 8, cat=True)
        if variant == 0:  # tabby stripes over the back
            for x in np.linspace(-0.13, 0.11, 6):
                b.ring(0.0445 if abs(x) < 0.08 else 0.040, 0.006, (float(x), 0, 0.201), "#8a4f1e", (0, 90, 0), 12, 4)
    names = ("A ginger tabby cat, walking", "A black cat with a red collar", "A grey and white cat, sitting")
    built = b.build(names[variant], {"pose": "sitting" if variant == 2 else "walking"}, mass=mass)
    return dataclasses.replace(built, volume=mass / 1000.0)


def _sitting_cat(b: MeshBuilder, coat: _Coat) -> None:
    b.loft(
        [
            np.column_stack([_oval(x, rx, ry), np.full(12, z)])
            for z, x, rx, ry in (
                (0.0, -0.05, 0.10, 0.075),
                (0.06, -0.05, 0.115, 0.095),
                (0.14, -0.015, 0.085, 0.080),
                (0.22, 0.03, 0.062, 0.062),
                (0.29, 0.055, 0.045, 0.045),
            )
        ],
        coat.back,
        crease_deg=60,
    )
    b.ball((0.035, 0.05, 0.09), (0.075, 0, 0.17), coat.belly, segments=10, rings=7)
    for side in (-1, 1):
        b.tube(
            [(0.06, side * 0.035, 0.18), (0.085, side * 0.035, 0.08), (0.09, side * 0.035, 0.015)],
            [0.028, 0.02, 0.018],
            coat.back,
            sides=7,
        )
        b.ball((0.028, 0.02, 0.015), (0.10, side * 0.035, 0.015), coat.belly, segments=8, rings=5)
        b.ball((0.085, 0.04, 0.06), (-0.02, side * 0.075, 0.06), coat.back, segments=9, rings=6)
    b.tube([(0.045, 0, 0.26), (0.075, 0, 0.335)], [0.048, 0.04], coat.back, sides=9)
    _head(b, 0.28, np.array([0.062, 0, 0.325]), 0.05, coat, True)
    b.tube(
        [(-0.14, 0, 0.03), (-0.17, 0.08, 0.025), (-0.08, 0.14, 0.022), (0.04, 0.13, 0.02)],
        [0.022, 0.02, 0.018, 0.012],
        coat.back,
        sides=7,
    )


def _oval(x: float, rx: float, ry: float, points: int = 12) -> np.ndarray:
    a = np.arange(points) * 2 * np.pi / points
    return np.stack([x + rx * np.cos(a), ry * np.sin(a)], 1)


@recipe("bird", 3, _BIRD, hulls=1, name="animals.bird")
def bird(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.7)
    back, belly, head, beak, legs, s = (
        ("#7d838c", "#9aa0a8", "#4d5f6b", "#3a3a3a", "#b8545a", 1.0),
        ("#232428", "#2b2c31", "#1c1d20", "#1a1a1a", "#2a2a2a", 1.25),
        ("#aab1b6", "#f2f2ee", "#f2f2ee", "amber", "#e0a0a0", 1.5),
    )[variant]
    with b.frame(scale=s):
        rows = [
            (-0.125, 0.115, 0.012, 0.010),
            (-0.09, 0.118, 0.034, 0.030),
            (-0.03, 0.125, 0.055, 0.056),
            (0.03, 0.135, 0.058, 0.064),
            (0.075, 0.155, 0.045, 0.050),
            (0.095, 0.185, 0.028, 0.03),
        ]
        b.loft([ring(x, z, w, h, 22) for x, z, w, h in rows], belly, crease_deg=60)
        b.tube([(0.08, 0, 0.165), (0.10, 0, 0.205), (0.108, 0, 0.225)], [0.034, 0.027, 0.025], head, sides=9)
        b.ball((0.033, 0.027, 0.029), (0.115, 0, 0.238), head, segments=10, rings=7)
        b.convex(
            [(0.135, 0.011, 0.242), (0.135, -0.011, 0.242), (0.135, 0, 0.226), (0.180 if variant else 0.168, 0, 0.226)],
            beak,
        )
        for side in (-1, 1):
            b.ball(0.0065, (0.128, side * 0.022, 0.246), "orange" if variant == 0 else "black", segments=6, rings=4)
            # Folded wings, their tips crossing over the tail; a dark bar on the pigeon's.
            b.loft(
                [
                    ring(x, z, w, h) + [0, side * y, 0]
                    for x, z, w, h, y in (
                        (-0.19, 0.128, 0.004, 0.006, 0.018),
                        (-0.10, 0.142, 0.012, 0.030, 0.044),
                        (0.0, 0.150, 0.014, 0.044, 0.054),
                        (0.06, 0.158, 0.008, 0.024, 0.046),
                    )
                ],
                back,
                crease_deg=60,
            )
            b.box((0.02, 0.004, 0.06), (-0.055, side * 0.064, 0.118), shade(back, 0.45), turn_deg=(0, 20, 0))
            b.rod((0.0, side * 0.022, 0.09), (0.012, side * 0.024, 0.012), 0.0055, legs, sides=5)
            for k in (-25, 0, 25):
                a = np.radians(k)
                b.rod(
                    (0.012, side * 0.024, 0.008),
                    (0.012 + 0.04 * np.cos(a), side * 0.024 + 0.04 * np.sin(a), 0.004),
                    0.004,
                    legs,
                    sides=4,
                )
            b.rod((0.012, side * 0.024, 0.008), (-0.012, side * 0.024, 0.004), 0.004, legs, sides=4)
        b.convex(
            [
                (-0.11, -0.022, 0.118),
                (-0.11, 0.022, 0.118),
                (-0.22, -0.036, 0.088),
                (-0.22, 0.036, 0.088),
                (-0.12, 0, 0.108),
                (-0.22, 0, 0.080),
            ],
            shade(back, 0.6),
        )
    mass = (0.33, 0.5, 1.0)[variant]
    names = ("A grey pigeon", "A black crow", "A white gull with grey wings")
    built = b.build(names[variant], {"kind": ("pigeon", "crow", "gull")[variant]}, mass=mass)
    return dataclasses.replace(built, volume=mass / 900.0)
