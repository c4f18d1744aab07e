"""Furniture of boards: shelves, chests, wardrobes, desks, counters, kitchens; doors and drawers at +x."""

import dataclasses

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, shade
from ....meshes.recipe import recipe
from ...shared.sizes import made

BOARD = 0.022  # m, chipboard of 18-22 mm


@dataclasses.dataclass
class Carcass:
    """A box of boards, `width` (y) by `depth` (x) by `height`, open at +x, standing `foot` above the floor."""

    b: MeshBuilder
    depth: float
    width: float
    height: float
    color: Color
    foot: float = 0.06
    grip: Color = "charcoal"

    def __post_init__(self) -> None:
        b, d, w, h, z = self.b, self.depth, self.width, self.height, self.foot
        for s in (-1, 1):
            b.box((d, BOARD, h - z), (0, s * (w - BOARD) / 2, z), self.color, bevel=0.003)
        for level in (z, h - BOARD):
            b.box((d, w - 2 * BOARD, BOARD), (0, 0, level), self.color)
        b.box((0.01, w, h - z), (-d / 2 + 0.005, 0, z), shade(self.color, 0.7))
        if z > 0.0:
            b.box((d - 0.06, w - 0.04, z), (-0.02, 0, 0), shade(self.color, 0.55))

    def legs(self, color: Color, radius: float = 0.018) -> None:
        """Four legs in place of a plinth (set `foot` to 0 and lift the carcass)."""
        for sx in (-1, 1):
            for sy in (-1, 1):
                x, y = sx * (self.depth / 2 - 0.05), sy * (self.width / 2 - 0.06)
                self.b.tube([(x, y, -0.2), (x * 0.9, y * 0.95, 0.0)], [radius * 0.6, radius], color, 8)

    def shelf(self, z: float, y0: float | None = None, y1: float | None = None) -> None:
        left = -self.width / 2 + BOARD if y0 is None else y0
        right = self.width / 2 - BOARD if y1 is None else y1
        self.b.box((self.depth - 0.03, right - left, BOARD), (0, (left + right) / 2, z), self.color)

    def upright(self, y: float, z0: float, z1: float) -> None:
        self.b.box((self.depth - 0.03, BOARD, z1 - z0), (0, y, z0), self.color)

    def front(
        self, y: float, z: float, wide: float, tall: float, color: Color, grip: str = "bar", proud: float = 0.018
    ) -> None:
        """A door or drawer front, lower middle at (y, z); `grip`: "bar", "knob", "left", "right" or "none"."""
        b, x = self.b, self.depth / 2
        b.box((proud, wide - 0.006, tall - 0.006), (x + proud / 2, y, z + 0.003), color, bevel=0.004)
        x += proud
        if grip == "bar":
            b.box((0.02, min(0.16, wide * 0.4), 0.014), (x + 0.01, y, z + tall * 0.62), self.grip, bevel=0.004)
        elif grip == "knob":
            b.ball((0.016, 0.018, 0.018), (x + 0.012, y, z + tall * 0.5), self.grip, segments=10, rings=6)
        elif grip in ("left", "right"):
            at = y + (wide / 2 - 0.05) * (1 if grip == "right" else -1)
            b.box((0.02, 0.014, min(0.16, tall * 0.3)), (x + 0.01, at, z + tall * 0.5), self.grip, bevel=0.004)

    def drawers(
        self, y: float, z: float, wide: float, heights: tuple[float, ...], color: Color, grip: str = "bar"
    ) -> None:
        for tall in heights:
            self.front(y, z, wide, tall, color, grip)
            z += tall


def books(
    b: MeshBuilder, y0: float, y1: float, z: float, tallest: float, depth: float, rng: np.random.Generator
) -> None:
    """A row of books standing from y0 to y1 on a shelf at z, backs at +x."""
    inks = ("dark red", "dark blue", "dark green", "amber", "cream", "brown", "teal", "charcoal", "orange")
    y = y0 + 0.01
    while y < y1 - 0.07:
        thick, tall = float(rng.uniform(0.035, 0.07)), tallest * float(rng.uniform(0.62, 0.95))
        b.box((depth * 0.7, thick, tall), (depth * 0.08, y + thick / 2, z), inks[int(rng.integers(len(inks)))])
        y += thick + 0.002


