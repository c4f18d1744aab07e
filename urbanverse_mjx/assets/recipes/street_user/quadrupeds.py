"""Four-legged animals from a few measures each: horse, donkey, cow, sheep, deer, and wild ones."""

import dataclasses

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, mix, shade
from ...meshes.recipe import recipe
from ..shared.sizes import fitted
from .animals import ring

Row = tuple[float, float, float, float]
Bone = tuple[float, float, float]


@dataclasses.dataclass(frozen=True)
class Beast:
    """Measures as shares of the withers' height, in the plane of symmetry, x forwards.

    trunk: (x, z, half width, half height) rear to front; neck and head: (x, z, radius) along their middle lines;
    front and hind: (x, z, radius) of a leg's joints from the top down; stance: half the distance between legs;
    ears: (length, width, backward tilt in degrees); tail: (x, z, radius).
    """

    trunk: tuple[Row, ...]
    neck: tuple[Bone, ...]
    head: tuple[Bone, ...]
    front: tuple[Bone, ...]
    hind: tuple[Bone, ...]
    stance: float
    ears: tuple[float, float, float]
    tail: tuple[Bone, ...]
    slim: float = 0.68


HORSE = Beast(
    trunk=(
        (-0.56, 0.80, 0.03, 0.05),
        (-0.50, 0.80, 0.13, 0.15),
        (-0.34, 0.79, 0.165, 0.20),
        (-0.05, 0.75, 0.17, 0.20),
        (0.22, 0.75, 0.16, 0.215),
        (0.40, 0.78, 0.12, 0.18),
        (0.48, 0.80, 0.04, 0.07),
    ),
    neck=((0.34, 0.84, 0.17), (0.48, 1.00, 0.13), (0.58, 1.14, 0.10), (0.62, 1.19, 0.085)),
    head=((0.57, 1.19, 0.07), (0.66, 1.16, 0.088), (0.78, 1.04, 0.068), (0.88, 0.94, 0.055), (0.90, 0.92, 0.03)),
    front=((0.30, 0.70, 0.085), (0.31, 0.45, 0.052), (0.31, 0.40, 0.042), (0.30, 0.13, 0.030), (0.32, 0.07, 0.036)),
    hind=((-0.38, 0.76, 0.13), (-0.34, 0.56, 0.085), (-0.46, 0.42, 0.045), (-0.44, 0.14, 0.032), (-0.41, 0.07, 0.038)),
    stance=0.10,
    ears=(0.10, 0.035, -10),
    tail=((-0.53, 0.88, 0.03), (-0.62, 0.74, 0.05), (-0.63, 0.45, 0.055), (-0.61, 0.30, 0.02)),
)
COW = Beast(
    trunk=(
        (-0.66, 0.86, 0.04, 0.06),
        (-0.60, 0.82, 0.17, 0.16),
        (-0.40, 0.76, 0.21, 0.23),
        (-0.05, 0.68, 0.25, 0.28),
        (0.28, 0.72, 0.20, 0.26),
        (0.46, 0.74, 0.15, 0.20),
        (0.54, 0.76, 0.06, 0.10),
    ),
    neck=((0.40, 0.80, 0.18), (0.58, 0.86, 0.14), (0.70, 0.92, 0.11)),
    head=((0.64, 0.98, 0.09), (0.74, 0.95, 0.105), (0.88, 0.85, 0.085), (0.99, 0.77, 0.075), (1.02, 0.75, 0.05)),
    front=((0.34, 0.62, 0.10), (0.35, 0.36, 0.06), (0.34, 0.32, 0.052), (0.34, 0.12, 0.038), (0.36, 0.06, 0.045)),
    hind=((-0.50, 0.70, 0.15), (-0.46, 0.48, 0.09), (-0.56, 0.34, 0.05), (-0.54, 0.12, 0.038), (-0.51, 0.06, 0.045)),
    stance=0.13,
    ears=(0.13, 0.045, 70),
    tail=((-0.65, 0.94, 0.025), (-0.71, 0.80, 0.018), (-0.71, 0.40, 0.015), (-0.70, 0.26, 0.035)),
    slim=0.8,
)
DEER = Beast(
    trunk=(
        (-0.55, 0.84, 0.03, 0.05),
        (-0.48, 0.82, 0.13, 0.14),
        (-0.30, 0.78, 0.15, 0.17),
        (0.0, 0.74, 0.145, 0.17),
        (0.28, 0.76, 0.13, 0.19),
        (0.42, 0.80, 0.09, 0.14),
        (0.48, 0.83, 0.03, 0.05),
    ),
    neck=((0.38, 0.86, 0.13), (0.50, 1.02, 0.09), (0.57, 1.20, 0.07)),
    head=((0.53, 1.24, 0.065), (0.60, 1.24, 0.075), (0.72, 1.17, 0.05), (0.80, 1.12, 0.036), (0.82, 1.11, 0.02)),
    front=((0.30, 0.68, 0.07), (0.31, 0.42, 0.038), (0.31, 0.36, 0.030), (0.30, 0.12, 0.022), (0.32, 0.05, 0.028)),
    hind=((-0.38, 0.76, 0.12), (-0.32, 0.52, 0.065), (-0.46, 0.40, 0.034), (-0.43, 0.12, 0.024), (-0.40, 0.05, 0.030)),
    stance=0.08,
    ears=(0.15, 0.045, 55),
    tail=((-0.53, 0.90, 0.03), (-0.58, 0.84, 0.035), (-0.59, 0.77, 0.015)),
)
SHEEP = dataclasses.replace(
    COW,
    neck=((0.40, 0.86, 0.17), (0.52, 1.00, 0.13), (0.58, 1.08, 0.10)),
    head=((0.55, 1.14, 0.085), (0.64, 1.12, 0.10), (0.76, 1.03, 0.08), (0.84, 0.96, 0.06), (0.87, 0.94, 0.035)),
    ears=(0.15, 0.05, 78),
    tail=((-0.64, 0.90, 0.06), (-0.70, 0.80, 0.06), (-0.71, 0.62, 0.03)),
    stance=0.12,
)


