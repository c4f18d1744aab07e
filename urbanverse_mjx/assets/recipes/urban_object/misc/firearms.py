"""Weapons as a robot may have to recognise them: firearms standing on edge with the muzzle along +x, and bombs."""

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ....meshes.shapes import Point2
from ...shared.outlines import curve, ellipse, mirrored, pairs
from ...shared.sizes import varied


def barrel(b: MeshBuilder, start: float, end: float, z: float, radius: float, color: Color, y: float = 0.0) -> None:
    """A tube along x with a dark mouth."""
    with b.frame((start, y, z), (0, 90, 0)):
        b.cylinder(radius, end - start, color=color, segments=12)
        b.cylinder(radius * 0.6, 0.001, (0, 0, end - start), "black", segments=8)


def trigger(b: MeshBuilder, x: float, z: float, radius: float, color: Color) -> None:
    """A guard's ring with its trigger, hanging below z."""
    loop = [(x + radius * 1.2 * np.cos(a), 0, z + radius * np.sin(a)) for a in np.linspace(np.pi, 2 * np.pi, 7)]
    b.tube(loop, radius * 0.16, color, sides=5)
    b.tube(
        [(x, 0, z), (x + radius * 0.25, 0, z - radius * 0.5), (x, 0, z - radius * 0.75)], radius * 0.15, color, sides=5
    )


