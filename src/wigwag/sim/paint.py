"""What an operator looks like: skin, hair, clothes and build, drawn from a seed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wigwag.sim.shapes import linear_rgb

SKIN = ("#f3d3bd", "#e8b995", "#d29b73", "#b67c52", "#8d5a3a", "#5e3a26")
HAIR = ("#191512", "#2e211a", "#4c3424", "#7a5230", "#b98d54", "#6f6a66")
SHIRTS = (
    "#c8372f", "#2456a6", "#e9e6df", "#1f2430", "#e07b1f", "#6d2f73", "#1d7f86", "#e3c13a", "#7fb4dd",
)  # fmt: skip
TROUSERS = ("#22304f", "#1d1e22", "#5a4a3c", "#3b4656", "#7c7467", "#2c3a34")
SHOES = ("#e8e6e2", "#17181b", "#a53a2c", "#3f4a5c", "#d8b13a")


@dataclass(frozen=True, slots=True)
class Look:
    """How a person is painted and built. Colours are display colours, ``"#rrggbb"``.

    The pose network takes front for back if face or hair are missing, and reads wrists best on bare
    forearms, so both are always there.

    Example:
        >>> Look.from_seed(3) == Look.from_seed(3)
        True
    """

    skin: str = "#d29b73"
    hair: str = "#2e211a"
    shirt: str = "#c8372f"
    shirt_below: str | None = None
    """Colour of the shirt below the ribs; the shirt's own if ``None``."""
    trousers: str = "#22304f"
    shoes: str = "#e8e6e2"
    beard: bool = False
    long_hair: bool = False
    shorts: bool = False
    sleeve: float = 0.72
    """Share of the upper arm that the sleeve covers, 0 to 1; the forearm stays bare."""
    height_m: float = 1.75
    """Sets how thick limbs are and how large head, hands and feet; joints set their lengths."""
    girth: float = 1.0
    """Scale of trunk and limb thickness, 0.85 slim to 1.2 stout."""

    @classmethod
    def from_seed(cls, seed: int, height_m: float | None = None) -> Look:
        """Draw a look that the ground's green and grey do not swallow.

        Args:
            seed: The same seed gives the same look.
            height_m: Taken as it is; drawn between 1.58 and 1.92 if ``None``.
        """
        rng = np.random.default_rng([seed, 0x100C])
        shirt = str(rng.choice(SHIRTS))
        # Trousers that the shirt can be told from, so that the waist is seen.
        trousers = str(rng.choice([c for c in TROUSERS if _contrast(c, shirt) > 0.06]))
        shoes = str(rng.choice([c for c in SHOES if _contrast(c, trousers) > 0.05]))
        below = str(rng.choice([c for c in SHIRTS if c != shirt])) if rng.random() < 0.25 else None
        skin = str(rng.choice(SKIN))
        hair = str(rng.choice([c for c in HAIR if _contrast(c, skin) > 0.09]))
        drawn = float(rng.uniform(1.58, 1.92))
        return cls(
            skin=skin, hair=hair, shirt=shirt, shirt_below=below,
            trousers=trousers, shoes=shoes, beard=bool(rng.random() < 0.25),
            long_hair=bool(rng.random() < 0.35), shorts=bool(rng.random() < 0.2),
            sleeve=float(rng.uniform(0.55, 0.85)), height_m=drawn if height_m is None else height_m,
            girth=float(rng.uniform(0.9, 1.15)),
        )  # fmt: skip


def _contrast(one: str, other: str) -> float:
    """Largest difference in a channel of linear light."""
    return max(abs(a - b) for a, b in zip(linear_rgb(one), linear_rgb(other), strict=True))
