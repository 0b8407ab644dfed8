"""Small helpers shared by the model generators: rotations, numbers as text, and an MJCF writer.

Poses are (pos, quat) with quat w first, as in MJCF. Only the Python standard library is used.
"""

import math
import xml.etree.ElementTree as ET

IDENTITY = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))


def normalized(v):
    n = math.sqrt(sum(x * x for x in v))
    return tuple(x / n for x in v)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def multiply(a, b):
    """Product of two quaternions."""
    return (a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
            a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0])


def conjugate(q):
    return (q[0], -q[1], -q[2], -q[3])


def rotate(q, v):
    return multiply(multiply(q, (0.0, *v)), conjugate(q))[1:]


def compose(a, b):
    """X_AC from X_AB and X_BC."""
    p = rotate(a[1], b[0])
    return (tuple(a[0][i] + p[i] for i in range(3)), normalized(multiply(a[1], b[1])))


def inverse(a):
    q = conjugate(a[1])
    return (tuple(-x for x in rotate(q, a[0])), q)


def transform(a, p):
    """p_AQ from X_AB and p_BQ."""
    r = rotate(a[1], p)
    return tuple(a[0][i] + r[i] for i in range(3))


def quat_from_axes(x, y, z):
    """Quaternion of the rotation whose columns are x, y, z."""
    trace = x[0] + y[1] + z[2]
    candidates = [trace, x[0] - y[1] - z[2], y[1] - x[0] - z[2], z[2] - x[0] - y[1]]
    largest = max(range(4), key=lambda i: candidates[i])
    s = 2.0 * math.sqrt(1.0 + candidates[largest])
    if largest == 0:
        q = (s / 4, (y[2] - z[1]) / s, (z[0] - x[2]) / s, (x[1] - y[0]) / s)
    elif largest == 1:
        q = ((y[2] - z[1]) / s, s / 4, (y[0] + x[1]) / s, (z[0] + x[2]) / s)
    elif largest == 2:
        q = ((z[0] - x[2]) / s, (y[0] + x[1]) / s, s / 4, (z[1] + y[2]) / s)
    else:
        q = ((x[1] - y[0]) / s, (z[0] + x[2]) / s, (z[1] + y[2]) / s, s / 4)
    return normalized(q)


def text(value, digits=9):
    """A number, or numbers, as MJCF text without trailing zeros or negative zeros."""
    if isinstance(value, str):
        return value
    if isinstance(value, (int, float)):
        return f"{round(value, digits) + 0.0:.{digits}f}".rstrip("0").rstrip(".")
    return " ".join(text(x, digits) for x in value)


def add(parent, tag, **attributes):
    """Appends an element; attribute values may be numbers or sequences, None leaves one out."""
    return ET.SubElement(parent, tag, {k.rstrip("_"): text(v) for k, v in attributes.items()
                                       if v is not None})


def remark(parent, words):
    parent.append(ET.Comment(f" {words} "))


def write(root, path):
    ET.indent(root, "  ")
    with open(path, "w", encoding="utf-8") as f:
        f.write(ET.tostring(root, encoding="unicode").replace(" />", "/>") + "\n")
