#!/usr/bin/env python3
"""Writes models/mmm_hand/mmm_hand_r.xml and mmm_hand_l.xml, the demonstrator's hands, from links.json beside them.

Usage: scripts/make_mmm_hand.py [--side {right,left,both}] [--length METRES]
                                [--cap-extra METRES | --cap-diameter METRES] [--cap-half-length METRES]
                                [--cap-rgb R G B] [--skin-rgb R G B] [--folder FOLDER]

The kinematics are those of the public MMM reference model, scaled to the hand length (wrist to middle fingertip), in
the frame H: origin at the wrist centre, x to the middle knuckle, z out of the back of the hand, y = z x x (towards the
thumb on a right hand, away from it on a left one). Both files use the same names, and positive abduction moves a
fingertip towards the thumb on both. Skin, caps and forearm are ours; models/mmm_hand/README.md gives origin and grade
of every number.
"""

import argparse
import json
import pathlib
import xml.etree.ElementTree as ET

from mjcf_tools import add, compose, normalized, remark, text, write

MODEL_DIR = pathlib.Path(__file__).resolve().parent.parent / "models" / "mmm_hand"
DRAWN_LENGTH = 0.189       # hand length at which shapes and radii below are given
# Frame of the MMM wrist in H: fingers to its -z; the back is its +x on the right, its -x on the left.
X_H_WRIST = {"right": ((0.0, 0.0, 0.0), (0.5**0.5, 0.0, -(0.5**0.5), 0.0)),
             "left": ((0.0, 0.0, 0.0), (0.0, 0.5**0.5, 0.0, -(0.5**0.5)))}
DIGITS = {"1": "thumb", "2": "index", "3": "middle", "4": "ring", "5": "pinkie"}
JOINTS = {"11z": "cmc_opposition", "11y": "cmc_flexion", "12y": "mcp", "13y": "ip", "50y": "cmc",
          **{f"{d}{j}": role for d in "2345" for j, role in (("1x", "abduction"), ("1y", "mcp"), ("2y", "pip"),
                                                             ("3y", "dip"))}}
HELD_JOINT = "40y"         # ring CMC, 5 degrees of range: fixed, which leaves 21 joints

# Skin radius at each joint of a finger and at its pad, at the drawn length; the pad radius is the published capsule's.
FINGER_RADII = {
    "thumb": (0.0120, 0.0092, 0.0075), "index": (0.0100, 0.0090, 0.0085), "middle": (0.0102, 0.0092, 0.0085),
    "ring": (0.0097, 0.0087, 0.0080), "pinkie": (0.0086, 0.0079, 0.0075),
}

# Palm in H of the right hand, mirrored in y for the left: name, then fromto and radius, or centre and half sizes.
PALM_RODS = [
    ("metacarpal_index", (0.010, 0.011, -0.001), (0.083, 0.0225, 0.000), 0.0118),
    ("metacarpal_middle", (0.010, 0.003, 0.000), (0.083, 0.0, 0.001), 0.0122),
    ("metacarpal_ring", (0.010, -0.006, -0.001), (0.076, -0.0190, 0.000), 0.0118),
    ("metacarpal_pinkie", (0.012, -0.014, -0.002), (0.066, -0.0345, -0.001), 0.0108),
    ("web_index", (0.030, 0.014, -0.003), (0.078, 0.012, -0.003), 0.0105),
    ("web_ring", (0.030, -0.008, -0.003), (0.074, -0.010, -0.003), 0.0105),
    ("web_pinkie", (0.030, -0.016, -0.003), (0.068, -0.026, -0.003), 0.0100),
    ("thumb_web", (0.022, 0.018, -0.003), (0.054, 0.0255, -0.001), 0.0085),
]
PALM_BALLS = [
    ("heel", (0.034, -0.003, -0.0025), (0.040, 0.0335, 0.0145)),
    ("pad", (0.064, -0.006, -0.0020), (0.026, 0.036, 0.0125)),
    ("thenar", (0.034, 0.0165, -0.0055), (0.033, 0.0165, 0.0135)),
    ("hypothenar", (0.040, -0.0205, -0.0045), (0.036, 0.0165, 0.0125)),
    ("back", (0.048, -0.004, 0.0035), (0.047, 0.034, 0.0100)),
    ("wrist", (0.004, 0.0, 0.0), (0.034, 0.0265, 0.0170)),
    ("forearm", (-0.052, 0.0, 0.0), (0.055, 0.0325, 0.0225)),
]
SLEEVE = ((-0.190, 0.0, 0.0), (-0.056, 0.0, 0.0), 0.040)


