"""Images of whole fronts and of single windows, drawn from the forms of a tradition."""

import numpy as np
from PIL import Image

from ...assets.meshes import paint
from ...assets.meshes.palette import rgb, shade
from ...assets.recipes.building.facade import bays_over
from ...assets.recipes.building.regional import panes, words
from ...assets.recipes.building.regional.styles import TRADES, Form, nth

#: Pixels of a front, of which the upper `ROOF` show its roof, and of a window with its frame.
FRONT, ROOF, WINDOW = 128, 14, 32
#: Ground floors with shops.
SHOPS = ("timber", "shutters", "glass", "lattice", "strip")
#: Roofs that slope towards the street.
PITCHED = ("tiles", "eaves", "sheet", "hip", "mansard", "gabled", "dutch")
#: Share of a window's image that its surround takes at each edge.
SURROUND = 0.09


def height_of(form: Form, floors: int) -> float:
    """m, from the ground to the eaves."""
    return form.ground_height + (floors - 1) * form.storey + form.attic


def front(form: Form, size: tuple[float, int], dressing: int, language: str, rng: np.random.Generator) -> np.ndarray:
    """(FRONT, FRONT, 3) uint8 of a front with its windows, shops and signs, a strip of its roof above it."""
    width, floors = float(size[0]), int(size[1])
    tall = height_of(form, floors)
    wide, high = 3 * FRONT, 3 * (FRONT - ROOF)
    across, up = wide / width, high / tall
    color = nth(form.colors, dressing)
    image = panes.cladding(form.wall, (width, tall), color, rng).convert("RGB").resize((wide, high))

    def put(part: Image.Image, y: float, z: float, w: float, h: float) -> None:
        box = (max(2, round(w * across)), max(2, round(h * up)))
        image.paste(part.resize(box), (round((y + width / 2) * across - box[0] / 2), round(high - (z + h) * up)))

    def plain(y: float, z: float, w: float, h: float, tone: object) -> None:
        put(Image.new("RGB", (4, 4), rgb(tone)), y, z, w, h)  # type: ignore[arg-type]

    frame, trim, base = nth(form.frame, dressing), nth(form.trim, dressing), nth(form.base, dressing)
    plain(0.0, 0.0, width, form.ground_height - 0.05, base)
    pane = [panes.pane(form.window, frame, rng) for _ in range(2)]
    count = max(1, round((width - 0.5) / form.spacing))
    w, h = form.window_size
    for level in range(floors):
        if level == 0 and form.ground in SHOPS:
            continue
        z = (form.ground_height + (level - 1) * form.storey if level else 0.3) + form.sill
        for k, y in enumerate(bays_over(count, width - 0.5)):
            if level == 0 and k == count // 2:
                plain(y, 0.1, 1.1, 2.2, shade(nth(form.frame, dressing + 1), 0.5))
                continue
            plain(y, z - 0.12, w + 0.25, h + 0.24, trim)
            put(pane[int(rng.integers(2))], y, z, w, h)
    if form.ground in SHOPS and language:
        _shops(form, width, dressing, language, rng, put)
    plain(0.0, tall - 0.25, width, 0.25, trim)
    whole = Image.new("RGB", (wide, 3 * FRONT))
    roof = panes.tiled("tiles", nth(form.roof_colors, dressing), (wide, 3 * ROOF), 3, 24)
    whole.paste(Image.fromarray(roof), (0, 0))
    whole.paste(image, (0, 3 * ROOF))
    return np.asarray(paint.shrunk(whole, (FRONT, FRONT)))


def _shops(form: Form, width: float, dressing: int, language: str, rng: np.random.Generator, put) -> None:
    """Shop windows with boards above them, `put` by their lower middle and size."""
    units = max(1, round(width / form.unit))
    table = words.languages()[language]
    for k, y in enumerate(bays_over(units, width)):
        trade = TRADES[int(rng.integers(len(TRADES)))]
        wide = width / units - 0.3
        put(panes.shop(trade, nth(form.frame, dressing), rng, (64, 48)), y, 0.25, wide, form.ground_height - 1.15)
        back, ink = nth(form.boards, dressing + 2 * k)
        entry = table[trade][int(rng.integers(len(table[trade])))]
        board = panes.sign(language, entry, back, ink, (max(16, round(wide * 36)), 28))
        put(board, y, form.ground_height - 0.85, wide, 0.7)


def window(form: Form, dressing: int, rng: np.random.Generator) -> np.ndarray:
    """(WINDOW, WINDOW, 3) uint8 of a window in its surround."""
    side = 4 * WINDOW
    image, _ = paint.canvas((side, side), nth(form.trim, dressing))
    edge = round(side * SURROUND)
    pane = panes.pane(form.window, nth(form.frame, dressing), rng).convert("RGB")
    image.paste(pane.resize((side - 2 * edge, side - 2 * edge)), (edge, edge))
    return np.asarray(paint.shrunk(image, (WINDOW, WINDOW)))
