"""Shellfish on a fishmonger's ice: crabs, lobsters, shrimps, oysters. Heads towards +x."""

import numpy as np

from ....meshes import shapes
from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ...shared.forms import lumpy, painted, pillow
from ...shared.sizes import varied_cm
from ...shared.skins import skin


def claw(b: MeshBuilder, at: tuple[float, float, float], length: float, yaw: float, color: Color) -> None:
    """Two pincers, open, pointing along their own x."""
    with b.frame(at, (0, 0, yaw)):
        b.add(
            pillow((length * 0.75, length * 0.5, length * 0.36), 0.8, 0.8, 14, 6),
            color,
            (length * 0.3, 0, -length * 0.18),
        )
        for side in (-1, 1):
            path = [
                (length * 0.5, side * length * 0.14, 0),
                (length * 0.8, side * length * 0.24, 0),
                (length * 1.1, side * length * 0.06, 0),
            ]
            b.tube(path, [length * 0.13, length * 0.1, length * 0.02], shade(color, 0.9), sides=6)


def crab(b: MeshBuilder, shell: np.ndarray, color: Color, rng: np.random.Generator) -> None:
    """Broad shell, eight legs to the sides, claws and stalked eyes to the front."""
    body = lumpy(pillow((9, 13, 4.4), 0.8, 0.75, 22, 10), 0.03, rng, 2)
    b.add(painted(body), image=shell, at=(0, 0, 1.2), crease_deg=80)
    for side in (-1, 1):
        for k in range(4):
            x, reach = 2.6 - 2.2 * k, (6.4, 7.2, 7.0, 6.0)[k]
            path = [
                (x, side * 5.4, 2.8),
                (x - 0.5 * k + 1.0, side * (5.4 + reach * 0.5), 5.2),
                (x - 1.1 * k + 1.2, side * (5.6 + reach * 0.85), 3.0),
                (x - 1.4 * k + 1.2, side * (5.6 + reach), 0.1),
            ]
            b.tube(path, [0.7, 0.62, 0.5, 0.12], shade(color, 0.92), sides=6)
        b.tube(
            [(3.6, side * 4.4, 2.8), (6.4, side * 6.8, 3.6), (8.0, side * 6.2, 3.2)],
            [0.9, 0.95, 0.9],
            color,
            sides=7,
        )
        claw(b, (8.0, side * 6.0, 3.0), 5.2, -side * 28, color)
        b.tube([(4.2, side * 1.3, 3.6), (4.9, side * 1.5, 4.8)], 0.25, color, sides=5)
        b.ball(0.42, (4.9, side * 1.5, 5.0), "black", segments=7, rings=5)


def lobster(b: MeshBuilder, shell: np.ndarray, color: Color) -> None:
    """Long shell, tail of six rings with its fan, claws, long feelers."""
    b.add(painted(pillow((13, 6.2, 5.0), 0.7, 0.8, 18, 8)), image=shell, at=(4, 0, 0.8))
    for k in range(6):
        b.add(
            pillow((3.0, 5.6 - 0.35 * k, 4.2 - 0.3 * k), 0.6, 0.8, 14, 6),
            shade(color, 1.0 - 0.06 * (k % 2)),
            (-3.2 - 2.2 * k, 0, 0.6),
        )
    for yaw in (-50, -25, 0, 25, 50):
        b.add(
            pillow((4.6, 2.0, 0.5), 0.7, 0.8, 10, 4),
            shade(color, 0.9),
            (-16.6 - 1.6 * np.cos(np.radians(yaw)), -2.6 * np.sin(np.radians(yaw)), 0.7),
            turn_deg=(0, 0, yaw),
        )
    for side in (-1, 1):
        b.tube([(9, side * 2.2, 2.4), (11.5, side * 5.0, 2.6), (14, side * 5.4, 2.4)], [0.9, 0.8, 0.9], color, sides=7)
        claw(b, (14, side * 5.3, 2.2), 8.5, -side * 6, color)
        b.tube(
            [(10.2, side * 0.8, 3.6), (15, side * 2.2, 6.5), (22, side * 6.5, 7.4), (27, side * 11, 6.2)],
            [0.3, 0.22, 0.15, 0.06],
            shade(color, 0.8),
            sides=5,
        )
        b.ball(0.5, (10.0, side * 1.3, 4.4), "black", segments=7, rings=5)
        for k in range(4):
            x = 7 - 2.2 * k
            b.tube(
                [(x, side * 2.6, 2.0), (x + 0.4, side * 6.0, 3.4), (x - 0.6, side * 8.6, 0.1)],
                [0.42, 0.36, 0.1],
                shade(color, 0.9),
                sides=5,
            )


