"""Named colours of street objects (sRGB, 0-255), shared by all recipes."""

from collections.abc import Sequence

Color = str | Sequence[float]

NAMED: dict[str, tuple[int, int, int]] = {
    "white": (238, 238, 235),
    "off white": (222, 218, 206),
    "cream": (232, 220, 188),
    "black": (28, 28, 30),
    "charcoal": (52, 54, 58),
    "dark grey": (78, 80, 84),
    "grey": (128, 130, 133),
    "light grey": (182, 184, 186),
    "galvanised": (158, 164, 168),
    "aluminium": (190, 194, 198),
    "cast iron": (44, 48, 50),
    "rust": (132, 72, 42),
    "bronze": (104, 78, 48),
    "verdigris": (92, 132, 118),
    "brass": (178, 144, 72),
    "gold": (206, 166, 66),
    "concrete": (164, 162, 155),
    "dark concrete": (120, 119, 114),
    "granite": (136, 134, 132),
    "sandstone": (198, 172, 130),
    "marble": (226, 224, 218),
    "brick": (150, 74, 56),
    "terracotta": (184, 98, 64),
    "asphalt": (62, 62, 64),
    "soil": (70, 50, 36),
    "wood": (156, 108, 64),
    "light wood": (196, 156, 104),
    "dark wood": (92, 60, 38),
    "grey wood": (138, 126, 112),
    "bark": (84, 66, 50),
    "leaf": (64, 112, 48),
    "dark leaf": (40, 80, 40),
    "light leaf": (118, 156, 66),
    "yellow leaf": (196, 164, 60),
    "grass": (88, 128, 56),
    "water": (92, 142, 164),
    "glass": (128, 156, 170),
    "dark glass": (44, 56, 66),
    "mirror": (176, 190, 198),
    "rubber": (34, 34, 34),
    "red": (188, 32, 36),
    "signal red": (204, 30, 32),
    "dark red": (122, 26, 30),
    "orange": (232, 104, 24),
    "safety orange": (246, 94, 20),
    "amber": (250, 170, 40),
    "yellow": (240, 200, 40),
    "signal yellow": (250, 206, 22),
    "green": (44, 130, 66),
    "dark green": (26, 72, 46),
    "lime": (150, 190, 60),
    "teal": (34, 128, 128),
    "blue": (36, 84, 164),
    "signal blue": (12, 82, 164),
    "dark blue": (26, 44, 92),
    "light blue": (124, 176, 216),
    "purple": (104, 60, 132),
    "pink": (222, 140, 158),
    "brown": (108, 74, 48),
    "beige": (208, 188, 154),
    "cardboard": (184, 142, 96),
    "lamp": (255, 246, 214),
    "light red": (255, 60, 50),
    "light green": (70, 250, 130),
    "skin light": (236, 196, 168),
    "skin medium": (198, 146, 108),
    "skin dark": (112, 76, 54),
}


def rgb(color: Color) -> tuple[int, int, int]:
    """A palette name, '#rrggbb', or three numbers in 0-255, as three whole numbers.

    Raises:
      ValueError: the name is not in the palette.
    """
    if isinstance(color, str):
        if color.startswith("#") and len(color) == 7:
            return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)
        if color not in NAMED:
            raise ValueError(
                f"colour: found {color!r}, needed a name of palette.NAMED or '#rrggbb'; add it to palette.NAMED."
            )
        return NAMED[color]
    red, green, blue = (round(min(max(float(c), 0.0), 255.0)) for c in color)
    return red, green, blue


def shade(color: Color, factor: float) -> tuple[int, int, int]:
    """The colour made darker (factor < 1) or lighter (> 1)."""
    return rgb([c * factor for c in rgb(color)])


def mix(first: Color, second: Color, share: float) -> tuple[int, int, int]:
    """`share` of the second colour in the first."""
    return rgb([a + (b - a) * share for a, b in zip(rgb(first), rgb(second), strict=True)])
