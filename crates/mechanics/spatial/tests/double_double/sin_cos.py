"""Golden sines and cosines of double-double angles: python3 sin_cos.py > sin_cos.txt (needs mpmath; 1.3.0 was used).

Each line: bits of the upper part, bits of the lower part, sine, cosine, the two to 70 digits.
"""

import struct

from mpmath import mp, mpf, nstr, pi

mp.prec = 4000  # 1100 bits for the largest angle's reduction, 70 digits next to a zero, and a wide margin


def split(x: mpf) -> tuple[float, float]:
    """Find the nearest double, and what is left."""
    upper = float(x)
    return upper, float(x - mpf(upper))


def bits(x: float) -> str:
    """Write the bits of a double."""
    return struct.pack(">d", x).hex()


angles = []
# Tiny and moderate, with and without a lower part, and every table entry's neighbourhood.
angles += [(x, 0.0) for x in (1e-300, 1e-30, 1e-8, 0.5, 1.0, 2.0, 3.0, 100.0, 1e5, 1e9, 1.6e9, 1.7e9, 1e15, 1e22, 1e100, 1e300)]
angles += [split(mpf(k) / 128 + mpf(k) / 3 / 2**20) for k in range(1, 102, 5)]
# The doubles nearest to multiples of pi/2: of all doubles, and of those below 2**30 (Muller, Elementary Functions, chapter 11).
angles += [(6381956970095103.0 * 2.0**797, 0.0), (5.319372648326541416707296656673541083813475031793921822e255, 0.0)]
# The largest double, subnormal lower parts, lower parts far below the upper one.
angles += [(1.7976931348623157e308, 0.0), (1.5, 5e-324), (1e300, 1e-300), (1e300, 1.0), (1e22, 0.25), (2.0**60, 2.0**-40)]
# Double-doubles nearest to multiples of pi/2.
angles += [split(k * pi / 2) for k in (1, 2, 3, 4, 7, 50, 1000, 10**6, 10**9, 2**31 + 1)]
angles += [split(k * pi / 2) for k in (10**12 + 1, 10**15 + 3, 10**18 + 1, 2**100 + 1, 2**900 + 1)]
# Next to them.
angles += [split(k * pi / 2 + mpf(2) ** -j) for k in (1, 2, 1001, 10**8 + 3) for j in (10, 19, 20, 21, 40, 60)]

for upper, lower in angles:
    for sign in (1.0, -1.0):
        x = mpf(sign * upper) + mpf(sign * lower)
        print(bits(sign * upper), bits(sign * lower), nstr(mp.sin(x), 70), nstr(mp.cos(x), 70))