class Scale:
    """Shapes drawn for a right hand of DRAWN_LENGTH, written for the asked length and side."""

    def __init__(self, factor, side):
        self.factor = factor
        self.y_sign = 1 if side == "right" else -1

    def point(self, p):
        return self(p[0], self.y_sign * p[1], p[2])

    def __call__(self, *values):
        scaled = [self.factor * v for value in values for v in (value if isinstance(value, tuple) else (value,))]
        return scaled if len(scaled) > 1 else scaled[0]


def add_defaults(root):
    main = add(add(root, "default"), "default", class_="mmm_hand")
    add(main, "joint", type="hinge", armature=0.0001, damping=0.01)
    skin = add(main, "default", class_="mmm_skin")
    add(skin, "geom", type="capsule", contype=0, conaffinity=0, group=2, material="mmm_skin", density=1000)
    cap = add(main, "default", class_="mmm_cap")
    add(cap, "geom", type="capsule", contype=0, conaffinity=0, group=2, material="mmm_cap", mass=0)
    sleeve = add(main, "default", class_="mmm_sleeve")
    add(sleeve, "geom", type="cylinder", contype=0, conaffinity=0, group=2, material="mmm_sleeve", mass=0)
    frame = add(main, "default", class_="mmm_frame")
    add(frame, "site", group=4, size=0.003, rgba=(1, 0.8, 0.1, 1))


def add_materials(root, options):
    asset = add(root, "asset")
    add(asset, "material", name="mmm_skin", rgba=(*options.skin_rgb, 1), specular=0.1, shininess=0.2)
    add(asset, "material", name="mmm_cap", rgba=(*options.cap_rgb, 1), specular=0.05, shininess=0.1)
    add(asset, "material", name="mmm_sleeve", rgba=(0.13, 0.14, 0.18, 1), specular=0.05, shininess=0.1)


def add_palm(hand, scale):
    for name, start, end, radius in PALM_RODS:
        add(hand, "geom", class_="mmm_skin", name=f"mmm_{name}", fromto=scale.point(start) + scale.point(end),
            size=scale(radius))
    for name, centre, half in PALM_BALLS:
        add(hand, "geom", class_="mmm_skin", name=f"mmm_{name}", type="ellipsoid", pos=scale.point(centre),
            size=scale(half))
    start, end, radius = SLEEVE
    add(hand, "geom", class_="mmm_sleeve", name="mmm_sleeve", fromto=scale(start, end), size=scale(radius))


def add_skin(element, name, finger, segment, end, pad_centre, scale):
    """Skin of the phalanx from its joint to `end` (z of the next joint, or of the pad's centre)."""
    radii = FINGER_RADII[finger]
    target = pad_centre if pad_centre is not None else end
    add(element, "geom", class_="mmm_skin", name=f"{name}_skin", fromto=(0, 0, 0, 0, 0, target),
        size=scale(radii[segment]))
    add(element, "geom", class_="mmm_skin", name=f"{name}_joint", type="sphere", pos=(0, 0, 0),
        size=scale(radii[segment] * 1.06))


def add_joint(element, name, node, key, side):
    axis, limits = node["axis"], node["range"]
    # Abduction: the source's moves left fingertips away from the thumb.
    if side == "left" and key.endswith("x"):
        axis, limits = [-a for a in axis], [-limits[1], -limits[0]]
    add(element, "joint", name=name, axis=axis, range=limits)


def cap_radius(options, pad_radius):
    """Of the pad's and a bit, or as given."""
    if options.cap_diameter is None:
        return pad_radius + options.cap_extra
    if options.cap_diameter <= 2 * pad_radius:
        raise SystemExit(f"--cap-diameter {options.cap_diameter} does not cover a pad of {text(2 * pad_radius)} m")
    return options.cap_diameter / 2


