# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Where the sun stands at a place and time: M. Blanco-Muriel et al., "Computing the Solar Vector", Solar Energy 70(5),
2001, good to half a minute of arc from 1999 to 2015 and to a few minutes around."""

from __future__ import annotations

import math

from eclat.errors import EclatError
from eclat.loaders.mitsuba.node import Node, Vector


def sun_direction(node: Node) -> Vector:
    """Towards the sun from a sky's year, month, day, hour, minute, second, latitude, longitude (degrees), timezone.

    In 0.x +x is east, +y up and +z south; in 3.x +x south, +y west and +z up. Without a time and a place it is
    Tokyo on the afternoon of 10 July 2010, as in Mitsuba.
    """
    hours = node.number("hour", default=15.0) + node.number("minute", default=0.0) / 60
    hours += node.number("second", default=0.0) / 3600 - node.number("timezone", default=9.0)
    year, month, day = (node.integer(name, default=d) for name, d in (("year", 2010), ("month", 7), ("day", 10)))
    if not (1 <= month <= 12 and 1 <= day <= 31 and abs(year) < 10_000 and abs(hours) < 1000):
        raise EclatError(f"{node.where}: expected a date and time, got {year}-{month}-{day}, {hours:g} h")
    latitude = math.radians(node.number("latitude", default=35.6894))
    longitude = math.radians(node.number("longitude", default=139.6917))
    south, west, up = horizontal(_julian_day(year, month, day) + hours / 24, hours, latitude, longitude)
    return (-west, up, south) if node.legacy else (south, west, up)


def horizontal(julian_day: float, hours: float, latitude: float, longitude: float) -> Vector:
    """Unit vector (south, west, up) to the sun; `hours` of universal time, angles in radians."""
    n = julian_day - 2451545.0
    omega = 2.1429 - 0.0010394594 * n
    mean_longitude = 4.8950630 + 0.017202791698 * n
    anomaly = 6.2400600 + 0.0172019699 * n
    ecliptic = mean_longitude + 0.03341607 * math.sin(anomaly) + 0.00034894 * math.sin(2 * anomaly)
    ecliptic += -0.0001134 - 0.0000203 * math.sin(omega)
    obliquity = 0.4090928 - 6.2140e-9 * n + 0.0000396 * math.cos(omega)
    right_ascension = math.atan2(math.cos(obliquity) * math.sin(ecliptic), math.cos(ecliptic))
    declination = math.asin(math.sin(obliquity) * math.sin(ecliptic))
    sidereal = math.radians((6.6974243242 + 0.0657098283 * n + hours) * 15)
    hour_angle = sidereal + longitude - right_ascension
    sine, cosine = math.sin(latitude), math.cos(latitude)
    equatorial = math.cos(hour_angle) * math.cos(declination)
    up = cosine * equatorial + sine * math.sin(declination)
    south = sine * equatorial - cosine * math.sin(declination)
    west = math.sin(hour_angle) * math.cos(declination)
    return south, west, up


def _julian_day(year: int, month: int, day: int) -> float:
    """The Julian day at 0 h universal time of a date in the Gregorian calendar."""
    shift = (14 - month) // 12
    y, m = year + 4800 - shift, month + 12 * shift - 3
    return day + (153 * m + 2) // 5 + 365 * y + y // 4 - y // 100 + y // 400 - 32045 - 0.5
