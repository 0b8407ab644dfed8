#!/usr/bin/env python3
"""Writes models/mmm_hand/mmm_hand_r.xml, the demonstrator's right hand, from models/mmm_hand/links.json.

Usage: scripts/make_mmm_hand.py [--length METRES] [--cap-extra METRES] [--cap-half-length METRES] [--cap-rgb R G B]
                                [--output FILE]

The kinematics are those of the public MMM reference model, scaled to the hand length (wrist to middle fingertip), in
the frame H: origin at the wrist centre, x to the middle knuckle, z out of the back of the hand, y towards the thumb.
Skin, caps and forearm are ours; models/mmm_hand/README.md gives origin and grade of every number.
"""

import argparse
import json
import pathlib
import xml.etree.ElementTree as ET

from mjcf_tools import add, compose, normalized, remark, write

MODEL_DIR = pathlib.Path(__file__).resolve().parent.parent / "models" / "mmm_hand"
DRAWN_LENGTH = 0.189       # hand length at which shapes and radii below are given
X_H_WRIST = ((0.0, 0.0, 0.0), (0.5**0.5, 0.0, -(0.5**0.5), 0.0))  # fingers: -z of the MMM wrist; back: its +x
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

# Palm in H: name, kind, then fromto and radius, or centre and half sizes.
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
    """Shapes drawn at DRAWN_LENGTH, written at the asked hand length."""

    def __init__(self, factor):
        self.factor = factor

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


def add_materials(root, cap_rgb):
    asset = add(root, "asset")
    add(asset, "material", name="mmm_skin", rgba=(0.87, 0.67, 0.55, 1), specular=0.1, shininess=0.2)
    add(asset, "material", name="mmm_cap", rgba=(*cap_rgb, 1), specular=0.05, shininess=0.1)
    add(asset, "material", name="mmm_sleeve", rgba=(0.13, 0.14, 0.18, 1), specular=0.05, shininess=0.1)


def add_palm(hand, scale):
    for name, start, end, radius in PALM_RODS:
        add(hand, "geom", class_="mmm_skin", name=f"mmm_{name}", fromto=scale(start, end), size=scale(radius))
    for name, centre, half in PALM_BALLS:
        add(hand, "geom", class_="mmm_skin", name=f"mmm_{name}", type="ellipsoid", pos=scale(centre), size=scale(half))
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


def add_fingers(hand, data, options, scale):
    length = options.length / data["hand_length_h1"]
    tips = {t["parent"]: length * t["pos_h1"][2] for t in data["fingertips"]}
    offsets = {n["name"]: length * n["pos_h1"][2] for n in data["nodes"]}
    children = {n["parent"]: n["name"] for n in data["nodes"]}
    pad_radius = {n["name"]: n["capsule"][0] for n in data["nodes"] if n["name"] in tips}
    elements, poses = {"RightWrist": hand}, {"RightWrist": X_H_WRIST}
    for node in data["nodes"]:
        source = node["name"]
        key = source.removeprefix("RightFingerJoint")
        pose = (tuple(length * p for p in node["pos_h1"]), normalized(node["quat"]))
        pose = compose(poses.get(node["parent"], ((0.0,) * 3, (1.0, 0.0, 0.0, 0.0))), pose)
        if key == HELD_JOINT:
            elements[source], poses[source] = elements[node["parent"]], pose
            continue
        finger = DIGITS[key[0]]
        name = f"mmm_{finger}_{JOINTS[key]}"
        pos, quat = pose
        element = add(elements[node["parent"]], "body", name=name, pos=pos, quat=None if quat[0] == 1.0 else quat)
        add(element, "joint", name=name, axis=node["axis"], range=node["range"])
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
                size=radius + options.cap_extra)
            add(element, "site", class_="mmm_frame", name=f"mmm_{finger}_tip", pos=(0, 0, centre), size=radius)
        else:
            add_skin(element, name, finger, segment, offsets[children[source]], None, scale)


def build(data, options):
    root = ET.Element("mujoco", model="mmm_hand_r")
    remark(root, f"Written by scripts/make_mmm_hand.py for a hand length of {options.length} m; "
                 "origin of every number: README.md.")
    add(root, "compiler", autolimits="true", angle="radian")
    add_defaults(root)
    add_materials(root, options.cap_rgb)
    hand = add(add(root, "worldbody"), "body", name="mmm_hand", childclass="mmm_hand")
    add(hand, "site", class_="mmm_frame", name="mmm_H")
    scale = Scale(options.length / DRAWN_LENGTH)
    add_palm(hand, scale)
    add_fingers(hand, data, options, scale)
    return root


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--length", type=float, default=0.189, help="wrist centre to middle fingertip, m")
    parser.add_argument("--cap-extra", type=float, default=0.0015, help="cap radius beyond the pad's, m")
    parser.add_argument("--cap-half-length", type=float, default=0.003, help="of the cap's straight part, m")
    parser.add_argument("--cap-rgb", type=float, nargs=3, default=(0.02, 0.72, 0.10))
    parser.add_argument("--output", type=pathlib.Path, default=MODEL_DIR / "mmm_hand_r.xml")
    options = parser.parse_args()
    if not 0.1 <= options.length <= 0.3:
        parser.error(f"--length is a hand length in metres, 0.1 to 0.3; found {options.length}")
    data = json.loads((MODEL_DIR / "links.json").read_text(encoding="utf-8"))
    write(build(data, options), options.output)


if __name__ == "__main__":
    main()
