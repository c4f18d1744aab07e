"""`Front`: a regional building under construction, its dressing, and its windows and balconies."""

import dataclasses
from collections.abc import Iterator

import numpy as np

from ....meshes import shapes
from ....meshes.mesh_builder import MeshBuilder, affine
from ....meshes.palette import Color, mix, shade
from ..facade import Facade, bays_over
from . import panes, words
from .styles import TRADES, Form, nth

#: m between the bars of a railing.
BARS = 0.16


@dataclasses.dataclass
class Front:
    """What the parts of a building share.

    Attributes:
      builder: collects the parts.
      form, size, dressing: what is built: width (m) and floors, and number of the dressing.
      language: of the signs.
      rng: for geometry, the same in all dressings.
      tint: for colours and images.
      shops: entries of signs not used yet, by turns.
    """

    builder: MeshBuilder
    form: Form
    size: tuple[float, int]
    dressing: int
    trade: str
    language: str
    rng: np.random.Generator
    tint: np.random.Generator
    shops: Iterator[tuple[str, str]] = dataclasses.field(init=False)

    def __post_init__(self) -> None:
        self.shops = self._shops()
        form, (width, floors) = self.form, self.size
        self.width, self.floors = float(width), int(floors)
        self.height = form.ground_height + (self.floors - 1) * form.storey + form.attic
        self.color, self.trim, self.base = (nth(c, self.dressing) for c in (form.colors, form.trim, form.base))
        self.rail, self.frame = nth(form.rail, self.dressing), nth(form.frame, self.dressing)
        self.main = Facade(self.builder, self.width, form.depth, self.height, self.trim)

    def _shops(self) -> Iterator[tuple[str, str]]:
        """(trade, entry of a sign): the building's trade first, then others."""
        table = words.languages()[self.language]
        turn = TRADES.index(self.trade)
        for round_ in range(99):
            for k in range(len(TRADES)):
                trade = TRADES[(turn + 3 * k) % len(TRADES)]
                entries = table[trade]
                yield trade, entries[(self.dressing + round_ + int(self.size[0])) % len(entries)]

    def board(self, number: int) -> tuple[Color, Color]:
        """(back, ink) of a sign."""
        return nth(self.form.boards, self.dressing + 2 * number)

    def bays(self) -> list[float]:
        """Middles of the window bays."""
        span = self.width - 0.5
        return bays_over(max(1, round(span / self.form.spacing)), span)


def plate(b: MeshBuilder, outline: list[tuple[float, float]], thickness: float, x: float, color: Color) -> None:
    """A plate in the plane of the front from an outline of (y, z), its face at x."""
    solid = shapes.extrusion([(float(y), float(z)) for y, z in outline], thickness)
    b.add(solid.transformed(affine((x - thickness, 0, 0), (90, 0, 90))), color)


def arch(y: float, z: float, radius: float, rise: float, count: int = 8) -> list[tuple[float, float]]:
    """(y, z) points of an arch's half ellipse from right to left, the ends at height z."""
    angles = np.linspace(0.0, np.pi, count + 1)
    return [(y + radius * float(np.cos(a)), z + rise * float(np.sin(a))) for a in angles]


def bars(b: MeshBuilder, points: np.ndarray, wide: tuple[float, float], height: float, color: Color) -> None:
    """Flat upright bars to be seen from both sides.

    Args:
      points: (n, 3) lower middles, m.
      wide: half a bar's width along x and y, m.
    """
    half = np.array([wide[0], wide[1], 0.0])
    up = np.array([0.0, 0.0, height])
    corners = np.stack([points - half, points + half, points + half + up, points - half + up], 1)
    faces = np.arange(len(points))[:, None, None] * 4 + np.array([[0, 1, 2], [0, 2, 3]])
    front = shapes.Shape(corners.reshape(-1, 3), faces.reshape(-1, 3))
    b.add(front, color)
    b.add(front.flipped(), color)