@recipe("handgun", 3, hulls=1, name="firearms.handgun")
def handgun(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Black pistol, silver pistol with wooden grips, revolver."""
    b = MeshBuilder(roughness=0.35, metallic=0.2)
    style = ("black pistol", "silver pistol", "revolver")[variant]
    steel, grip = (("charcoal", "black"), ("aluminium", "wood"), ("dark grey", "dark wood"))[variant]
    if style == "revolver":
        barrel(b, 0.02, 0.16, 0.116, 0.009, steel)
        b.box((0.13, 0.01, 0.018), (0.085, 0, 0.094), steel)
        b.box((0.004, 0.004, 0.01), (0.155, 0, 0.124), steel)
        b.profile([(-0.07, 0.08), (0.03, 0.08), (0.03, 0.126), (-0.05, 0.13), (-0.07, 0.1)], 0.014, color=steel)
        with b.frame((-0.035, 0, 0.103), (0, 90, 0)):
            b.cylinder(0.0195, 0.044, color=shade(steel, 1.3), segments=12)
            for k in range(6):
                a = np.radians(60 * k)
                b.cylinder(0.0045, 0.046, (0.012 * np.cos(a), 0.012 * np.sin(a), -0.001), "black", segments=6)
        b.convex(
            [
                (x, y, z)
                for y in (-0.004, 0.004)
                for x, z in ((-0.075, 0.11), (-0.06, 0.115), (-0.085, 0.145), (-0.09, 0.138))
            ],
            steel,
        )
        hold = [
            (-0.068, 0.1),
            (-0.06, 0.075),
            (-0.085, 0.02),
            (-0.1, 0.0),
            (-0.13, 0.008),
            (-0.115, 0.06),
            (-0.09, 0.105),
        ]
        trigger(b, -0.03, 0.082, 0.02, steel)
    else:
        b.profile(
            [(-0.09, 0.1), (0.105, 0.1), (0.11, 0.106), (0.108, 0.13), (-0.085, 0.13), (-0.092, 0.122)],
            0.026,
            color=steel,
        )
        b.profile([(-0.085, 0.085), (0.095, 0.085), (0.1, 0.1), (-0.09, 0.1)], 0.023, color=shade(steel, 0.75))
        with b.frame((0.109, 0, 0.117), (0, 90, 0)):
            b.cylinder(0.007, 0.004, color=shade(steel, 0.6), segments=10)
            b.cylinder(0.0045, 0.001, (0, 0, 0.004), "black", segments=8)
        for k in range(6):
            b.box((0.003, 0.027, 0.022), (-0.075 + 0.007 * k, 0, 0.104), shade(steel, 0.7))
        b.box((0.006, 0.003, 0.006), (0.1, 0, 0.129), "black")
        b.box((0.008, 0.016, 0.006), (-0.08, 0, 0.129), "black")
        b.box((0.04, 0.0268, 0.012), (0.01, 0, 0.117), shade(steel, 0.55))
        hold = [
            (-0.05, 0.09),
            (-0.038, 0.085),
            (-0.052, 0.02),
            (-0.056, 0.0),
            (-0.106, 0.0),
            (-0.098, 0.03),
            (-0.086, 0.07),
            (-0.098, 0.09),
        ]
        trigger(b, -0.018, 0.086, 0.024, shade(steel, 0.8))
        for k in range(5):
            b.box((0.036, 0.033, 0.003), (-0.077 + 0.002 * k, 0, 0.02 + 0.011 * k), shade(grip, 0.75))
    b.profile(hold, 0.031, color=grip)
    size = ((0.205, 0.035, 0.137), (0.22, 0.034, 0.14), (0.27, 0.04, 0.15))[variant]
    return varied(b, rng, size, f"a {style}", style)


_STOCK: list[Point2] = [
    (-0.16, 0.135),
    (-0.16, 0.175),
    (-0.26, 0.165),
    (-0.5, 0.16),
    (-0.505, 0.03),
    (-0.47, 0.028),
    (-0.27, 0.105),
]


@recipe("rifle", 3, name="firearms.rifle")
def rifle(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Assault rifle with wooden furniture and a curved magazine, black carbine, hunting rifle with a telescope."""
    b = MeshBuilder(roughness=0.5)
    style = ("wood-stocked assault", "black carbine", "hunting")[variant]
    wood: Color = ("wood", "charcoal", "dark wood")[variant]
    z = 0.165
    if style == "hunting":
        b.profile(
            [(-0.18, 0.12), (-0.14, 0.17), (0.28, 0.172), (0.28, 0.145), (0.0, 0.132), (-0.12, 0.125)], 0.04, color=wood
        )
        b.profile([*_STOCK[:2], *_STOCK[2:]], 0.04, color=wood)
        b.box((0.02, 0.042, 0.13), (-0.5, 0, 0.03), "black")
        barrel(b, -0.1, 0.6, 0.182, 0.009, "charcoal")
        b.rod((-0.13, 0, 0.18), (0.06, 0, 0.18), 0.015, "charcoal", sides=10)
        b.tube([(-0.1, -0.014, 0.18), (-0.1, -0.035, 0.172), (-0.105, -0.05, 0.155)], 0.005, "aluminium", sides=6)
        with b.frame((-0.16, 0, 0.222), (0, 90, 0)):
            b.lathe(
                [(0.019, 0), (0.019, 0.05), (0.0125, 0.07), (0.0125, 0.2), (0.022, 0.24), (0.022, 0.29)],
                color="black",
                segments=14,
            )
            b.cylinder(0.018, 0.001, (0, 0, 0.29), "light blue", segments=12)
        for x in (-0.08, 0.03):
            b.box((0.018, 0.022, 0.03), (x, 0, 0.192), "charcoal")
        trigger(b, -0.12, 0.128, 0.024, "charcoal")
    else:
        b.profile([(-0.17, 0.12), (0.1, 0.12), (0.1, 0.185), (-0.06, 0.19), (-0.17, 0.18)], 0.042, color="charcoal")
        barrel(b, 0.1, 0.42, z, 0.0085, "dark grey")
        barrel(b, 0.395, 0.435, z, 0.012, "black")
        b.box((0.012, 0.008, 0.05), (0.37 if variant == 0 else 0.27, 0, z), "black", taper=(0.5, 1))
        b.profile(
            [(-0.13, 0.13), (-0.1, 0.125), (-0.125, 0.02), (-0.165, 0.02), (-0.16, 0.06)],
            0.032,
            color=wood if variant == 0 else "black",
        )
        trigger(b, -0.085, 0.122, 0.024, "black")
        if variant == 0:
            b.rod((0.1, 0, 0.19), (0.3, 0, 0.185), 0.01, "charcoal", sides=8)
            b.box((0.16, 0.044, 0.045), (0.18, 0, 0.14), wood, bevel=0.012)
            b.profile([(x + 0.04, v) for x, v in _STOCK], 0.038, color=wood)
            b.box((0.012, 0.04, 0.125), (-0.462, 0, 0.03), "charcoal")
            front = curve([(0.045, 0.125), (0.05, 0.07), (0.075, 0.02), (0.105, -0.02)], 3)
            back = curve([(0.07, -0.045), (0.035, 0.0), (0.01, 0.06), (0.0, 0.125)], 3)
            b.profile(pairs(np.vstack([front, back])), 0.026, color="black")
            b.rod((-0.01, -0.02, 0.165), (-0.01, -0.036, 0.165), 0.005, "grey", sides=6)
        else:
            b.cylinder(0.026, 0.2, (0.1, 0, z), "black", (0, 90, 0), segments=8)
            for k in range(7):
                b.box((0.006, 0.054, 0.008), (0.12 + 0.025 * k, 0, z - 0.004), "dark grey")
            b.profile([(0.005, 0.125), (0.055, 0.125), (0.07, 0.0), (0.02, -0.01)], 0.026, color="dark grey")
            b.rod((-0.17, 0, 0.16), (-0.3, 0, 0.16), 0.015, "dark grey", sides=8)
            b.profile(
                [(-0.25, 0.18), (-0.25, 0.145), (-0.36, 0.06), (-0.395, 0.05), (-0.4, 0.18)], 0.036, color="black"
            )
            b.box((0.15, 0.016, 0.012), (-0.03, 0, 0.188), "black")
            b.box((0.07, 0.035, 0.035), (-0.02, 0, 0.2), "charcoal", bevel=0.006)
            b.cylinder(0.013, 0.002, (0.0155, 0, 0.2175), "light red", (0, 90, 0), segments=10)
    size = ((0.92, 0.066, 0.24), (0.84, 0.064, 0.25), (1.1, 0.075, 0.21))[variant]
    return varied(b, rng, size, f"a {style} rifle", style)


@recipe("shotgun", 2, name="firearms.shotgun")
def shotgun(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Double-barrelled gun with a wooden stock; black pump gun with a grooved fore-end."""
    b = MeshBuilder(roughness=0.45)
    style = ("double-barrelled", "pump-action")[variant]
    wood: Color = ("wood", "black")[variant]
    b.profile(_STOCK, 0.042, color=wood)
    b.box((0.02, 0.044, 0.135), (-0.5, 0, 0.027), "dark red" if variant == 0 else "charcoal")
    receiver: Color = "aluminium" if variant == 0 else "charcoal"
    b.profile([(-0.17, 0.128), (0.06, 0.135), (0.06, 0.19), (-0.1, 0.19), (-0.17, 0.172)], 0.044, color=receiver)
    trigger(b, -0.1, 0.13, 0.026, "charcoal")
    if style == "double-barrelled":
        for s in (-1, 1):
            barrel(b, 0.05, 0.62, 0.176, 0.0125, "dark grey", 0.012 * s)
        b.profile([(0.06, 0.13), (0.3, 0.15), (0.3, 0.17), (0.06, 0.17)], 0.042, color=wood)
        b.box((0.5, 0.008, 0.004), (0.33, 0, 0.186), "charcoal")
        b.tube([(-0.15, 0, 0.178), (-0.12, 0, 0.196), (-0.1, 0, 0.194)], 0.005, "charcoal", sides=5)
    else:
        barrel(b, 0.05, 0.6, 0.178, 0.0125, "dark grey")
        barrel(b, 0.05, 0.52, 0.15, 0.0125, "charcoal")
        b.cylinder(0.024, 0.19, (0.18, 0, 0.152), wood, (0, 90, 0), segments=10)
        for k in range(9):
            b.cylinder(0.0255, 0.008, (0.19 + 0.02 * k, 0, 0.152), "charcoal", (0, 90, 0), segments=10)
        b.box((0.07, 0.045, 0.02), (-0.01, 0, 0.16), "dark grey")
    b.ball(0.004, (0.6 if variant else 0.61, 0, 0.192), "brass", segments=6, rings=4)
    size = ((1.04, 0.06, 0.19), (0.98, 0.056, 0.2))[variant]
    return varied(b, rng, size, f"a {style} shotgun", style)


@recipe("machine gun", 2, name="firearms.machine_gun")
def machine_gun(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Belt-fed gun on a bipod with its belt; submachine gun with a drum."""
    b = MeshBuilder(roughness=0.5)
    style = ("belt-fed", "drum-fed")[variant]
    wood: Color = ("charcoal", "wood")[variant]
    b.profile([(-0.2, 0.17), (0.12, 0.17), (0.12, 0.245), (-0.2, 0.25)], 0.05, color="dark grey")
    b.profile([(x - 0.03, z + 0.08) for x, z in _STOCK], 0.04, color=wood)
    b.profile([(-0.16, 0.175), (-0.125, 0.17), (-0.15, 0.07), (-0.19, 0.07)], 0.032, color=wood)
    trigger(b, -0.1, 0.172, 0.026, "black")
    barrel(b, 0.12, 0.56, 0.22, 0.011, "charcoal")
    with b.frame((0.12, 0, 0.22), (0, 90, 0)):
        b.cylinder(0.022, 0.26 if variant == 0 else 0.2, color="black", segments=10)
        for k in range(8):
            b.ring(0.0225, 0.003, (0, 0, 0.02 + 0.028 * k), "dark grey", segments=10, sides=4)
        b.lathe([(0.012, 0.4), (0.017, 0.43), (0.017, 0.47)], color="black", segments=10)
    if style == "belt-fed":
        b.box((0.26, 0.056, 0.02), (-0.03, 0, 0.245), "charcoal", bevel=0.006)
        b.tube([(-0.02, 0, 0.262), (-0.02, 0, 0.31), (0.1, 0, 0.31), (0.1, 0, 0.262)], 0.008, "black", sides=6)
        for k in range(12):
            y, z = 0.03 + 0.009 * min(k, 4), 0.215 - 0.014 * max(k - 2, 0)
            b.rod((0.0, y, z), (0.06, y, z), 0.006, "brass", sides=6)
            b.rod((0.06, y, z), (0.075, y, z), 0.0035, "bronze", sides=5)
        b.box((0.12, 0.07, 0.09), (0.03, 0.05, 0.07), "dark green", bevel=0.008)
        for s in (-1, 1):
            b.tube([(0.42, 0, 0.215), (0.44, 0.08 * s, 0.0), (0.46, 0.085 * s, 0.0)], 0.008, "black", sides=6)
    else:
        b.cylinder(0.062, 0.045, (0.03, 0.0225, 0.12), "charcoal", (90, 0, 0), segments=20)
        b.cylinder(0.02, 0.05, (0.03, 0.025, 0.12), "grey", (90, 0, 0), segments=12)
        b.profile([(0.2, 0.19), (0.235, 0.19), (0.22, 0.09), (0.185, 0.09)], 0.034, color=wood)
        b.box((0.01, 0.006, 0.03), (0.52, 0, 0.225), "black")
    size = ((1.08, 0.132, 0.28), (0.85, 0.08, 0.26))[variant]
    return varied(b, rng, size, f"a {style} machine gun", style)


@recipe("bomb", 2, name="firearms.bomb")
def bomb(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Aircraft bomb with fins lying with its nose along +x; round black bomb with a fuse."""
    b = MeshBuilder(roughness=0.5)
    style = ("finned aircraft", "round fused")[variant]
    if style == "finned aircraft":
        with b.frame((0, 0, 0.1), (0, 90, 0)):
            body = curve([(0.03, -0.28), (0.055, -0.16), (0.085, 0.02), (0.08, 0.16), (0.045, 0.26), (0.012, 0.29)], 3)
            b.lathe(pairs(body), color="dark green", segments=20)
            b.cylinder(0.0885, 0.018, (0, 0, 0.05), "signal yellow", segments=20)
            b.cylinder(0.0875, 0.012, (0, 0, 0.1), "signal yellow", segments=20)
            b.cylinder(0.016, 0.03, (0, 0, 0.28), "aluminium", top_radius=0.008, segments=10)
            for k in range(4):
                with b.frame(turn_deg=(0, 0, 90 * k + 45)):
                    fin = mirrored([(0.02, 0.002), (0.1, 0.002)])
                    b.convex([(x, y, z) for x, y in fin for z in (-0.29, -0.2 if x < 0.05 else -0.25)], "dark green")
            b.ring(0.1, 0.006, (0, 0, -0.275), "dark green", segments=20, sides=4)
        for x in (-0.04, 0.1):
            b.ring(0.012, 0.003, (x, 0, 0.19), "grey", (90, 0, 0), segments=10, sides=4)
    else:
        b.ball(0.11, (0, 0, 0.11), "black", segments=22, rings=14)
        b.cylinder(0.035, 0.03, (0.02, 0, 0.207), "charcoal", (0, 12, 0), segments=14)
        b.tube(
            curve([(0.025, 0, 0.23), (0.04, 0, 0.27), (0.09, 0, 0.275), (0.11, 0, 0.31)], 4), 0.005, "cream", sides=6
        )
        for k, (y, z) in enumerate(ellipse(0.025, 0.025, 7)):
            ink = "signal yellow" if k % 2 else "safety orange"
            b.rod((0.112, 0, 0.313), (0.125 + 0.01 * (k % 2), y * 0.7, 0.318 + z), 0.004, ink, sides=4)
    size = ((0.6, 0.225, 0.255), (0.27, 0.24, 0.37))[variant]
    return varied(b, rng, size, f"a {style} bomb", style)
