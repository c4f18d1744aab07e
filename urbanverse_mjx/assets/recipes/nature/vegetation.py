"""Trees, shrubs, flowers and patches of grass."""

import dataclasses

import numpy as np

from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color, mix, shade
from ...meshes.recipe import Physics, recipe
from ...meshes.shapes import Shape
from .foliage import leaf_image, leafy

TREE = Physics(
    ("wood", "leaves"),
    700.0,
    (80.0, 4000.0),
    0.8,
    False,
    "green wood weighs 0.7-1 t per m^3 and is rooted; bark is rough",
)
_SHRUB = Physics(
    ("leaves", "wood"), 20.0, (3.0, 60.0), 0.8, False, "leaves and twigs are mostly air, 10-30 kg per m^3, rooted"
)
_FLOWER = Physics(
    ("leaves", "soil"), 300.0, (2.0, 60.0), 0.7, False, "planted in the ground or in a heavy bowl of wet soil"
)
_GRASS = Physics(("grass", "soil"), 900.0, (10.0, 2000.0), 0.8, False, "turf on soil, part of the ground")


@dataclasses.dataclass(frozen=True)
class _Species:
    """How a broad-leaved tree is built: sizes in m, `crown` = (radius, height of its lowest and highest leaf)."""

    name: str
    crown: tuple[float, float, float]
    trunk: float
    leaves: Color
    bark: Color = "bark"
    clusters: int = 22
    cluster: float = 0.85
    shape: float = 1.0
    flowers: Color | None = None
    forks: int = 5
    grain: float = 1.0


_SPECIES = (
    _Species("lime tree with a round crown", (2.3, 2.2, 6.8), 0.17, "#5f8f3a", clusters=26),
    _Species("plane tree with a wide crown", (3.0, 2.8, 7.6), 0.24, "#6f9440", "#9a917c", 28, 1.0, 0.8, None, 6, 1.2),
    _Species("slender poplar", (0.85, 1.6, 8.6), 0.15, "#4d7f38", "#6d675c", 34, 0.58, 1.6, None, 2),
    _Species("cherry tree in blossom", (1.9, 1.9, 4.8), 0.13, "#e3a3b8", "#5b3f38", 24, 0.62, 0.9, "#fbe6ee", 5),
    _Species("birch with a light crown", (1.6, 2.4, 7.4), 0.11, "#93ad4c", "#e0ded6", 22, 0.62, 1.3, None, 4, 0.8),
    _Species("maple in autumn colours", (2.2, 2.1, 6.2), 0.16, "#cc7a2a", clusters=26, flowers="#b23a22"),
)


def _trunk(b: MeshBuilder, s: _Species, rng: np.random.Generator) -> list[np.ndarray]:
    """Trunk with root flare and forks; returns the ends of the branches."""
    radius, low, high = s.crown
    lean = rng.normal(0, 0.06, 2)
    fork = low + 0.12 * (high - low)
    spine = [
        (0.0, 0.0, -0.02),
        (0.0, 0.0, 0.15),
        (lean[0] * 0.4, lean[1] * 0.4, low * 0.6),
        (lean[0], lean[1], fork),
        (lean[0], lean[1], high * 0.78),
    ]
    t = s.trunk
    b.tube(spine, [t * 1.7, t * 1.15, t * 0.95, t * 0.8, t * 0.18], s.bark, sides=9)
    ends = []
    for k in range(s.forks):
        a = 2 * np.pi * (k + rng.uniform(-0.25, 0.25)) / s.forks
        out = radius * rng.uniform(0.5, 0.75)
        top = fork + (high - fork) * rng.uniform(0.35, 0.65)
        start = np.array([lean[0], lean[1], fork * rng.uniform(0.82, 1.05)])
        end = np.array([out * np.cos(a), out * np.sin(a), top])
        middle = start + (end - start) * [0.55, 0.55, 0.4]
        b.tube([start, middle, end], [t * 0.52, t * 0.36, t * 0.10], s.bark, sides=6)
        ends.append(end)
    return ends