def beast(
    b: MeshBuilder, m: Beast, s: float, coat: Color, legs: Color, muzzle: Color, hoof: Color, stride: float
) -> None:
    """The animal, `s` m at the withers. legs: colour of the legs; stride: how far feet swing, as a share of `s`."""
    b.loft([ring(x * s, z * s, w * s, h * s) for x, z, w, h in m.trunk], coat, crease_deg=70)
    with b.frame(scale=(1, m.slim, 1)):
        b.tube([(x * s, 0, z * s) for x, z, _ in m.neck], [r * s for *_, r in m.neck], coat, sides=10)
        skull = m.head[:-2]
        b.tube([(x * s, 0, z * s) for x, z, _ in skull], [r * s for *_, r in skull], coat, sides=10)
        nose = m.head[-3:]
        b.tube([(x * s, 0, z * s) for x, z, _ in nose], [r * s * 1.03 for *_, r in nose], muzzle, sides=10)
    for joints, phase in ((m.front, 1.0), (m.hind, -1.0)):
        for side in (1, -1):
            swing = stride * phase * side
            low = joints[-1][1]
            top = joints[0][1]
            path = [(x + swing * ((top - z) / (top - low)) ** 1.3, side * m.stance, z) for x, z, _ in joints]
            b.tube(np.array(path) * s, [r * s for *_, r in joints], legs, sides=8)
            x, y, z = np.array(path[-1]) * s
            with b.frame((x + 0.01 * s, y, 0)):
                r = joints[-1][2] * s
                b.cylinder(r * 1.35, z + 0.01 * s, color=hoof, top_radius=r * 1.0, segments=8)
    crown = m.head[1]
    length, wide, tilt = m.ears
    for side in (-1, 1):
        root = np.array([crown[0] - 0.03, side * crown[2] * m.slim * 0.75, crown[1] + crown[2] * 0.6]) * s
        a, t = np.radians(tilt), np.array([-0.12, side * np.sin(np.radians(abs(tilt) * 0.9)), np.cos(np.radians(tilt))])
        tip = root + t / np.linalg.norm(t) * length * s
        across = np.array([np.cos(a * 0.2), 0, 0.0]) * wide * s
        mid = (root + tip) / 2
        b.convex([root, tip, mid + across, mid - across, mid + [0, side * 0.012 * s, 0.01 * s]], shade(coat, 0.85))
        eye = np.array([crown[0] + 0.035, side * (crown[2] * m.slim * 0.86), crown[1] + 0.01]) * s
        b.ball(0.016 * s, tuple(eye), "#17120e", segments=6, rings=4)
    b.tube([(x * s, 0, z * s) for x, z, _ in m.tail], [r * s for *_, r in m.tail], shade(coat, 0.8), sides=6)


