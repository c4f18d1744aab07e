"""Ground floors of trades' shops: layouts of doors and windows, images of goods, signs with the trade's emblem."""

import numpy as np
from PIL import Image, ImageDraw

from ....meshes import paint
from ....meshes.palette import Color, mix, rgb, shade
from ...amenity.signs import ngon
from ...shared import facade_images as images
from ..facade import Facade
from . import icons
from .icons import ICONS, Ink
from .trades import Trade

TINTS: tuple[Color, ...] = ("teal", "signal red", "dark blue", "pink", "lime", "cream", "purple", "orange")


def goods_image(
    trade: Trade, frame: Color, variant: int, size: tuple[int, int], rows: int = 1, plain: bool = False
) -> Image.Image:
    """A shop window with the trade's goods on `rows` shelves; `plain` has neither frame nor gleam (an open counter)."""
    width, height = paint.smooth(size, 3)
    image, pen = paint.canvas((width, height), "black")
    back = mix("dark wood", "lamp", 0.45) if trade.lit else mix("#33414d", "white", 0.5)
    for k in range(30):
        pen.rectangle((0, height * k / 30, width, height * (k + 1) / 30), fill=mix(back, "black", 0.4 * (1 - k / 30)))
    side = 0.78 * height / rows
    count = max(1, int(width * 0.96 / (side * 1.08)))
    for row in range(rows):
        bottom = height * (0.95 - 0.47 * row if rows > 1 else 0.93)
        for k in range(count):
            x = (k + 0.5) * width / count - side / 2
            name = trade.goods[(k + row + variant) % len(trade.goods)]
            ICONS[name](Ink(pen, x, bottom - side, side), TINTS[(3 * k + 2 * row + variant) % len(TINTS)])
        pen.rectangle((0, bottom, width, bottom + height * 0.03), fill=rgb("light wood" if trade.lit else "white"))
    if not plain:
        pixels = np.asarray(image, float)
        y, x = np.mgrid[0:height, 0:width]
        gleam = 0.20 * np.clip(1 - y / (0.4 * height), 0, 1) + 0.10 * (np.abs((x + 0.6 * y) / width - 0.55) < 0.05)
        lit = pixels + (np.array([200, 214, 224]) - pixels) * gleam[..., None]
        image = Image.fromarray(lit.astype(np.uint8))
        ImageDraw.Draw(image).rectangle((0, 0, width - 1, height - 1), outline=rgb(frame), width=int(0.035 * height))
    return paint.shrunk(image, size)


def name_board(trade: Trade, variant: int, size: tuple[int, int]) -> Image.Image:
    """The fascia: the trade's emblem at both ends, the shop's name between them."""
    back, ink = trade.paints[variant]
    width, height = paint.smooth(size, 3)
    image, pen = paint.canvas((width, height), back)
    inset = 0.0
    if width > 4.4 * height:
        inset = 1.15 * height
        for x in (0.15 * height, width - 0.95 * height):
            ICONS[trade.goods[0]](Ink(pen, x, 0.1 * height, 0.8 * height), ink)
    paint.text(pen, trade.names[variant], (inset + 8, 0.16 * height, width - inset - 8, 0.82 * height), ink, 0.035)
    return paint.shrunk(image, size)


def emblem(trade: Trade, variant: int, size: int = 64) -> np.ndarray:
    """(size, size, 3): the trade's pictogram on the sign's ground, or on white where it would not show."""
    back, ink = trade.paints[variant]
    return icons.drawn(trade.goods[variant % len(trade.goods)], size, ink, back)