def _broadleaf(b: MeshBuilder, s: _Species, rng: np.random.Generator) -> None:
    radius, low, high = s.crown
    ends = _trunk(b, s, rng)
    if s.bark == "#e0ded6":
        for k in range(9):  # the dark lenticels of birch bark
            a, z = 2.4 * k, 0.25 + 0.24 * k
            r = s.trunk * (1.12 - 0.05 * k)
            b.box((0.012, 0.10, 0.03), (r * np.cos(a), r * np.sin(a), z), "#3a3632", (0, 0, np.degrees(a)))
    image = leaf_image(s.leaves, rng, s.flowers, s.grain)
    middle, half = (low + high) / 2, (high - low) / 2
    # Clusters on a crown-shaped surface, golden-angle spread, some inside; one on every branch's end.
    for k in range(s.clusters):
        f = (k + 0.5) / s.clusters
        up = 1 - 2 * f
        ring = np.sqrt(max(1 - abs(up) ** (2.0 * s.shape), 0.05))
        a = k * 2.39996 + rng.normal(0, 0.15)
        share = rng.uniform(0.62, 0.86)
        at = np.array([radius * ring * share * np.cos(a), radius * ring * share * np.sin(a), middle + up * half * 0.86])
        size = s.cluster * rng.uniform(0.82, 1.25) * (0.8 if up > 0.75 else 1.0)
        leafy(b, at, (size, size, size * 0.72), image, rng, 8, 5, 0.17, float(np.clip(0.5 + 0.5 * up, 0, 1)))
    for end in ends:
        leafy(b, end, (s.cluster, s.cluster, s.cluster * 0.7), image, rng, 8, 5, 0.17, 0.4)
    core = (radius * 0.62, radius * 0.62, half * 0.75)
    leafy(b, (0, 0, middle), core, image, rng, 9, 6, 0.1, 0.15)


def conifer(b: MeshBuilder, height: float, radius: float, color: Color, rng: np.random.Generator) -> None:
    """Layers of drooping skirts with ragged edges."""
    b.tube([(0, 0, -0.02), (0, 0, 0.2), (0, 0, height * 0.9)], [0.17, 0.13, 0.03], "bark", sides=8)
    image = leaf_image(color, rng, None, 0.7)
    layers = 9
    for k in range(layers):
        f = k / (layers - 1)
        z = 0.75 + (height - 1.35) * f
        r = radius * (1 - f) ** 0.85 + 0.16
        points = 13
        a = np.arange(points) * 2 * np.pi / points + rng.random()
        edge = np.where(np.arange(points) % 2 == 0, 1.0, 0.74) * rng.uniform(0.9, 1.08, points) * r
        drop = np.where(np.arange(points) % 2 == 0, -0.16, 0.02) * r
        rim = np.stack([edge * np.cos(a), edge * np.sin(a), z + drop], 1)
        tip = np.array([0.0, 0.0, z + 0.62 * r + 0.42])
        low = np.array([0.0, 0.0, z + 0.12 * r])
        corners = np.array(
            [[rim[i], rim[(i + 1) % points], tip] for i in range(points)]
            + [[rim[(i + 1) % points], rim[i], low] for i in range(points)]
        )
        n = len(corners)
        shade_v = np.concatenate([np.full(points, 0.62), np.full(points, 0.2)])
        u = rng.uniform(0.15, 0.85, n)
        angle = rng.random(n)[:, None] * 6.28 + np.array([0, 2.1, 4.2])
        uv = np.stack([u[:, None] + 0.13 * np.cos(angle), shade_v[:, None] + 0.13 * np.sin(angle)], -1).reshape(-1, 2)
        b.add(Shape(corners.reshape(-1, 3), np.arange(3 * n).reshape(-1, 3), uv), image=image)


def _palm(b: MeshBuilder, height: float, rng: np.random.Generator) -> None:
    """A leaning trunk with rings, and arched fronds folded along their rib."""
    lean = 0.5
    path = [(lean * (f**2), 0.0, height * f) for f in np.linspace(0, 1, 9)]
    b.tube(path, [0.22, 0.17, 0.16, 0.15, 0.145, 0.14, 0.135, 0.13, 0.14], "#8a7358", sides=9)
    for f in np.linspace(0.12, 0.95, 11):
        b.ring(0.152, 0.016, (lean * f**2, 0, height * f), "#6f5a42", segments=9, sides=4)
    image = leaf_image("#5d8f45", rng, None, 0.8)
    top = np.array([lean, 0.0, height])
    for k in range(17):
        a = 2 * np.pi * k / 17 + rng.normal(0, 0.08)
        rise = rng.uniform(-0.15, 0.75)
        length = rng.uniform(1.7, 2.2)
        out = np.array([np.cos(a), np.sin(a), 0.0])
        side = np.array([-np.sin(a), np.cos(a), 0.0])
        steps = np.linspace(0, 1, 6)
        rib = [
            top + out * length * f + np.array([0, 0, length * (rise * f - (0.55 + 0.3 * rise) * f**2)]) for f in steps
        ]
        wide = [0.05, 0.30, 0.36, 0.30, 0.18, 0.02]
        for sign in (1.0, -1.0):
            grid = np.array(
                [[p, p + sign * side * w + np.array([0, 0, -0.45 * w])] for p, w in zip(rib, wide, strict=True)]
            )
            b.sheet(grid if sign < 0 else grid[:, ::-1], image=image, both_sides=True)
    for k in range(5):
        b.ball(
            0.10, tuple(top + [0.18 * np.cos(1.26 * k), 0.18 * np.sin(1.26 * k), -0.18]), "#7a5a30", segments=7, rings=5
        )


