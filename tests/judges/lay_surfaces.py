"""Exact Gaussian maps of a closed covariance, by circulant embedding.

The covariances are sums of Gaussians of many widths, so that no spectrum is involved
that a fit uses: with equal exponents they are Matern's, with others they scale
differently along the lay and across it.
"""

import numpy as np

NODES = 300


def mixture(hurst, skew):
    """Return squared widths along and across, and the share of each Gaussian.

    A gamma distribution of t with the density t^(p-1) exp(-t) turns exp(-t q^2) into
    (1 + q^2)^(-p), p = 1 + H; a width t^(1+e) along and t^(1-e) across scales lines
    with H / (1 + e) and H / (1 - e).
    """
    edge = np.linspace(np.log(1e-14), np.log(80), NODES + 1)
    t = np.exp(0.5 * (edge[1:] + edge[:-1]))
    # The Gaussian in wavenumbers integrates to pi / t.
    share = t ** (1 + hurst) * np.exp(-t) / t * np.diff(edge)
    return t ** (1 + skew), t ** (1 - skew), share / share.sum()


def covariance(x, y, *, hurst, along, across, angle=0.0, skew=0.0, blur=0.0):
    """Return the covariance of heights of variance 1 at distances x and y.

    Args:
        x: distance along the rows.
        y: distance down the columns.
        hurst: H; along the lay H / (1 + skew), across it H / (1 - skew).
        along: roll-off wavelength along the lay, in the unit of x and y.
        across: the same across it.
        angle: of the lay from x towards y [rad].
        skew: 0 for Matern's covariance.
        blur: standard deviation of a Gaussian blur before the sampling.
    """
    u = x * np.cos(angle) + y * np.sin(angle)
    v = y * np.cos(angle) - x * np.sin(angle)
    total = np.zeros(np.broadcast_shapes(np.shape(x), np.shape(y)))
    for wide, high, share in zip(*mixture(hurst, skew), strict=True):
        bare = 2 * wide * (along / 2 / np.pi) ** 2, 2 * high * (across / 2 / np.pi) ** 2
        first, second = (one + 2 * blur**2 for one in bare)
        size = share * np.sqrt(bare[0] * bare[1] / (first * second))
        total += size * np.exp(-(u**2) / (2 * first) - v**2 / (2 * second))
    return total


def rms_in_rings(low, high, *, hurst, along, across, skew=0.0):
    """Return rms height, slope and curvature of lines, of waves in a ring.

    Args:
        low: lowest wavenumber [rad per unit of length].
        high: highest.
        hurst: H, as in `covariance`.
        along: roll-off wavelength along the lay.
        across: the same across it.
        skew: as in `covariance`.
    """
    radius = np.geomspace(low, high, 400)
    q = np.sqrt(radius[1:] * radius[:-1])[:, None]
    turn = (np.arange(400) + 0.5) * np.pi / 2 / 400
    corner = 2 * np.pi / np.array([along, across])
    total = np.zeros((q.size, turn.size))
    for wide, high_, share in zip(*mixture(hurst, skew), strict=True):
        size = np.sqrt(wide * high_) / (np.pi * corner[0] * corner[1])
        square = (q * np.cos(turn) / corner[0]) ** 2 * wide
        square = square + (q * np.sin(turn) / corner[1]) ** 2 * high_
        total += share * size * np.exp(-square)
    ring = 2 * np.pi * q[:, 0] * total.mean(axis=1) * np.diff(radius)
    factors = (1.0, 0.5, 0.375)
    return [
        float(np.sqrt(f * np.sum(ring * q[:, 0] ** k)))
        for f, k in zip(factors, (0, 2, 4), strict=True)
    ]


class Embedded:
    """Draws of maps with one covariance, exact where the embedding is positive."""

    def __init__(self, shape, **parts):
        size = [2 * n * parts.pop("margin", 1) for n in shape]
        index = [np.minimum(np.arange(n), n - np.arange(n)) for n in size]
        sign = [np.where(np.arange(n) > n // 2, -1, 1) for n in size]
        y, x = (i * s for i, s in zip(index, sign, strict=True))
        first = covariance(x[None, :], y[:, None], **parts)
        values = np.fft.fft2(first).real
        self.negative = float(-values.min() / values.max())
        self.root = np.sqrt(np.maximum(values, 0) / values.size)
        self.shape = shape

    def draw(self, rng):
        """Return two independent maps."""
        white = rng.standard_normal((2, *self.root.shape))
        both = np.fft.fft2(self.root * (white[0] + 1j * white[1]))
        rows, columns = self.shape
        part = both[:rows, :columns]
        return part.real, part.imag