def shrimp(b: MeshBuilder, shell: np.ndarray, color: Color) -> None:
    """Curled on its side: rings that get smaller, a tail fan, feelers, legs inside the curl."""
    s = np.linspace(0, 1, 9)
    turn = np.radians(20 + 210 * s)
    for k in range(8):
        r = 2.7 - 0.26 * k
        c = np.array([4.6 * np.cos(turn[k]), 4.6 * np.sin(turn[k])])
        b.add(
            painted(pillow((4.6 if k == 0 else 2.9, r, r * 0.95), 0.6, 0.9, 12, 6), 0),
            image=shell,
            at=(c[0], c[1], 1.5 - r * 0.475),
            turn_deg=(0, 0, float(np.degrees(turn[k]) + 90)),
        )
    tip = np.array([4.6 * np.cos(turn[8]), 4.6 * np.sin(turn[8])])
    for d in (-0.5, 0.0, 0.5):
        b.add(
            pillow((2.6, 0.9, 0.3), 0.7, 0.8, 8, 4),
            shade(color, 0.85),
            (tip[0] + 0.5 - d, tip[1] - 1.0, 1.3),
            turn_deg=(0, 0, -60 + 50 * d),
        )
    head = np.array([4.6 * np.cos(turn[0]), 4.6 * np.sin(turn[0])])
    spike = [(head[0], head[1], 2.6), (head[0] + 0.6, head[1] - 1.6, 2.5), (head[0] + 0.7, head[1] - 4.6, 2.9)]
    b.tube(spike, [0.7, 0.55, 0.05], shade(color, 0.9), sides=6)
    for d in (-0.4, 0.4):
        b.tube(
            [
                (head[0] + 0.6, head[1] - 1.2, 1.5 + d),
                (head[0] + 1.8, head[1] - 4.0, 2.2 + d),
                (head[0] + 0.8, head[1] - 8, 1.4 + d),
            ],
            [0.15, 0.1, 0.04],
            shade(color, 0.8),
            sides=4,
        )
        b.ball(0.34, (head[0] + 0.4, head[1] - 1.3, 1.6 + 2.2 * d), "black", segments=6, rings=4)
    for k in range(5):
        c = np.array([np.cos(turn[k]), np.sin(turn[k])])
        b.tube(
            [(*(3.6 * c), 0.9), (*(2.2 * c), 0.6), (*(1.6 * c), 0.2)],
            [0.25, 0.2, 0.06],
            shade(color, 0.85),
            sides=4,
        )


@recipe("crustacean", 3, name="seafood.crustacean")
def crustacean(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A crab with two claws and eight legs, a lobster, a curled shrimp."""
    b = MeshBuilder(roughness=0.4)
    style = ("crab", "lobster", "shrimp")[variant % 3]
    color: Color = ("#d05a2c", "#b0301f", "#ee9a78")[variant % 3]
    shell = skin(rng, [shade(color, 1.25), color, shade(color, 0.9)], noise=8, flecks=(shade(color, 0.7), 70))
    if style == "crab":
        crab(b, shell, color, rng)
    elif style == "lobster":
        lobster(b, shell, color)
    else:
        shrimp(b, shell, color)
    size = ((14, 22, 6.0), (42, 24, 8), (10.5, 10.0, 2.9))[variant % 3]
    return varied_cm(b, f"a {style}", size, rng, {"style": style})


@recipe("oyster", 2, name="seafood.oyster")
def oyster(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """An opened half shell with its meat, a closed one."""
    b = MeshBuilder(roughness=0.6)
    style = ("opened", "closed")[variant % 2]
    grey = skin(rng, ["#6f6a62", "#8a857a", "#a09a8c", "#7a756a"], noise=14, size=(32, 32))

    def valve(height: float) -> shapes.Shape:
        body = pillow((9.5, 6.5, height), 0.9, 1.0, 26, 10)
        x, y, z = body.vertices.T
        taper = np.interp(x, [-4.75, 4.75], [0.55, 1.12])
        ruffle = 1 + 0.06 * np.sin(9 * np.arctan2(y, x)) * np.hypot(x / 4.75, y / 3.25)
        return lumpy(shapes.Shape(np.column_stack([x * ruffle, y * taper * ruffle, z]), body.faces), 0.03, rng, 3)

    if style == "opened":
        low = valve(4.6)
        low = shapes.Shape(np.column_stack([low.vertices[:, :2], np.minimum(low.vertices[:, 2], 2.3)]), low.faces)
        b.add(painted(low), image=grey, crease_deg=50)
        pearl = skin(rng, ["#f0ece4", "#e2dfdc"], "#c9ced6", 4)
        b.add(painted(pillow((8.3, 5.6, 0.5), 0.9, 0.4, 22, 4), 0), image=pearl, at=(0.2, 0, 2.12))
        b.add(lumpy(pillow((5.6, 3.8, 1.0), 0.8, 0.8, 18, 6), 0.08, rng, 2), "#b8ac98", (0.3, 0, 2.4), crease_deg=80)
        b.add(lumpy(pillow((3.4, 2.2, 0.9), 0.8, 0.8, 14, 6), 0.08, rng, 2), "#d9cfbb", (0.6, 0.2, 2.75), crease_deg=80)
        b.tube(
            [(2.6 * np.cos(a) + 0.4, 1.9 * np.sin(a), 2.75) for a in np.linspace(-2.4, 2.4, 14)],
            0.2,
            "#3f3a38",
            sides=5,
        )
    else:
        # The lower half of a deep valve, the upper half of a flat one on its rim, a little askew.
        low, high = valve(3.4), valve(2.6)
        low.vertices[:, 2] = np.minimum(low.vertices[:, 2], 1.7)
        high.vertices[:, 2] = np.maximum(high.vertices[:, 2], 1.3) - 1.3
        b.add(painted(low), image=grey, crease_deg=50)
        b.add(painted(high), image=grey, at=(0.15, 0.1, 1.66), turn_deg=(0, -1.5, 3), crease_deg=50)
    size = ((9.5, 6.5, 3.3), (11, 7.2, 4.0))[variant % 2]
    return varied_cm(b, f"an {style} oyster" if variant % 2 == 0 else "a closed oyster", size, rng, {"style": style})