def patches(b: MeshBuilder, m: Beast, s: float, color: Color, spots: tuple[tuple[float, float, float], ...]) -> None:
    """Patches on both flanks: (x, angle from the back in degrees, size), as flat ellipsoids let into the skin."""
    table = np.array(m.trunk)
    for k, (x, angle, size) in enumerate(spots):
        z, w, h = (float(np.interp(x, table[:, 0], table[:, j])) for j in (1, 2, 3))
        a = np.radians(angle)
        at = np.array([x, w * np.sin(a) * 0.97, z + h * np.cos(a) * 0.97]) * s
        b.ball((size * s, size * 0.8 * s, 0.03 * s), tuple(at), color, (-angle, 0, 20.0 * k), segments=10, rings=5)


def mane(b: MeshBuilder, m: Beast, s: float, color: Color, rise: float = 0.05) -> None:
    line = [(x - r * 0.55, z + r * 0.75) for x, z, r in m.neck[1:]] + [
        (m.head[1][0] + 0.02, m.head[1][1] + m.head[1][2])
    ]
    start = (m.neck[0][0] - 0.06, m.neck[0][1] + m.neck[0][2] * 0.9)
    outer = [(x - rise * 0.8, z + rise * 0.7) for x, z in (start, *line)]
    inner = [(x + 0.05, z - 0.05) for x, z in (start, *line)][::-1]
    b.profile([(x * s, z * s) for x, z in (*outer, *inner)], 0.045 * s, (0, 0, 0), color)


@recipe("horse", 3, name="beasts.horse")
def horse(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.8)
    coat, dark = (("#7a4526", "#1d1612"), ("#d8d3ca", "#8f8a84"), ("#241d1a", "#0f0c0b"))[variant]
    beast(
        b,
        HORSE,
        1.6,
        coat,
        coat if variant == 1 else shade(coat, 0.6),
        shade(coat, 0.6),
        "#2a241f",
        (0.10, 0.0, 0.16)[variant],
    )
    mane(b, HORSE, 1.6, dark)
    b.tube([(x * 1.6, 0, z * 1.6) for x, z, _ in HORSE.tail], [0.05, 0.09, 0.10, 0.03], dark, sides=7)
    if variant == 0:
        b.ball((0.02, 0.045, 0.09), (1.16, 0, 1.82), "white", (0, 42, 0), segments=8, rings=5)
    names = ("A brown horse, walking", "A grey horse, standing", "A black horse, trotting")
    return fitted(
        b.build(names[variant], {"coat": coat}), ((2.40, 0.60, 1.84), (2.35, 0.58, 1.90), (2.6, 0.62, 1.95))[variant]
    )


