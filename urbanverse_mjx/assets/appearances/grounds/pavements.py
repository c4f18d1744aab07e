"""Pavements that need more than one call to lay: squares of concrete, mosaics, tactile strips, tiles, planks."""

import dataclasses
from collections.abc import Callable

import numpy as np

from . import bases, layouts
from .bases import Colour, Matter
from .board import Board, mix, smoothstep
from .layouts import Laid
from .surface import Surface
from .variants import sett, slab, stone


def squares(colour: Colour, finish: str) -> Callable[[Board], Surface]:
    """Cast concrete in squares: two by two to the tile, with tooled joints."""

    def make(board: Board) -> Surface:
        ground = bases.cast_concrete(board, colour, finish)
        pattern = layouts.courses(board, 2, 2, 0.0)
        tone = board.rng.normal(0.0, 0.025, 4).astype(np.float32)[pattern.number]
        groove = smoothstep((0.007 - pattern.edge) / 0.006 + 0.35)
        # The trowel leaves a smooth margin of 4 cm beside the joint.
        margin = smoothstep((0.045 - pattern.edge) / 0.008) * (finish == "broom")
        image = bases.toned(ground.colour, tone, 0.035 * margin)
        image = image * (1.0 - 0.5 * groove - 0.06 * np.exp(-pattern.edge / 0.03))[..., None]
        height = ground.height * (1 - 0.8 * margin) - 0.005 * groove
        return dataclasses.replace(ground, colour=image, height=height, joint=groove)

    return make


def checks(board: Board, pattern: Laid) -> np.ndarray:
    """Two colours in turn."""
    return (pattern.row + pattern.column) % 2


def coursed(
    rows: int, mean_length: float, variation: float, matter: Matter, uneven: float = 0.0, bend: float = 0.0,
    radius: float = 0.004,
) -> Callable[[Board], Surface]:  # fmt: skip
    def make(board: Board) -> Surface:
        pattern = layouts.random_courses(board, rows, mean_length, variation, radius, bend, uneven)
        return bases.laid(board, pattern, matter)

    return make


def hexagons(columns: int, rows: int, matter: Matter) -> Callable[[Board], Surface]:
    def make(board: Board) -> Surface:
        return bases.laid(board, layouts.cells(board, columns, rows, 0.0, half_offset=True), matter)

    return make


def irregular(across: int, matter: Matter, jitter: float = 0.85, bend: float = 0.006) -> Callable[[Board], Surface]:
    def make(board: Board) -> Surface:
        return bases.laid(board, layouts.cells(board, across, across, jitter, bend=bend, bend_scale=0.15), matter)

    return make


def bows(strips: int, rows: int, per_row: int, matter: Matter) -> Callable[[Board], Surface]:
    def make(board: Board) -> Surface:
        rise = 0.22 * board.metres / strips
        return bases.laid(board, layouts.arcs(board, strips, rows, per_row, rise, 0.015, 0.003), matter)

    return make


def calcada(figure: str) -> Callable[[Board], Surface]:
    """Portuguese pavement: cubes of white limestone with a figure of black basalt: "waves", "stars" or "net"."""
    matter = sett(
        (0.80, 0.77, 0.71), (0.25, 0.25, 0.26), joint_m=0.008, dome=0.002, joint=(0.47, 0.44, 0.39), spread=0.05
    )
    matter = dataclasses.replace(matter, speckle=0.05, roughness=0.6, joint_depth=0.004, uneven_m=0.001)

    def make(board: Board) -> Surface:
        across = round(board.metres / 0.05)
        pattern = layouts.cells(board, across, across, 0.55, bend=0.002, bend_scale=0.1)
        # The colour is that of the stone's seed: no stone is of two colours.
        x = (pattern.column + 0.5) / across
        y = (pattern.row + 0.5) / across
        turn = 2 * np.pi
        if figure == "waves":
            dark = np.sin(turn * (2 * y + 0.20 * np.sin(turn * x))) > 0.1
        elif figure == "net":
            dark = np.abs(np.sin(turn * (x + y))) < 0.20
            dark |= np.abs(np.sin(turn * (x - y))) < 0.20
        else:
            dx, dy = (2 * x) % 1 - 0.5, (2 * y) % 1 - 0.5
            around = np.arctan2(dy, dx)
            dark = np.hypot(dx, dy) < 0.20 + 0.13 * np.cos(8 * around)
        return bases.laid(board, pattern, matter, dark.astype(np.int32))

    return make


#: Tactile paving is laid from slabs of 400 mm with 6 x 6 domes of 25 mm, 5 mm high, or bars of 35 mm (UK guidance on
#: the use of tactile paving, from memory).
TACTILE_SLAB, DOMES, DOME_RADIUS, DOME_HEIGHT = 0.4, 6, 0.0125, 0.005


