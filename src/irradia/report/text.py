"""Numbers as people read them."""

from __future__ import annotations

import math

_SI = ((1e9, "G"), (1e6, "M"), (1e3, "k"))
_BINARY = ((1 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB"))


def rate(value: float | None, unit: str) -> str:
    """``12.3 M samples/s``; a dash where it is unknown."""
    if value is None or not math.isfinite(value):
        return "–"
    for factor, prefix in _SI:
        if value >= factor:
            return f"{value / factor:.3g} {prefix} {unit}"
    return f"{value:.3g} {unit}"


def size(n_bytes: float | None) -> str:
    """``1.5 GiB``; a dash where it is unknown."""
    if n_bytes is None:
        return "–"
    for factor, unit in _BINARY:
        if n_bytes >= factor:
            return f"{n_bytes / factor:.3g} {unit}"
    return f"{n_bytes:.0f} B"


def duration(seconds: float) -> str:
    """``0.42 s``, ``12.3 s``, ``2 min 5 s``."""
    if seconds < 10:
        return f"{seconds:.2f} s"
    if seconds < 100:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest} s"


def count(value: float) -> str:
    """``821 000``, grouped by narrow spaces; fractions keep three digits."""
    if not math.isfinite(value):
        return "–"
    if float(value).is_integer():
        return f"{int(value):,}".replace(",", "\u202f")
    return f"{value:.3g}"


def stops(exposure_ev: float) -> str:
    """An exposure: ``−1.9 EV``."""
    return f"{exposure_ev:+.1f} EV".replace("-", "−")


def score(value: float) -> str:
    """A metric: four significant digits, small ones in powers of ten."""
    if not math.isfinite(value):
        return "∞" if value > 0 else "–"
    if value != 0 and abs(value) < 1e-3:
        mantissa, exponent = f"{value:.2e}".split("e")
        return f"{mantissa} × 10<sup>{int(exponent)}</sup>".replace("<sup>-", "<sup>−")
    return f"{value:.4g}"