class Front:
    """Lays out the ground floor of `height` m; `side` = 1 or -1 is where its door goes."""

    def __init__(self, f: Facade, trade: Trade, variant: int, height: float, side: float, paintwork: Color) -> None:
        self.f, self.trade, self.variant, self.height, self.side = f, trade, variant, height, side
        self.paintwork = paintwork
        self.board = min(0.85 + 0.07 * max(0.0, f.width - 8.0), 0.3 * height)
        self.top = height - self.board - 0.3
        self.door_height = min(2.6, self.top)

    def _door(self, y: float, width: float = 1.15, style: str = "glass") -> None:
        wide = width > 1.5
        image = images.door(self.paintwork, "double" if wide else style, (48 if wide else 28, 60))
        self.f.opening(y, 0.04, width, self.door_height, image, 0.4, sill=False)
        self.f.builder.box((0.35, width + 0.3, 0.05), (self.f.front + 0.1, y, 0), "granite")

    def _window(self, y: float, width: float, sill: float, rows: int = 1, shift: int = 0) -> None:
        tall = self.top - sill
        scale = 190.0 / max(width, 2.2 * tall)
        size = (max(24, round(width * scale)), max(20, round(tall * scale)))
        image = goods_image(self.trade, shade(self.paintwork, 0.8), self.variant + shift, size, rows)
        self.f.opening(y, sill, width, tall, image, 0.16)

    def side_door(self) -> None:
        w = self.f.width
        self._door(self.side * (w / 2 - 1.15))
        span = w - 2.6
        middle = -self.side * (w / 2 - 0.5 - span / 2)
        panes = 1 if span < 5.5 else 2
        for k in range(panes):
            self._window(middle + (k - (panes - 1) / 2) * span / panes, span / panes - 0.14, 0.62, 1, k)

    def middle(self) -> None:
        w = self.f.width
        door = 1.15 if w < 8 else 1.8
        self._door(0.0, door)
        span = (w - door - 1.2) / 2
        for k, s in enumerate((-1, 1)):
            self._window(s * (door / 2 + 0.2 + span / 2), span - 0.08, 0.5, 2 if span < 2.4 else 1, k)

    def wide(self) -> None:
        """Glass from pavement to fascia with double doors in one bay."""
        w = self.f.width
        bays = max(3, round(w / 3.2) if w < 18 else 7)
        step = (w - 0.7) / bays
        gate = bays // 2 if bays > 3 else (0 if self.side > 0 else bays - 1)
        for k in range(bays):
            y = (k - (bays - 1) / 2) * step
            if k == gate:
                self._door(y, min(step - 0.3, 2.2))
            else:
                self._window(y, step - 0.14, 0.22, 1 if step > 1.1 * self.top else 2, k % 2)

    def counter(self) -> None:
        """Sells through an open front over a counter; a narrow door beside it."""
        f, w = self.f, self.f.width
        self._door(self.side * (w / 2 - 0.8), 0.9, "panel")
        span = w - 2.2
        y = -self.side * (w / 2 - 0.45 - span / 2)
        tall = self.top - 1.02
        rows = 2 if span < 4 else 1
        size = (150, max(24, round(150 * tall / span)))
        f.opening(y, 1.02, span, tall, goods_image(self.trade, "black", self.variant, size, rows, plain=True), 0.3)
        f.builder.box((0.45, span + 0.2, 0.07), (f.front + 0.22, y, 0.98), "light wood")
        f.builder.box((0.06, span, 0.7), (f.front + 0.03, y, 0.16), mix(self.paintwork, "white", 0.25))

    def folding(self) -> None:
        """Tall glazed doors over the whole width."""
        w = self.f.width
        leaves = max(3, round(w / 2.0))
        step = (w - 0.9) / leaves
        for k in range(leaves):
            y = (k - (leaves - 1) / 2) * step
            if k == (leaves // 2 if leaves % 2 else (0 if self.side > 0 else leaves - 1)):
                self._door(y, min(1.3, step - 0.1))
            else:
                self._window(y, step - 0.1, 0.12, 2, k % 2)

    def closed(self) -> None:
        """A shut front: a strong door, small high windows and a lit poster."""
        f, w = self.f, self.f.width
        y = self.side * w / 5
        self._door(y, 1.9 if w > 8 else 1.15, "panel")
        poster = emblem(self.trade, self.variant)
        f.builder.panel(poster, (f.front + 0.03, y - self.side * 2.4, 1.6), 1.7, 1.7)
        size = min(2.2, w * 0.22)
        for k in range(2):
            self._window(-self.side * (0.12 + 0.2 * k) * w - self.side * 0.8, size * 0.8, self.top - 0.95, 1, k)

    def lay(self) -> None:
        layouts = {"side": self.side_door, "middle": self.middle, "wide": self.wide, "counter": self.counter,
                   "closed": self.closed, "folding": self.folding}  # fmt: skip
        layouts[self.trade.fronts[self.variant]]()
        f, back = self.f, self.trade.paints[self.variant][0]
        for y in (-f.width / 2 + 0.2, f.width / 2 - 0.2):
            f.pilaster(y, 0, self.top + 0.2, 0.3, shade(self.paintwork, 0.9))
        tall = self.board
        width = min(f.width - 0.1, 12 * tall)
        board = name_board(self.trade, self.variant, (256, max(18, round(256 * tall / width))))
        f.fascia(0, self.height - tall - 0.08, width, tall, board, back)


def wall_plaque(f: Facade, trade: Trade, variant: int, z: float, radius: float) -> None:
    """A round emblem on the upper wall."""
    f.builder.plate(ngon(20, radius), 0.12, (f.front + 0.07, 0, z), emblem(trade, variant), "dark grey")


def roof_board(f: Facade, trade: Trade, variant: int, size: float) -> None:
    """A square emblem that stands on the roof's edge on struts; on wide shops the name in letters beside it."""
    x, z = f.front - 0.4, f.height
    back, ink = trade.paints[variant]
    text = 3.4 * size if f.width > 14 else 0.0
    for y in (-0.4 * (size + text), 0.4 * (size + text)):
        f.builder.rod((x - 0.1, y, z - 0.05), (x - 0.1, y, z + 0.5 + 0.4 * size), 0.05, "dark grey", sides=5)
    face = emblem(trade, variant)
    at = -text / 2
    f.builder.box((0.14, size, size), (x, at, z + 0.5), "dark grey", skins={"+x": face, "-x": face})
    if text > 0:
        words = images.sign(trade.names[variant], back, ink, (170, 50))
        f.builder.box((0.14, text, size), (x, size / 2, z + 0.5), "dark grey", skins={"+x": words})