def railing(b: MeshBuilder, x: float, y: tuple[float, float], z: float, height: float, color: Color) -> None:
    """An iron railing along the front at x: two rails and flat bars."""
    y0, y1 = y
    for level, tall in ((0.06, 0.03), (height - 0.04, 0.05)):
        b.box((0.04, y1 - y0, tall), (x, (y0 + y1) / 2, z + level), color)
    ys = np.linspace(y0, y1, max(2, round((y1 - y0) / BARS)) + 1)
    bars(b, np.stack([np.full_like(ys, x), ys, np.full_like(ys, z)], 1), (0.0, 0.012), height, color)


def side_railing(b: MeshBuilder, x: tuple[float, float], y: float, z: float, height: float, color: Color) -> None:
    """The end of a railing, from the wall to the front."""
    x0, x1 = x
    b.box((x1 - x0, 0.04, 0.05), ((x0 + x1) / 2, y, z + height - 0.04), color)
    xs = np.linspace(x0, x1, max(2, round((x1 - x0) / BARS)) + 1)[1:-1]
    bars(b, np.stack([xs, np.full_like(xs, y), np.full_like(xs, z)], 1), (0.012, 0.0), height, color)


# Windows ----------------------------------------------------------------------------------------------------------


class Windows:
    """Puts the windows and balconies of the upper floors on a facade whose lowest floor is at height `base`."""

    def __init__(self, front: Front, facade: Facade, base: float) -> None:
        self.front, self.f, self.base = front, facade, base
        form = front.form
        tall = form.window_size[1] > 1.95
        self.images = [panes.pane(form.window, front.frame, front.tint, (36, 64 if tall else 48)) for _ in range(2)]
        self.door = panes.pane(
            form.window if tall or form.window in ("sliding", "lattice", "jalousie") else "french",
            front.frame, front.tint, (36, 64),
        )  # fmt: skip
        leaf = nth(form.shutters, front.dressing) if form.shutters else None
        self.leaf = None if leaf is None else panes.pane("jalousie", leaf, front.tint, (20, 48))
        self.leaf_color = leaf

    def lay(self) -> None:
        form, front = self.front.form, self.front
        bays = front.bays()
        for level in range(front.floors - 1):
            z = self.base + level * form.storey
            last = level == front.floors - 2
            run = form.balcony.endswith("_run") and self._on(level, last, 0, 1)
            if run:
                self._balcony(0.0, z, front.width - 0.3, form.balcony.removesuffix("_run"))
            for k, y in enumerate(bays):
                self._bay(y, z, self._on(level, last, k, len(bays)), run)
            if form.course and not last:
                self.f.course(z + form.storey - 0.12, 0.14, 0.07)

    def _on(self, level: int, last: bool, bay: int, count: int) -> bool:
        """Whether a bay has a balcony."""
        form = self.front.form
        if not form.balcony:
            return False
        floors, bays = form.balcony_at.split()
        floor_fits = {"all": True, "upper": level > 0, "second": level == 0, "ends": level in (0,) or last}[floors]
        middle = bay in ((count - 1) // 2, count // 2)
        bay_fits = {"all": True, "odd": bay % 2 == 1 or count == 1, "middle": middle, "sides": not middle}[bays]
        return floor_fits and bay_fits

    def _bay(self, y: float, z: float, balcony: bool, run: bool) -> None:
        form, front = self.front.form, self.front
        width, height = form.window_size
        kind = form.balcony.removesuffix("_run")
        if balcony and kind == "glazed":
            return self._glazed(y, z)
        if balcony and kind == "loggia":
            return self._loggia(y, z)
        if balcony and kind not in ("guard", "ledge"):
            top = z + max(2.15, form.sill + height)
            self.f.opening(y, z + 0.04, width, top - z - 0.04, self.door, 0.16, sill=False)
            if not run:
                self._balcony(y, z, min(width + 0.8, form.spacing - 0.12), kind)
        else:
            image = self.images[int(front.tint.integers(2))]
            self.f.opening(y, z + form.sill, width, height, image, sill=form.sill > 0.3)
            top = z + form.sill + height
            self._grille(y, z + form.sill, width, height)
            if balcony:
                self._guard(y, z + form.sill, width, kind)
        bottom = z + 0.04 if balcony and kind not in ("guard", "ledge") else z + form.sill
        self._hood(y, top, width)
        self._leaves(y, bottom, width, top - bottom)

    def _leaves(self, y: float, z: float, width: float, height: float) -> None:
        if self.leaf is None or self.leaf_color is None:
            return
        half = width / 2
        ajar = 0.04 + 0.18 * float(self.front.rng.random() < 0.3)
        for side in (-1, 1):
            at = (self.f.front + 0.035 + ajar / 2, y + side * (half + half / 2 - 0.01), z)
            self.f.builder.box((0.04, half, height), at, self.leaf_color, skins={"+x": self.leaf})

    def _hood(self, y: float, z: float, width: float) -> None:
        f, hood = self.f, self.front.form.hood
        if hood == "lintel":
            f.builder.box((0.06, width + 0.3, 0.2), (f.front + 0.02, y, z + 0.02), f.trim)
        elif hood == "slab":  # a sunshade of concrete over the window
            f.builder.box((0.55, width + 0.4, 0.09), (f.front + 0.26, y, z + 0.08), f.trim)
        elif hood == "pediment":
            f.builder.box((0.16, width + 0.4, 0.1), (f.front + 0.06, y, z + 0.1), f.trim)
            tall = self.front.form.window_size[1]
            for side in (-1, 1):
                f.builder.box((0.08, 0.16, tall), (f.front + 0.03, y + side * (width / 2 + 0.1), z - tall), f.trim)
        elif hood == "arch":
            outline = [(y - width / 2 - 0.16, z), *arch(y, z, width / 2 + 0.16, width / 2 * 0.8)[::-1][1:]]
            plate(f.builder, outline[::-1], 0.05, f.front + 0.04, f.trim)
            inner = arch(y, z + 0.02, width / 2 - 0.04, width / 2 * 0.62)
            plate(f.builder, inner, 0.02, f.front + 0.06, mix("dark glass", f.trim, 0.15))

    def _grille(self, y: float, z: float, width: float, height: float) -> None:
        f, grille = self.f, self.front.form.grille
        if not grille:
            return
        out = 0.03 if grille == "bars" else 0.28
        x, color = f.front + out, self.front.rail
        ys = np.linspace(y - width / 2, y + width / 2, max(3, round(width / 0.17)) + 1)
        bars(f.builder, np.stack([np.full_like(ys, x), ys, np.full_like(ys, z)], 1), (0.0, 0.01), height, color)
        for share in (0.0, 0.5, 0.97):
            f.builder.box((0.02 if grille == "bars" else out, width, 0.025), (x - (0 if grille == "bars" else out / 2),
                          y, z + share * height), color)  # fmt: skip

    # Balconies ------------------------------------------------------------------------------------------------------

    def _guard(self, y: float, z: float, width: float, kind: str) -> None:
        """A railing before a tall window; "ledge" stands on a narrow slab."""
        reach = 0.12 if kind == "guard" else 0.4
        if kind == "ledge":
            self.f.builder.box((reach + 0.05, width + 0.5, 0.12), (self.f.front + reach / 2, y, z - 0.12), self.f.trim)
        wide = width + (0.0 if kind == "guard" else 0.36)
        railing(self.f.builder, self.f.front + reach, (y - wide / 2, y + wide / 2), z, 0.95, self.front.rail)
        if kind == "ledge":
            for side in (-1, 1):
                x = (self.f.front, self.f.front + reach)
                side_railing(self.f.builder, x, y + side * wide / 2, z, 0.95, self.front.rail)

    def _balcony(self, y: float, z: float, width: float, kind: str) -> None:
        f, b, rail = self.f, self.f.builder, self.front.rail
        reach = {"iron": 0.75, "slab": 1.05, "precast": 1.1, "wood": 1.0, "lace": 1.5}[kind]
        x1 = f.front + reach
        b.box((reach, width, 0.14), (f.front + reach / 2, y, z - 0.14), shade(f.trim, 0.92))
        half = width / 2
        if kind == "slab":
            b.box((0.1, width, 1.0), (x1 - 0.05, y, z), rail)
            for side in (-1, 1):
                b.box((reach - 0.1, 0.1, 1.0), (f.front + (reach - 0.1) / 2, y + side * (half - 0.05), z), rail)
        elif kind == "precast":
            for level, tall in ((0.0, 0.12), (0.82, 0.14)):
                b.box((0.16, width, tall), (x1 - 0.08, y, z + level), rail)
            for k in range(max(3, round(width / 0.26))):
                py = y - half + 0.13 + (width - 0.26) * k / max(2, round(width / 0.26) - 1)
                b.cylinder(0.085, 0.36, (x1 - 0.08, py, z + 0.12), rail, top_radius=0.045, segments=5)
                b.cylinder(0.045, 0.34, (x1 - 0.08, py, z + 0.48), rail, top_radius=0.085, segments=5)
            for side in (-1, 1):
                b.box((reach - 0.1, 0.14, 0.96), (f.front + (reach - 0.1) / 2, y + side * (half - 0.07), z), rail)
        else:
            railing(b, x1 - 0.04, (y - half + 0.04, y + half - 0.04), z, 1.0, rail)
            for side in (-1, 1):
                side_railing(b, (f.front, x1 - 0.04), y + side * (half - 0.04), z, 1.0, rail)
        if kind in ("wood", "lace"):
            self._posts(y, z, half, x1)
        if kind == "iron":  # consoles below the slab
            for side in (-0.8, 0.8) if width < 4 else np.linspace(-0.92, 0.92, max(3, round(width / 1.6))):
                b.box((reach * 0.6, 0.16, 0.26), (f.front + reach * 0.3, y + float(side) * half, z - 0.4), f.trim)

    def _posts(self, y: float, z: float, half: float, x: float) -> None:
        """Posts and a roof over a balcony; cast-iron lace as brackets and a frieze."""
        b, rail, form = self.f.builder, self.front.rail, self.front.form
        tall = form.storey - 0.32
        count = max(2, round(2 * half / 2.6) + 1)
        for k in range(count):
            py = y - half + 0.08 + (2 * half - 0.16) * k / (count - 1)
            b.box((0.09, 0.09, tall), (x - 0.07, py, z), rail)
            if form.balcony.startswith("lace"):
                for side in (-1, 1):
                    if abs(py + side * 0.4 - y) < half:
                        plate(b, [(py, z + tall), (py, z + tall - 0.5), (py + side * 0.5, z + tall)][:: -side], 0.03,
                              x - 0.055, rail)  # fmt: skip
        if form.balcony.startswith("lace"):
            b.box((0.03, 2 * half, 0.22), (x - 0.07, y, z + tall - 0.22), rail)
        roof = nth(form.roof_colors, self.front.dressing)
        with b.frame((self.f.front + (x - self.f.front) / 2, y, z + tall)):
            reach = x - self.f.front + 0.2
            b.profile([(-reach / 2, 0.0), (reach / 2, 0.0), (-reach / 2, 0.32)], 2 * half + 0.2, color=roof)

    def _glazed(self, y: float, z: float) -> None:
        """A closed balcony: a parapet and panes all round."""
        front, b, f = self.front, self.f.builder, self.f
        width, reach = front.form.spacing - 0.1, 0.95
        x = f.front + reach / 2
        b.box((reach, width, 1.0), (x, y, z - 0.08), front.rail)
        glass = panes.pane("grid", front.frame, front.tint, (64, 40))
        side = panes.pane("casement", front.frame, front.tint, (24, 40))
        b.box((reach, width, 1.62), (x, y, z + 0.92), front.frame, skins={"+x": glass, "+y": side, "-y": side})
        b.box((reach + 0.06, width + 0.06, 0.1), (x, y, z + 2.54), shade(front.rail, 0.9))

    def _loggia(self, y: float, z: float) -> None:
        """A recess with a door at its back, behind a parapet or a railing."""
        front, f = self.front, self.f
        width = front.form.spacing - 0.35
        f.opening(y, z + 0.02, width, front.form.storey - 0.45, self.door, 1.1, sill=False)
        if front.rail == front.color or front.form.grille == "cage":
            f.builder.box((0.12, width, 0.95), (f.front - 0.06, y, z + 0.02), front.rail)
        else:
            railing(f.builder, f.front - 0.05, (y - width / 2, y + width / 2), z + 0.02, 1.0, front.rail)