def tactile(field: Matter, strip: Colour, kind: str, rows: tuple[int, int]) -> Callable[[Board], Surface]:
    """Slabs of 400 mm with rows [first, last) of tactile ones: "domes" (stop) or "bars" (guide, along u)."""

    def make(board: Board) -> Surface:
        count = round(board.metres / TACTILE_SLAB)
        pattern = layouts.courses(board, count, count, 0.0, 0.003)
        special = (pattern.row >= rows[0]) & (pattern.row < rows[1])
        matter = dataclasses.replace(field, colours=(*field.colours, strip))
        plain = board.rng.integers(0, len(field.colours), pattern.count)[pattern.number]
        surface = bases.laid(board, pattern, matter, np.where(special, len(field.colours), plain))
        pitch = TACTILE_SLAB / DOMES
        px, py = (board.x % pitch) - pitch / 2, (board.y % pitch) - pitch / 2
        distance = np.hypot(px, py) if kind == "domes" else np.hypot(py, np.maximum(np.abs(_in_slab(board)) - 0.14, 0))
        radius = DOME_RADIUS if kind == "domes" else 0.0175
        bump = smoothstep((radius - distance) / (0.4 * radius)) * special
        rim = np.clip(1 - np.abs(distance - radius) / (0.5 * radius), 0, 1) * special
        colour = surface.colour * (1 + 0.10 * bump - 0.20 * rim)[..., None]
        return dataclasses.replace(surface, colour=colour, height=surface.height + DOME_HEIGHT * bump)

    return make


def _in_slab(board: Board) -> np.ndarray:
    return (board.x % TACTILE_SLAB) - TACTILE_SLAB / 2


def panot(colour: Colour, figure: str) -> Callable[[Board], Surface]:
    """Pressed cement tiles of 200 mm with a relief: "flower" (four petals) or "bars" (nine squares)."""
    matter = slab(colour, spread=0.05, joint_m=0.004)

    def make(board: Board) -> Surface:
        count = round(board.metres / 0.2)
        pattern = layouts.courses(board, count, count, 0.0, 0.002)
        surface = bases.laid(board, pattern, matter)
        px, py = ((board.x / 0.2) % 1 - 0.5) * 2, ((board.y / 0.2) % 1 - 0.5) * 2
        if figure == "flower":
            around, radius = np.arctan2(py, px), np.hypot(px, py)
            outline = 0.42 + 0.26 * np.abs(np.cos(2 * around))
            groove = np.maximum(np.exp(-(((radius - outline) / 0.05) ** 2)), np.exp(-(((radius - 0.2) / 0.05) ** 2)))
        else:
            cell = np.maximum(np.abs((px * 1.5) % 1 - 0.5), np.abs((py * 1.5) % 1 - 0.5))
            groove = smoothstep((cell - 0.40) / 0.06)
        return dataclasses.replace(
            surface,
            colour=surface.colour * (1 - 0.28 * groove)[..., None],
            height=surface.height - 0.004 * groove,
            joint=np.maximum(surface.joint, 0.8 * groove),
        )

    return make


def planks(colour: Colour) -> Callable[[Board], Surface]:
    """Boards of 140 mm across the path (along v), with grain, knots and a gap of 6 mm."""

    def make(board: Board) -> Surface:
        count = round(board.metres / 0.14)
        width = board.metres / count
        number = np.floor(board.x / width).astype(np.int32) % count
        edge = width / 2 - np.abs(board.x - (number + 0.5) * width)
        jump = board.rng.integers(0, board.size, count)[number]
        rows, columns = np.mgrid[0 : board.size, 0 : board.size].astype(np.int32)
        drawn = board.noise(0.08, 1.2)
        for _ in range(2):  # fibres run along the board
            drawn = drawn + np.roll(drawn, 9, 0) + np.roll(drawn, -23, 0)
        fibre = (drawn / drawn.std())[(rows + jump) % board.size, columns]
        knots = board.share(board.grain(0.05), 0.008, 0.6)
        tone = board.rng.normal(0.0, 0.07, count).clip(-0.15, 0.15).astype(np.float32)[number]
        image = bases.toned(colour, tone, 0.09 * fibre, 0.03 * board.grain(0.006)) * (1 - 0.35 * knots)[..., None]
        inside = np.clip((edge - 0.003) / board.pixel + 0.5, 0, 1)
        height = mix(np.full_like(fibre, -0.012), 0.0005 * fibre - 0.002 * smoothstep(1 - edge / 0.012), inside)
        colour_map = mix(np.full_like(image, 0.10), image, inside)
        return Surface(colour_map, height, 0.8 + 0.04 * fibre, 1 - inside, number)

    return make


def resin_bound(colours: tuple[Colour, ...], stone_m: float) -> Callable[[Board], Surface]:
    """Small rounded stones held in clear resin: level and open-pored."""
    matter = dataclasses.replace(
        stone(*colours, speckle=0.05, joint=(0.30, 0.26, 0.21), roughness=0.7, spread=0.12),
        joint_m=0.002, chamfer_m=0.004, dome_m=0.002, uneven_m=0.0005,
    )  # fmt: skip

    def make(board: Board) -> Surface:
        across = round(board.metres / stone_m)
        return bases.laid(board, layouts.cells(board, across, across, 0.95), matter)

    return make