@recipe("bookcase", 3, name="case_furniture.bookcase")
def bookcase(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Five shelves of books, a white cube shelf, a low one with a ladder of steps."""
    b = MeshBuilder(roughness=0.6)
    color, (d, w, h), rows, columns = (
        ("wood", (0.32, 0.9, 1.7), 5, 1),
        ("white", (0.38, 1.45, 1.45), 4, 4),
        ("dark wood", (0.3, 1.2, 1.0), 3, 2),
    )[variant % 3]
    c = Carcass(b, d, w, h, color)
    step, wide = (h - c.foot - BOARD) / rows, (w - BOARD) / columns
    for k in range(1, rows):
        c.shelf(c.foot + k * step)
    for k in range(1, columns):
        c.upright(-w / 2 + BOARD / 2 + k * wide, c.foot, h - BOARD)
    for r in range(rows):
        for k in range(columns):
            y0 = -w / 2 + BOARD + k * wide
            if (r + 2 * k) % 5 == 3 and columns > 1:
                b.lathe(
                    [(0.05, 0), (0.08, 0.08), (0.04, 0.15), (0.05, 0.17)],
                    (0.03, y0 + wide / 2, c.foot + r * step + BOARD),
                    "teal",
                    segments=10,
                )
                continue
            end = y0 + wide - BOARD - float(rng.uniform(0, 0.3)) * wide
            books(b, y0, end, c.foot + r * step + BOARD, step - BOARD, d, rng)
    return made(b, f"a bookcase of {rows} shelves", (d, w, h), rows=rows)


@recipe("cabinet or shelf", 3, name="case_furniture.cabinet")
def cabinet(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A cupboard with two doors below and open shelves above, a sideboard on legs, a tall glass-fronted one."""
    b = MeshBuilder(roughness=0.55)
    if variant % 3 == 1:
        with b.frame((0, 0, 0.2)):
            c = Carcass(b, 0.42, 1.6, 0.6, "wood", 0.0)
            c.legs("charcoal")
            for k in range(3):
                y = (k - 1) * 0.53
                if k == 1:
                    c.drawers(y, 0.0, 0.53, (0.2, 0.2, 0.2), "off white", "knob")
                else:
                    c.front(y, 0.0, 0.53, 0.6, "wood", "right" if k == 0 else "left")
        return made(b, "a sideboard on legs", (0.44, 1.6, 0.8), style="sideboard")
    glazed = variant % 3 == 2
    d, w, h, color = ((0.4, 0.9, 1.05, "light wood"), (0.42, 0.95, 1.85, "white"))[glazed]
    c = Carcass(b, d, w, h, color)
    split = h * (0.55 if not glazed else 0.38)
    c.shelf(split)
    for s, grip in ((-1, "right"), (1, "left")):
        c.front(s * w / 4, c.foot, w / 2, split - c.foot, shade(color, 0.94), grip)
        if glazed:
            c.front(s * w / 4, split, w / 2, h - split, color, grip)
            b.box((0.006, w / 2 - 0.14, h - split - 0.16), (d / 2 + 0.019, s * w / 4, split + 0.08), "glass")
    if not glazed:
        c.shelf((split + h) / 2)
        books(b, -w / 2 + BOARD, 0.1, split + BOARD, 0.2, d, rng)
        b.lathe(
            [(0.05, 0), (0.08, 0.07), (0.05, 0.13), (0.06, 0.15)],
            (0.05, 0.26, (split + h) / 2 + BOARD),
            "teal",
            segments=12,
        )
    else:
        b.box((d + 0.06, w + 0.06, 0.05), (0, 0, h - 0.03), color, bevel=0.015)
    return made(
        b,
        "a glass-fronted cabinet" if glazed else "a cupboard with shelves",
        (d, w, h),
        style="glazed" if glazed else "cupboard",
    )


@recipe("cabinetry", 3, name="case_furniture.cabinetry")
def cabinetry(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A run of kitchen units with worktop, sink tap and hob; with and without wall units."""
    b = MeshBuilder(roughness=0.45)
    w, color, top, wall = (
        (1.8, "white", "charcoal", False),
        (2.4, "#6f8374", "light wood", True),
        (3.0, "wood", "granite", True),
    )[variant % 3]
    d, h = 0.58, 0.86
    c = Carcass(b, d, w, h, color, 0.1, "aluminium")
    units = round(w / 0.6)
    for k in range(units):
        y = (k - (units - 1) / 2) * w / units
        if k == 0:
            c.drawers(y, 0.1, w / units, (0.32, 0.24, 0.2), color)
        elif k == units - 1:
            c.front(y, 0.1, w / units, 0.76, "charcoal", "none")
            b.box((0.008, 0.42, 0.32), (d / 2 + 0.02, y, 0.3), "black")
            b.rod((d / 2 + 0.045, y - 0.22, 0.72), (d / 2 + 0.045, y + 0.22, 0.72), 0.01, "aluminium")
            for i in range(4):
                b.cylinder(
                    0.016, 0.02, (d / 2 + 0.018, y - 0.18 + 0.12 * i, 0.8), "aluminium", turn_deg=(0, 90, 0), segments=8
                )
                b.cylinder(
                    0.075, 0.006, (-0.12 + 0.26 * (i // 2), y - 0.12 + 0.24 * (i % 2), h + 0.04), "black", segments=14
                )
        else:
            c.front(y, 0.1, w / units, 0.76, color, "right" if k % 2 else "left")
    b.box((d + 0.06, w + 0.02, 0.04), (0.02, 0, h), top, bevel=0.006)
    y = -w / 2 + 0.3 + w / units
    b.box((0.36, 0.44, 0.008), (0.04, y, h + 0.037), "aluminium", bevel=0.003)
    b.tube([(-0.2, y, h + 0.03), (-0.2, y, h + 0.26), (-0.12, y, h + 0.3), (-0.04, y, h + 0.24)], 0.012, "aluminium")
    if wall:
        with b.frame((-0.12, 0, 1.45)):
            u = Carcass(b, 0.34, w, 0.7, color, 0.0, "aluminium")
            for k in range(units):
                u.front((k - (units - 1) / 2) * w / units, 0, w / units, 0.7, color, "left" if k % 2 else "right")
        b.box((0.012, w, 0.6), (-0.285, 0, 0.88), "off white")
    else:
        b.box((0.02, w, 0.35), (-0.28, 0, 0.9), "light blue", bevel=0.004)
    return made(b, "a run of kitchen units", (0.62, w, 2.15 if wall else 1.25), wall_units=wall)


@recipe("chest of drawers", 3, name="case_furniture.chest_of_drawers")
def chest_of_drawers(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Four wide drawers with bars, an old one with knobs and bowed top, six white ones in two columns."""
    b = MeshBuilder(roughness=0.55)
    color, (d, w, h), rows, columns, grip = (
        ("light wood", (0.46, 0.88, 0.84), 4, 1, "bar"),
        ("dark wood", (0.5, 0.75, 1.15), 5, 1, "knob"),
        ("white", (0.44, 1.4, 0.78), 3, 2, "knob"),
    )[variant % 3]
    c = Carcass(b, d, w, h - 0.025, color, 0.08, "brass" if grip == "knob" else "charcoal")
    tall, wide = (h - 0.03 - c.foot) / rows, (w - 0.01) / columns
    for r in range(rows):
        for k in range(columns):
            y, z = (k - (columns - 1) / 2) * wide, c.foot + r * tall
            c.front(y, z, wide, tall, shade(color, 1.05), "none" if grip == "knob" else "bar")
            if grip == "knob":
                for s in (-1, 1):
                    b.ball(0.018, (d / 2 + 0.03, y + s * wide * 0.25, z + tall / 2), "brass", segments=10, rings=6)
    b.box((d + 0.05, w + 0.04, 0.03), (0.01, 0, h - 0.03), shade(color, 0.92), bevel=0.01)
    return made(b, f"a chest of {rows * columns} drawers", (d, w, h), drawers=rows * columns)


@recipe("nightstand", 3, name="case_furniture.nightstand")
def nightstand(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """A drawer over an open shelf, two drawers on tall legs, a door and a drawer."""
    b = MeshBuilder(roughness=0.55)
    color, (d, w, h) = (("wood", (0.39, 0.47, 0.54)), ("white", (0.36, 0.42, 0.6)), ("dark wood", (0.42, 0.5, 0.64)))[
        variant % 3
    ]
    lift = 0.2 if variant % 3 == 1 else 0.0
    with b.frame((0, 0, lift)):
        c = Carcass(b, d - 0.03, w - 0.02, h - lift - 0.02, color, 0.0 if lift else 0.05, "brass")
        if variant % 3 == 1:
            c.legs("light wood")
            c.drawers(0, 0, w - 0.03, (0.19, 0.19), color, "knob")
        else:
            tall = 0.15
            z = c.height - tall - 0.005
            c.shelf(z - BOARD)
            c.front(0, z, w - 0.03, tall, shade(color, 1.06), "knob")
            if variant % 3 == 2:
                c.front(0, c.foot, w - 0.03, z - c.foot, shade(color, 1.06), "right")
            else:
                for k in range(3):
                    b.box(
                        (0.16, 0.2, 0.025),
                        (0.02, -0.05 + 0.02 * k, c.foot + BOARD + 0.027 * k),
                        ("dark red", "cream", "dark blue")[k],
                        (0, 0, 6 * k),
                    )
        b.box((d, w, 0.025), (0, 0, c.height - 0.005), shade(color, 0.9), bevel=0.008)
    return made(b, "a nightstand", (d, w, h))


@recipe("wardrobe", 3, name="case_furniture.wardrobe")
def wardrobe(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Three free-standing wardrobes."""
    return _wardrobe(variant, (1.25, 1.9, 1.1)[variant % 3], ("wood", "white", "light wood")[variant % 3], rng)


@recipe("closet", 3, name="case_furniture.closet")
def closet(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Three built-in ones, wider."""
    return _wardrobe(variant, (1.5, 2.2, 1.3)[variant % 3], ("#d9d4c6", "#6b4a34", "#c9d2d6")[variant % 3], rng)


def _wardrobe(variant: int, w: float, color: Color, rng: np.random.Generator) -> BuiltAsset:
    """Two doors over a drawer with a cornice, three plain doors with a mirror, an open one with hung clothes."""
    b = MeshBuilder(roughness=0.55)
    d, h = ((0.59, 2.03), (0.62, 2.2), (0.56, 1.9))[variant % 3]
    c = Carcass(b, d - 0.03, w, h - 0.03, color, 0.08, "brass" if variant % 3 == 0 else "aluminium")
    if variant % 3 == 0:
        c.drawers(0, 0.08, w, (0.25,), shade(color, 0.95), "bar")
        for s, grip in ((-1, "right"), (1, "left")):
            c.front(s * w / 4, 0.33, w / 2, h - 0.38, color, grip)
            for z, tall in ((0.43, 0.7), (1.2, h - 1.35)):
                b.box((0.01, w / 2 - 0.2, tall), (d / 2 + 0.008, s * w / 4, z), shade(color, 1.12), bevel=0.004)
        b.box((d + 0.08, w + 0.1, 0.07), (0, 0, h - 0.07), shade(color, 0.85), bevel=0.025)
    elif variant % 3 == 1:
        for k in range(3):
            c.front((k - 1) * w / 3, 0.08, w / 3, h - 0.11, color, ("right", "left", "left")[k])
        b.box((0.008, w / 3 - 0.08, h - 0.4), (d / 2 + 0.01, 0, 0.2), "mirror")
    else:
        c.shelf(0.42)
        c.shelf(1.62)
        b.rod((0, -w / 2, 1.54), (0, w / 2, 1.54), 0.014, "aluminium")
        inks = ("dark blue", "white", "red", "teal", "beige", "charcoal", "pink")
        for k in range(7):
            y = -w / 2 + 0.14 + k * (w - 0.28) / 6
            drop = float(rng.uniform(0.7, 1.0))
            b.box((0.4, 0.07, drop), (0, y, 1.45 - drop), inks[k], taper=(0.9, 0.6), bevel=0.02)
            b.tube([(0, y, 1.44), (0, y, 1.52), (0.02, y, 1.56), (-0.01, y, 1.56)], 0.004, "aluminium", sides=4)
        for k in range(3):
            for s in (-1, 1):
                b.box(
                    (0.27, 0.09, 0.07),
                    (0.05, -0.35 + 0.32 * k + s * 0.06, 0.08 + BOARD),
                    ("brown", "black", "white")[k],
                    bevel=0.025,
                )
            b.box(
                (0.4, 0.28, 0.2),
                (0.02, -0.36 + 0.36 * k, 1.62 + BOARD),
                ("cardboard", "light blue", "cream")[k],
                bevel=0.01,
            )
    return made(b, "a wardrobe" if variant % 3 < 2 else "an open wardrobe", (d, w, h))