@recipe("donkey", 2, name="beasts.donkey")
def donkey(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.9)
    coat = ("#8d867d", "#6b4d38")[variant]
    m = dataclasses.replace(
        HORSE, ears=(0.26, 0.05, -14), tail=((-0.53, 0.86, 0.02), (-0.60, 0.70, 0.016), (-0.60, 0.42, 0.035))
    )
    neck = tuple((x * 0.97, 0.84 + (z - 0.84) * 0.85, r) for x, z, r in m.neck)
    head = tuple((x * 0.97, z - 0.055, r * 1.12) for x, z, r in m.head)
    m = dataclasses.replace(m, neck=neck, head=head)
    beast(b, m, 1.12, coat, shade(coat, 1.15), "#e4ddd0", "#2a241f", 0.06)
    mane(b, m, 1.12, shade(coat, 0.5), 0.03)
    b.ball((0.50, 0.10, 0.05), (-0.05, 0, 1.03), shade(coat, 0.6), segments=10, rings=5)  # the dark line along the back
    names = ("A grey donkey", "A brown donkey")
    return fitted(b.build(names[variant], {"coat": coat}), ((1.65, 0.46, 1.40), (1.8, 0.5, 1.5))[variant])


@recipe("cow", 3, name="beasts.cow")
def cow(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.85)
    coat, spot, nose = (
        ("#e9e5dc", "#1f1c1a", "#d8a098"),
        ("#8a4a28", "#e9dfd0", "#caa08c"),
        ("#b79468", "#b79468", "#3a3230"),
    )[variant]
    s = 1.42
    beast(b, COW, s, coat, coat, nose, "#2a241f", 0.05)
    if variant < 2:
        spots = (
            (-0.45, 50, 0.22),
            (-0.05, -40, 0.24),
            (0.12, 60, 0.20),
            (0.32, -60, 0.18),
            (-0.35, -80, 0.16),
            (-0.2, 5, 0.18),
        )
        patches(b, COW, s, spot, spots if variant == 0 else spots[:3])
    b.ball((0.17, 0.16, 0.12), (-0.42 * s, 0, 0.42 * s), "#d8a098", segments=10, rings=6)  # the udder
    for side in (-1, 1):
        b.rod((-0.40 * s, side * 0.06, 0.38 * s), (-0.40 * s, side * 0.07, 0.30 * s), 0.016, "#d8a098", sides=5)
        horn = [(0.72, 0.07, 1.04), (0.72, 0.15, 1.07), (0.77, 0.19, 1.13)]
        b.tube([(x * s, side * y * s, z * s) for x, y, z in horn], [0.032, 0.026, 0.008], "cream", sides=6)
    if variant == 2:  # a bell on a strap
        b.ring(0.17, 0.018, (0.60 * s, 0, 0.88 * s), "dark red", (0, 60, 0), 16, 5)
        b.lathe([(0.085, 0), (0.075, 0.1), (0.03, 0.14)], (0.66 * s, 0, 0.66 * s), "brass", segments=10)
    names = ("A black and white dairy cow", "A brown cow with white patches", "A fawn cow with a bell")
    size = ((2.45, 0.86, 1.48), (2.3, 0.84, 1.42), (2.4, 0.78, 1.5))[variant]
    return fitted(b.build(names[variant], {"coat": coat}), size)


