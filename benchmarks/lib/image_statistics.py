"""Statistics of single images that distinguish photographs of streets from other images.

All are computed from the encoded values of an image (sRGB, 0 to 1), because data sets publish such values.
"""

import numpy as np
from PIL import Image
from scipy.ndimage import sobel

#: Rows of an image before anything is computed; the columns follow. Detail depends on resolution.
ROWS = 360
#: Cycles per pixel between which the slope is fitted: lower ones are the window's, higher ones the sampling's.
BAND = (0.02, 0.35)
#: Rec. 709 weights of red, green and blue.
LUMA = np.array([0.2126, 0.7152, 0.0722])
#: rad to both sides of an axis that count as horizontal or vertical. All directions alike would give a quarter.
CARDINAL = np.pi / 16
#: Statistic -> description, in the order of tables.
STATISTICS = {
    "slope": "exponent a of the amplitude spectrum, 1/f^a",
    "brightness": "mean of the luma",
    "contrast": "standard deviation of the luma",
    "darkest": "5 % quantile of the luma",
    "brightest": "95 % quantile of the luma",
    "red_green": "mean of red minus green",
    "blue_green": "mean of blue minus green",
    "colourfulness": "Hasler and Suesstrunk's measure, of values 0 to 255",
    "saturated": "share of pixels with a saturation over 0.5",
    "cardinal": "share of gradient within 11.25 degrees of horizontal or vertical",
    "upright": "share of vertical edges in these",
}


def statistics(image: np.ndarray) -> dict[str, float]:
    """All statistics of an image, by `STATISTICS`.

    Args:
      image: (h, w, 3) uint8, sRGB; scaled to `ROWS` rows.
    """
    scaled = scale(image)
    luma = scaled @ LUMA
    high, low = scaled.max(-1), scaled.min(-1)
    saturation = np.where(high > 0, (high - low) / np.maximum(high, 1e-6), 0.0)
    cardinal, upright = edges(luma)
    return {
        "slope": amplitude_slope(luma),
        "brightness": float(luma.mean()),
        "contrast": float(luma.std()),
        "darkest": float(np.quantile(luma, 0.05)),
        "brightest": float(np.quantile(luma, 0.95)),
        "red_green": float((scaled[..., 0] - scaled[..., 1]).mean()),
        "blue_green": float((scaled[..., 2] - scaled[..., 1]).mean()),
        "colourfulness": colourfulness(scaled),
        "saturated": float((saturation > 0.5).mean()),
        "cardinal": cardinal,
        "upright": upright,
    }


def scale(image: np.ndarray) -> np.ndarray:
    """(`ROWS`, columns, 3) in 0 to 1: an image (h, w, 3) uint8 scaled by box filtering or bilinearly."""
    height, width = image.shape[:2]
    if height != ROWS:
        kind = Image.Resampling.BOX if height > ROWS else Image.Resampling.BILINEAR
        image = np.asarray(Image.fromarray(image).resize((round(width * ROWS / height), ROWS), kind))
    return image.astype(float) / 255.0


def amplitude_slope(luma: np.ndarray) -> float:
    """Exponent a of the amplitude spectrum 1/f^a of the largest square in the middle of an image (h, w).

    The amplitudes are averaged over all directions before a line is fitted to their logarithms, in rings of equal
    width in log f, as Tolhurst, Tadmor and Chao (1992) do.
    """
    size = min(luma.shape)
    top, left = ((n - size) // 2 for n in luma.shape)
    square = luma[top : top + size, left : left + size]
    window = np.hanning(size)
    amplitude = np.abs(np.fft.fft2((square - square.mean()) * np.outer(window, window)))
    frequency = np.hypot(*np.meshgrid(np.fft.fftfreq(size), np.fft.fftfreq(size)))
    rings = np.geomspace(*BAND, 25)
    ring = np.digitize(frequency, rings)
    used = [k for k in range(1, len(rings)) if (ring == k).any()]
    x = [np.log(frequency[ring == k]).mean() for k in used]
    y = [np.log(max(amplitude[ring == k].mean(), 1e-12)) for k in used]
    return -float(np.polyfit(x, y, 1)[0])


def colourfulness(image: np.ndarray) -> float:
    """Colourfulness of an image (h, w, 3) in 0 to 1: Hasler and Suesstrunk (2003), equations 1 to 3, for 0 to 255."""
    red, green, blue = np.moveaxis(255.0 * image, -1, 0)
    opponents = red - green, 0.5 * (red + green) - blue
    spread = np.hypot(*(x.std() for x in opponents))
    mean = np.hypot(*(x.mean() for x in opponents))
    return float(spread + 0.3 * mean)


def edges(luma: np.ndarray) -> tuple[float, float]:
    """Share of horizontal and vertical edges in all, by gradient magnitude, and of the vertical ones in these."""
    across, down = sobel(luma, 1)[1:-1, 1:-1], sobel(luma, 0)[1:-1, 1:-1]
    strength = np.hypot(across, down)
    angle = np.arctan2(np.abs(down), np.abs(across))  # 0: brightness changes from left to right, a vertical edge
    vertical = strength[angle <= CARDINAL].sum()
    horizontal = strength[angle >= np.pi / 2 - CARDINAL].sum()
    both = vertical + horizontal
    return float(both / max(strength.sum(), 1e-9)), float(vertical / max(both, 1e-9))