@recipe("tree", 8, TREE, hulls=5, name="vegetation.tree")
def tree(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.95)
    if variant < 6:
        species = _SPECIES[variant]
        _broadleaf(b, species, rng)
        name, trunk, height = species.name, species.trunk, species.crown[2]
    elif variant == 6:
        conifer(b, 7.2, 1.75, "#2f5a3c", rng)
        name, trunk, height = "dark green fir", 0.14, 7.2
    else:
        _palm(b, 5.6, rng)
        name, trunk, height = "palm with arched fronds", 0.15, 5.6
    # Stem volume times two (branches, leaves): foresters' form factor of young park trees is about 0.5.
    wood = np.pi * trunk**2 * height * 0.5 * 2
    built = b.build(f"A {name}", {"species": name})
    return dataclasses.replace(built, volume=float(wood))


@recipe("shrub", 4, _SHRUB, hulls=3, name="vegetation.shrub")
def shrub(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.95)
    if variant == 0:  # a rounded bush
        image = leaf_image("leaf", rng)
        leafy(b, (0, 0, 0.45), (0.5, 0.5, 0.45), image, rng, 10, 7, 0.12, 0.4)
        for k in range(12):
            a, f = k * 2.4, k / 12
            out = 0.36 * np.sqrt(1 - f)
            leafy(
                b,
                (out * np.cos(a), out * np.sin(a), 0.25 + 0.62 * f),
                (0.27, 0.27, 0.23),
                image,
                rng,
                8,
                5,
                0.13,
                0.3 + 0.6 * f,
            )
    elif variant == 1:  # a clipped hedge
        image = leaf_image("#3f6f35", rng, None, 0.7)
        for y in np.linspace(-0.85, 0.85, 6):
            for z in (0.22, 0.55, 0.82):
                leafy(b, (rng.normal(0, 0.02), y, z), (0.30, 0.26, 0.24), image, rng, 8, 5, 0.12, z * 0.9)
    elif variant == 2:  # a flowering bush
        image = leaf_image("#4f7f3f", rng, "#d65a8a")
        for k in range(10):
            a, f = k * 2.4, k / 10
            leafy(
                b,
                (0.38 * (1 - f * 0.7) * np.cos(a), 0.38 * (1 - f * 0.7) * np.sin(a), 0.25 + 0.75 * f),
                (0.32, 0.32, 0.28),
                image,
                rng,
                8,
                5,
                0.17,
                0.3 + 0.6 * f,
            )
    else:  # a clipped ball on a low cone
        image = leaf_image("#35633a", rng, None, 0.6)
        leafy(b, (0, 0, 0.42), (0.42, 0.42, 0.42), image, rng, 14, 9, 0.03, 0.5)
        leafy(b, (0, 0, 0.98), (0.26, 0.26, 0.26), image, rng, 12, 8, 0.03, 0.7)
        b.cylinder(0.04, 0.6, (0, 0, 0.3), "bark", segments=6)
    names = ("A rounded green bush", "A clipped hedge", "A bush with pink blossoms", "A topiary of two balls")
    built = b.build(names[variant], {"kind": ("round", "hedge", "flowering", "topiary")[variant]})
    return dataclasses.replace(built, volume=(0.7, 1.1, 0.9, 0.4)[variant])


def _blossom(b: MeshBuilder, at: np.ndarray, radius: float, color: Color, kind: str, rng: np.random.Generator) -> None:
    if kind == "tulip":
        b.lathe(
            [
                (radius * 0.3, 0),
                (radius * 0.75, radius * 0.6),
                (radius * 0.7, radius * 1.4),
                (radius * 0.45, radius * 1.9),
                (radius * 0.2, radius * 1.5),
            ],
            at,
            color,
            segments=6,
        )
        return
    tilt = rng.normal(0, 14, 2)
    with b.frame(tuple(at), (float(tilt[0]), float(tilt[1]), float(rng.uniform(0, 60)))):
        for k in range(6):
            a = np.pi * k / 3
            c, s = np.cos(a), np.sin(a)
            tip = (radius * c, radius * s, radius * 0.25)
            left, right = (
                (radius * 0.6 * np.cos(a - 0.45), radius * 0.6 * np.sin(a - 0.45), radius * 0.16),
                (radius * 0.6 * np.cos(a + 0.45), radius * 0.6 * np.sin(a + 0.45), radius * 0.16),
            )
            b.quad([(0, 0, 0), left, tip, right], color, both_sides=True)
        b.ball((radius * 0.3, radius * 0.3, radius * 0.2), (0, 0, radius * 0.08), "amber", segments=6, rings=4)