@recipe("sheep", 3, name="beasts.sheep")
def sheep(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=1.0)
    wool, face = (("#e6dfd0", "#2b2724"), ("#efe9dc", "#e0cdb8"), ("#4a4038", "#2b2522"))[variant]
    s = 0.72
    beast(b, SHEEP, s, face, face, shade(face, 0.9), "#241f1b", 0.04)
    table = np.array(SHEEP.trunk)
    for x in np.linspace(-0.60, 0.50, 6):  # fleece: overlapping balls over the trunk
        z, w, h = (float(np.interp(x, table[:, 0], table[:, j])) for j in (1, 2, 3))
        for a in np.radians((-100, -50, 0, 50, 100)):
            at = (x * s, w * np.sin(a) * s * 0.95, (z + h * np.cos(a) * 0.85) * s)
            r = float(rng.uniform(0.185, 0.22)) * s
            b.ball((r, r * 0.9, r * 0.85), at, shade(wool, float(rng.uniform(0.94, 1.03))), segments=7, rings=5)
    b.ball((0.19 * s, 0.15 * s, 0.19 * s), (0.50 * s, 0, 1.0 * s), wool, segments=8, rings=6)
    if variant != 0:
        b.ball((0.09 * s, 0.09 * s, 0.06 * s), (0.60 * s, 0, 1.21 * s), wool, segments=8, rings=5)
    if variant == 2:
        for side in (-1, 1):  # a ram's curled horns
            turn = np.radians(np.linspace(100, -220, 9))
            path = [
                ((0.60 + 0.13 * np.cos(t) - 0.05) * s, side * (0.09 + 0.012 * k) * s, (1.12 + 0.13 * np.sin(t)) * s)
                for k, t in enumerate(turn)
            ]
            b.tube(path, list(np.linspace(0.045, 0.012, 9) * s), "beige", sides=6)
    names = ("A white sheep with a black face", "A cream ewe", "A dark ram with curled horns")
    return fitted(
        b.build(names[variant], {"wool": wool}), ((1.25, 0.46, 0.92), (1.18, 0.46, 0.90), (1.35, 0.50, 1.0))[variant]
    )


def antlers(b: MeshBuilder, m: Beast, s: float, reach: float) -> None:
    x, z, r = m.head[1]
    for side in (-1, 1):
        root = np.array([x - 0.03, side * r * 0.4, z + r * 0.7])
        beam = [
            root + reach * np.array(p) * [1, side, 1]
            for p in ((0, 0, 0), (-0.10, 0.16, 0.22), (-0.16, 0.32, 0.50), (-0.02, 0.36, 0.85))
        ]
        b.tube(np.array(beam) * s, list(np.array([0.026, 0.022, 0.018, 0.008]) * s), "bark", sides=6)
        for k, tine in ((1, (0.22, 0.06, 0.14)), (2, (0.26, 0.02, 0.18)), (2, (-0.16, 0.08, 0.22))):
            tip = beam[k] + reach * np.array(tine) * [1, side, 1]
            b.tube([beam[k] * s, tip * s], [0.016 * s, 0.006 * s], "bark", sides=5)


