"""The middle line of a street, made of straight pieces that meet at bends, and coordinates along and across it."""

import dataclasses
import math
from collections.abc import Sequence

Point = tuple[float, float]


@dataclasses.dataclass(frozen=True)
class Piece:
    """A straight piece that starts at `origin` (m), `begin` m from the street's start, with heading `yaw` (rad)."""

    begin: float
    end: float
    origin: Point
    yaw: float

    @property
    def along(self) -> Point:
        return math.cos(self.yaw), math.sin(self.yaw)

    @property
    def across(self) -> Point:
        """Unit vector to the left."""
        return -math.sin(self.yaw), math.cos(self.yaw)

    def plane(self, rise_along: float, rise_across: float, level: float) -> tuple[float, float, float]:
        """Returns (a, b, c) of the plane z = rise_along · (s - begin) + rise_across · t + level."""
        (ux, uy), (nx, ny), (ox, oy) = self.along, self.across, self.origin
        a, b = rise_along * ux + rise_across * nx, rise_along * uy + rise_across * ny
        return a, b, level - a * ox - b * oy


class StreetLine:
    """Maps s (m along) and t (m across, left is positive) to positions."""

    def __init__(self, length: float, bends: Sequence[float]) -> None:
        """Makes a line that turns by each of `bends` (degrees, left is positive), at equal distances."""
        self.length = length
        count = len(bends) + 1
        self.pieces: list[Piece] = []
        origin, yaw = (0.0, 0.0), -math.radians(sum(bends)) / 2  # so that the street as a whole runs along +x
        for k in range(count):
            step = length / count
            self.pieces.append(Piece(k * step, (k + 1) * step, origin, yaw))
            origin = (origin[0] + step * math.cos(yaw), origin[1] + step * math.sin(yaw))
            yaw += math.radians(bends[k]) if k < len(bends) else 0.0

    @property
    def joints(self) -> list[float]:
        """Returns s of each bend."""
        return [p.begin for p in self.pieces[1:]]

    def piece_at(self, s: float) -> Piece:
        return next((p for p in self.pieces if s < p.end), self.pieces[-1])

    def place(self, s: float, t: float, piece: Piece | None = None) -> Point:
        """Returns (x, y) of a position, perpendicular to its piece; beyond both ends the line continues straight."""
        piece = piece or self.piece_at(s)
        (ux, uy), (nx, ny) = piece.along, piece.across
        ds = s - piece.begin
        return piece.origin[0] + ds * ux + t * nx, piece.origin[1] + ds * uy + t * ny

    def shift(self, piece: Piece, s: float, t: float) -> float:
        """Returns by how many metres a piece's outline at offset t ends earlier (negative) or later than s, mitred at
        bends."""
        k = self.pieces.index(piece)
        if abs(s - piece.end) < 1e-9 and k + 1 < len(self.pieces):
            return -t * math.tan((self.pieces[k + 1].yaw - piece.yaw) / 2)
        if abs(s - piece.begin) < 1e-9 and k > 0:
            return t * math.tan((piece.yaw - self.pieces[k - 1].yaw) / 2)
        return 0.0

    def corner(self, piece: Piece, s: float, t: float) -> Point:
        """Returns (x, y) of a corner of the ground; at bends it lies on the mitre, so that both pieces share it."""
        return self.place(s + self.shift(piece, s, t), t, piece)

    def yaw(self, s: float) -> float:
        """Returns the heading (rad) of the street."""
        return self.piece_at(s).yaw