def add_fingers(hand, data, options, scale, side):
    length = options.length / data["hand_length_h1"]
    prefix = side.capitalize()
    nodes = [n for n in data["nodes"] if n["name"].startswith(prefix)]
    tips = {t["parent"]: length * t["pos_h1"][2] for t in data["fingertips"]}
    offsets = {n["name"]: length * n["pos_h1"][2] for n in nodes}
    children = {n["parent"]: n["name"] for n in nodes}
    pad_radius = {n["name"]: n["capsule"][0] for n in nodes if n["name"] in tips}
    elements, poses = {prefix + "Wrist": hand}, {prefix + "Wrist": X_H_WRIST[side]}
    for node in nodes:
        source = node["name"]
        key = source.removeprefix(prefix + "FingerJoint")
        pose = (tuple(length * p for p in node["pos_h1"]), normalized(node["quat"]))
        pose = compose(poses.get(node["parent"], ((0.0,) * 3, (1.0, 0.0, 0.0, 0.0))), pose)
        if key == HELD_JOINT:
            elements[source], poses[source] = elements[node["parent"]], pose
            continue
        finger = DIGITS[key[0]]
        name = f"mmm_{finger}_{JOINTS[key]}"
        pos, quat = pose
        sign = -1 if next(x for x in quat if x != 0) < 0 else 1
        element = add(elements[node["parent"]], "body", name=name, pos=pos,
                      quat=None if quat[0] == 1.0 else [sign * x for x in quat])
        add_joint(element, name, node, key, side)
        elements[source] = element
        segment = {"1y": 0, "2y": 1, "3y": 2}.get(key[1:])
        if segment is None:  # a node on the way to the next hinge, at the same point or in the palm
            add(element, "geom", class_="mmm_skin", name=f"{name}_core", type="sphere", size=scale(0.004))
        elif source in tips:
            radius = scale(pad_radius[source])
            centre = tips[source] - radius
            add_skin(element, name, finger, segment, None, centre, scale)
            add(element, "geom", class_="mmm_cap", name=f"mmm_{finger}_cap",
                fromto=(0, 0, centre - options.cap_half_length, 0, 0, centre + options.cap_half_length),
                size=cap_radius(options, radius))
            add(element, "site", class_="mmm_frame", name=f"mmm_{finger}_tip", pos=(0, 0, centre), size=radius)
        else:
            add_skin(element, name, finger, segment, offsets[children[source]], None, scale)


def build(data, options, side):
    root = ET.Element("mujoco", model=f"mmm_hand_{side[0]}")
    remark(root, f"Written by scripts/make_mmm_hand.py for a hand length of {options.length} m; "
                 "origin of every number: README.md.")
    add(root, "compiler", autolimits="true", angle="radian")
    # For programs that scale the hand.
    add(add(root, "custom"), "numeric", name="mmm_hand_length", data=options.length)
    # For looking at the file alone; a scene that takes the hand has its own.
    scale = Scale(options.length / DRAWN_LENGTH, side)
    add(root, "statistic", extent=scale(0.27), center=scale(0.04, 0.0, 0.0))
    add(add(root, "visual"), "headlight", ambient=(0.45, 0.45, 0.45), diffuse=(0.5, 0.5, 0.5), specular=(0, 0, 0))
    add_defaults(root)
    add_materials(root, options)
    hand = add(add(root, "worldbody"), "body", name="mmm_hand", childclass="mmm_hand")
    add(hand, "site", class_="mmm_frame", name="mmm_H")
    add_palm(hand, scale)
    add_fingers(hand, data, options, scale, side)
    return root


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--side", choices=("right", "left", "both"), default="both")
    parser.add_argument("--length", type=float, default=0.189, help="wrist centre to middle fingertip, m")
    cap = parser.add_mutually_exclusive_group()
    cap.add_argument("--cap-extra", type=float, default=0.0015, help="cap radius beyond the pad's, m")
    cap.add_argument("--cap-diameter", type=float, help="one diameter for all caps, m")
    parser.add_argument("--cap-half-length", type=float, default=0.003, help="of the cap's straight part, m")
    parser.add_argument("--cap-rgb", type=float, nargs=3, default=(0.02, 0.72, 0.10))
    parser.add_argument("--skin-rgb", type=float, nargs=3, default=(0.87, 0.67, 0.55))
    parser.add_argument("--folder", type=pathlib.Path, default=MODEL_DIR, help="where the files go")
    options = parser.parse_args()
    if not 0.1 <= options.length <= 0.3:
        parser.error(f"--length is a hand length in metres, 0.1 to 0.3; found {options.length}")
    data = json.loads((MODEL_DIR / "links.json").read_text(encoding="utf-8"))
    for side in ("right", "left") if options.side == "both" else (options.side,):
        write(build(data, options, side), options.folder / f"mmm_hand_{side[0]}.xml")


if __name__ == "__main__":
    main()
