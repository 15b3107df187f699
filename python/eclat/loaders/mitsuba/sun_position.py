# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Compute the direction to the sun at a place and a time.

The algorithm is that of M. Blanco-Muriel et al., "Computing the Solar Vector", Solar Energy 70(5), 2001. Its error is at
most half an arc minute from 1999 to 2015, and a few arc minutes in the decades before and after.
"""

from __future__ import annotations

import math

from eclat.errors import EclatError
from eclat.loaders.mitsuba.node import Node, Vector


def sun_direction(node: Node) -> Vector:
    """Compute the unit vector towards the sun from the properties of a sun or sky emitter.

    These are year, month, day, hour, minute, second and timezone (in hours), and latitude and longitude (in degrees).
    The default is Tokyo at 15:00 on 10 July 2010, as in Mitsuba.

    Returns
    -------
    The direction in the coordinates of the emitter. In version 0.x, +x is east, +y is up and +z is south. In version
    3.x, +x is south, +y is west and +z is up.

    Raises
    ------
    EclatError : the date or the time is out of range.
    """
    hours = node.number("hour", default=15.0) + node.number("minute", default=0.0) / 60
    hours += node.number("second", default=0.0) / 3600 - node.number("timezone", default=9.0)
    year, month, day = (node.integer(name, default=d) for name, d in (("year", 2010), ("month", 7), ("day", 10)))
    if not (1 <= month <= 12 and 1 <= day <= 31 and abs(year) < 10_000 and abs(hours) < 1000):
        raise EclatError(f"{node.where}: expected a valid date and time, got {year}-{month}-{day}, {hours:g} h")
    latitude = math.radians(node.number("latitude", default=35.6894))
    longitude = math.radians(node.number("longitude", default=139.6917))
    south, west, up = horizontal(_julian_day(year, month, day) + hours / 24, hours, latitude, longitude)
    return (-west, up, south) if node.legacy else (south, west, up)


def horizontal(julian_day: float, hours: float, latitude: float, longitude: float) -> Vector:
    """Compute the unit vector (south, west, up) towards the sun.

    Parameters
    ----------
    julian_day : the Julian day, with its fraction.
    hours : the universal time in hours.
    latitude, longitude : the place, in radians.
    """
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
    """Return the Julian day of a date in the Gregorian calendar, at 0 h universal time."""
    shift = (14 - month) // 12
    y, m = year + 4800 - shift, month + 12 * shift - 3
    return day + (153 * m + 2) // 5 + 365 * y + y // 4 - y // 100 + y // 400 - 32045 - 0.5