@recipe("flower", 4, _FLOWER, hulls=1, name="vegetation.flower")
def flower(variant: int, rng: np.random.Generator) -> BuiltAsset:
    b = MeshBuilder(roughness=0.9)
    color, kind = (("red", "tulip"), ("yellow", "daisy"), ("purple", "daisy"), ("pink", "tulip"))[variant]
    radius = (0.34, 0.38, 0.40, 0.30)[variant]
    if variant in (0, 2):
        b.lathe([(radius * 1.15, 0), (radius * 1.2, 0.10), (radius, 0.12)], color="soil", segments=14)
        base = 0.10
    else:
        pot = ("terracotta", "concrete")[variant // 2]
        b.lathe(
            [
                (radius * 0.7, 0),
                (radius * 1.05, 0.36),
                (radius * 1.12, 0.36),
                (radius * 1.12, 0.42),
                (radius * 0.95, 0.42),
                (radius * 0.92, 0.38),
            ],
            color=pot,
            segments=16,
        )
        b.cylinder(radius * 0.93, 0.02, (0, 0, 0.37), "soil", segments=14)
        base = 0.37
    image = leaf_image("leaf", rng)
    for k in range(5):
        a = 2 * np.pi * k / 5
        leafy(
            b,
            (radius * 0.5 * np.cos(a), radius * 0.5 * np.sin(a), base + 0.07),
            (radius * 0.45, radius * 0.45, 0.10),
            image,
            rng,
            7,
            4,
            0.2,
            0.5,
        )
    for k in range(15):
        r, a = radius * np.sqrt((k + 0.5) / 15) * 0.85, k * 2.39996
        tall = base + rng.uniform(0.24, 0.38)
        foot, top = (
            np.array([r * 0.7 * np.cos(a), r * 0.7 * np.sin(a), base]),
            np.array([r * np.cos(a), r * np.sin(a), tall]),
        )
        b.rod(foot, top, 0.006, "leaf", sides=3)
        _blossom(
            b, top, 0.062 if kind == "daisy" else 0.042, mix(color, "white", float(rng.uniform(0, 0.3))), kind, rng
        )
    names = (
        "A bed of red tulips",
        "A terracotta bowl of yellow flowers",
        "A bed of purple flowers",
        "A concrete planter of pink tulips",
    )
    return b.build(names[variant], {"kind": kind, "color": color})


@recipe("grass patch", 3, _GRASS, hulls=1, name="vegetation.grass_patch")
def grass_patch(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Flat enough to roll over: at most 3 cm."""
    b = MeshBuilder(roughness=1.0)
    color = ("grass", "#6f8f3e", "#9a9a52")[variant]
    image = leaf_image(color, rng, ("white" if variant == 1 else None), 0.45)
    radius = (1.0, 1.3, 0.8)[variant]
    a = np.arange(22) * 2 * np.pi / 22
    edge = radius * (1 + 0.10 * np.sin(3 * a + rng.random() * 6) + 0.05 * np.sin(7 * a + rng.random() * 6))
    squash = (1.0, 0.62, 0.9)[variant]
    rings = [
        np.stack([edge * f * np.cos(a), edge * f * squash * np.sin(a), np.full(22, z)], 1)
        for f, z in ((1.0, 0.0), (0.96, 0.016), (0.6, 0.022), (0.25, 0.025))
    ]
    points = np.concatenate([*rings, [[0, 0, 0.025]]])
    faces = [(22 * i + j, 22 * i + (j + 1) % 22, 22 * (i + 1) + (j + 1) % 22) for i in range(3) for j in range(22)]
    faces += [(22 * i + j, 22 * (i + 1) + (j + 1) % 22, 22 * (i + 1) + j) for i in range(3) for j in range(22)]
    faces += [(66 + j, 66 + (j + 1) % 22, 88) for j in range(22)]
    uv = np.clip(0.5 + 0.46 * points[:, :2] / edge.max(), 0.02, 0.98)
    b.add(Shape(points, np.array(faces), uv), image=image)
    for _ in range(60):  # tufts
        r, t = radius * np.sqrt(rng.random()) * 0.85, rng.random() * 2 * np.pi
        at = np.array([r * np.cos(t), r * squash * np.sin(t), 0.016])
        w = rng.normal(0, 0.014, 2)
        tips = at + [w[0] * 1.5, w[1] * 1.5, 0.0135]
        b.add(
            Shape(np.array([at - [w[1], -w[0], 0], at + [w[1], -w[0], 0], tips]), np.array([(0, 1, 2), (0, 2, 1)])),
            shade(color, float(rng.uniform(0.8, 1.25))),
        )
    names = ("A round patch of grass", "A patch of grass with daisies", "A patch of dry grass")
    return b.build(names[variant], {"color": str(color)})