@recipe("deer", 3, name="beasts.deer")
def deer(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.9)
    coat, s = (("#a0673a", 0.95), ("#8a5a34", 1.15), ("#b4753f", 0.85))[variant]
    beast(b, DEER, s, coat, shade(coat, 0.9), "#3a2c24", "#1d1814", (0.05, 0.0, 0.12)[variant])
    b.ball((0.05 * s, 0.07 * s, 0.09 * s), (-0.55 * s, 0, 0.80 * s), "off white", segments=8, rings=5)
    b.ball((0.30 * s, 0.10 * s, 0.05 * s), (0.0, 0, 0.60 * s), mix(coat, "white", 0.6), segments=10, rings=5)
    if variant != 2:
        antlers(b, DEER, s, (0.34, 0.62)[variant])
    else:  # a doe with a spotted back
        for k in range(10):
            spot = (-0.4 + 0.08 * k, (35 if k % 2 else 55) * (-1) ** (k // 2), 0.022)
            patches(b, DEER, s, "off white", (spot,))
    names = ("A roebuck with short antlers", "A red stag with large antlers", "A spotted doe, walking")
    size = ((1.55, 0.46, 1.40), (1.85, 0.86, 2.05), (1.35, 0.34, 1.18))[variant]
    return fitted(b.build(names[variant], {"coat": coat}), size)


@recipe("wildlife", 3, name="beasts.wildlife")
def wildlife(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.95)
    if variant == 0:  # a wild boar
        s = 0.72
        m = dataclasses.replace(
            COW,
            neck=((0.36, 0.80, 0.22), (0.52, 0.74, 0.20), (0.64, 0.70, 0.16)),
            head=((0.56, 0.76, 0.15), (0.66, 0.72, 0.16), (0.82, 0.58, 0.10), (0.95, 0.48, 0.075), (0.98, 0.46, 0.06)),
            ears=(0.16, 0.06, -20),
            tail=((-0.65, 0.82, 0.02), (-0.72, 0.70, 0.012), (-0.72, 0.52, 0.018)),
        )
        beast(b, m, s, "#4a3c30", "#332a22", "#6a5648", "#1a1512", 0.07)
        ridge = [(-0.55, 0.95), (-0.1, 1.02), (0.3, 1.06), (0.55, 0.98), (0.5, 0.86), (-0.5, 0.86)]
        b.profile([(x * s, z * s) for x, z in ridge], 0.06 * s, (0, 0, 0), "#2a211a")
        for side in (-1, 1):
            b.tube(
                [(0.86 * s, side * 0.06 * s, 0.50 * s), (0.92 * s, side * 0.10 * s, 0.56 * s)],
                [0.014 * s, 0.004 * s],
                "cream",
                sides=5,
            )
        return fitted(b.build("A wild boar", {"kind": "boar"}), (1.18, 0.42, 0.80))
    if variant == 1:  # a red fox
        s = 0.40
        m = dataclasses.replace(
            DEER,
            neck=((0.40, 0.86, 0.13), (0.52, 0.94, 0.11), (0.58, 1.0, 0.10)),
            head=(
                (0.54, 1.04, 0.10),
                (0.64, 1.03, 0.115),
                (0.78, 0.96, 0.06),
                (0.90, 0.92, 0.03),
                (0.93, 0.915, 0.015),
            ),
            ears=(0.19, 0.07, 8),
            tail=((-0.52, 0.84, 0.05), (-0.78, 0.66, 0.11), (-1.05, 0.50, 0.12), (-1.22, 0.44, 0.04)),
        )
        beast(b, m, s, "#c2622a", "#2c211b", "#efe6da", "#1a1512", 0.12)
        b.tube([(-1.10 * s, 0, 0.485 * s), (-1.26 * s, 0, 0.43 * s)], [0.10 * s, 0.02 * s], "white", sides=8)
        b.ball((0.09 * s, 0.09 * s, 0.12 * s), (0.47 * s, 0, 0.80 * s), "white", segments=8, rings=6)
        b.ball(0.022 * s, (0.935 * s, 0, 0.925 * s), "black", segments=6, rings=4)
        return fitted(b.build("A red fox with a white-tipped tail", {"kind": "fox"}), (0.95, 0.165, 0.46))
    s = 1.0  # a brown bear
    m = dataclasses.replace(
        COW,
        trunk=tuple((x, z - 0.02, w * 1.25, h * 1.12) for x, z, w, h in COW.trunk),
        neck=((0.40, 0.80, 0.24), (0.56, 0.84, 0.20), (0.66, 0.86, 0.17)),
        head=((0.60, 0.90, 0.17), (0.72, 0.88, 0.18), (0.86, 0.80, 0.10), (0.96, 0.76, 0.075), (0.99, 0.755, 0.05)),
        front=((0.36, 0.64, 0.17), (0.37, 0.36, 0.11), (0.36, 0.30, 0.10), (0.37, 0.12, 0.09), (0.42, 0.05, 0.09)),
        hind=((-0.48, 0.66, 0.19), (-0.44, 0.44, 0.14), (-0.52, 0.30, 0.10), (-0.50, 0.12, 0.09), (-0.45, 0.05, 0.09)),
        stance=0.17,
        ears=(0.09, 0.07, 30),
        tail=((-0.66, 0.84, 0.06), (-0.72, 0.78, 0.03)),
    )
    beast(b, m, s, "#5a3b24", "#4a3020", "#8a6a4c", "#1d1612", 0.08)
    b.ball((0.30, 0.19, 0.12), (0.26, 0, 0.93), "#5a3b24", segments=10, rings=6)
    b.ball((0.03, 0.045, 0.03), (1.0, 0, 0.79), "black", segments=6, rings=4)
    return fitted(b.build("A brown bear", {"kind": "bear"}), (1.75, 0.72, 1.1))
