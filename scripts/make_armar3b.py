#!/usr/bin/env python3
"""Writes models/armar3b/armar3b.xml from models/armar3b/links.json (the published kinematics).

Usage: scripts/make_armar3b.py [--output FILE]

Every moving node of the published tree becomes one body; fixed nodes between two moving ones are multiplied into the
body's pose. A fixed node stays a body only where it carries mass of its own (neck base, hand). What is not published
(hand masses, limits, drives, contact parameters, looks) is set here; models/armar3b/README.md gives origin and grade.
"""

import argparse
import json
import pathlib
import xml.etree.ElementTree as ET

import armar3b_looks as looks
from mjcf_tools import (IDENTITY, add, compose, cross, normalized, quat_from_axes, remark, write)

MODEL_DIR = pathlib.Path(__file__).resolve().parent.parent / "models" / "armar3b"
FINGERS = ("thumb", "index", "middle", "ring", "pinkie")
PAD_RADIUS = 0.0093       # end sphere of the distal capsule: half the width of the published distal mesh
PROXIMAL_RADIUS = 0.008
PALM_HALF_THICKNESS = 0.006  # published plate: 3.3 mm; thicker, so that no object passes it within one step
EYE_MASS = 0.1            # of each eye and of their common carrier, taken off the published head mass
WRIST2_MASS = 0.3         # taken off the published mass of the whole wrist, which stands in its first node

# body, source node, parent body; the joint of a moving body has the body's name
BODIES = [
    ("torso_pitch", "Hip Pitch", "armar3b"),
    ("torso_roll", "Hip Roll", "torso_pitch"),
    ("torso_yaw", "Hip Yaw", "torso_roll"),
    ("neck_base", "Head Base", "torso_yaw"),
    ("neck_1_pitch", "Neck_1_Pitch", "neck_base"),
    ("neck_2_roll", "Neck_2_Roll", "neck_1_pitch"),
    ("neck_3_yaw", "Neck_3_Yaw", "neck_2_roll"),
    ("head_tilt", "Head_Tilt", "neck_3_yaw"),
    ("eyes_tilt", "Cameras", "head_tilt"),
    ("eye_l_pan", "Eye_Left", "eyes_tilt"),
    ("eye_r_pan", "Eye_Right", "eyes_tilt"),
    ("arm_r_shoulder1", "Shoulder 1 R", "torso_yaw"),
    ("arm_r_shoulder2", "Shoulder 2 R", "arm_r_shoulder1"),
    ("arm_r_upperarm", "Upperarm R", "arm_r_shoulder2"),
    ("arm_r_elbow", "Elbow R", "arm_r_upperarm"),
    ("arm_r_underarm", "Underarm R", "arm_r_elbow"),
    ("arm_r_wrist1", "Wrist 1 R", "arm_r_underarm"),
    ("arm_r_wrist2", "Wrist 2 R", "arm_r_wrist1"),
    ("hand_r", "Hand R Base", "arm_r_wrist2"),
    ("hand_r_palm", "Hand Palm 2 R", "hand_r"),
    ("hand_r_thumb_j0", "Thumb R J0", "hand_r"),
    ("hand_r_thumb_j1", "Thumb R J1", "hand_r_thumb_j0"),
    *[(f"hand_r_{f}_j{j}", f"{n} R J{j}", f"hand_r_{f}_j0" if j else "hand_r_palm")
      for f, n in (("index", "Index"), ("middle", "Middle"), ("ring", "Ring"), ("pinkie", "Pinky")) for j in (0, 1)],
]

HAND_MASS = {"hand_r": 0.2, "hand_r_palm": 0.1, "j0": 0.012, "j1": 0.018}

# Twice the largest gravity torque over the ranges of arm and hand with 1 kg at the TCP, rounded up (see the README).
ARM_TORQUE = {"shoulder1": 68.0, "shoulder2": 68.0, "upperarm": 26.0, "elbow": 24.0, "underarm": 4.0, "wrist1": 4.0,
              "wrist2": 4.0}

EXCLUDES = [  # pairs that overlap by construction, besides parent and child
    ("armar3b", "torso_roll", "published"),
    ("armar3b", "torso_yaw", "published"),
    ("torso_pitch", "torso_yaw", "published"),
    ("torso_yaw", "neck_1_pitch", "published"),
    ("torso_yaw", "neck_2_roll", "published"),
    ("neck_base", "neck_2_roll", "published"),
    ("neck_2_roll", "head_tilt", "published"),
    ("torso_yaw", "head_tilt", "published"),
    ("arm_r_shoulder1", "arm_r_upperarm", "published"),
    ("armar3b", "torso_pitch", "hip axis inside the column; a fixed parent is not filtered by the engine"),
    ("torso_yaw", "arm_r_shoulder2", "shoulder ball beside the box that stands for the rounded chest"),
    ("torso_yaw", "neck_3_yaw", "neck column inside the collar, which the chest's box covers"),
    ("neck_1_pitch", "neck_3_yaw", "neck axes meet in one point"),
    ("arm_r_underarm", "arm_r_wrist2", "wrist inside the end of the forearm capsule"),
]


class Tree:
    """The published nodes: poses, and the chain of fixed nodes above each."""

    def __init__(self, path):
        data = json.loads(path.read_text(encoding="utf-8"))
        self.nodes = {n["name"]: n for n in data["nodes"]}

    def pose_in(self, name, ancestor):
        """X_AncestorNode at zero joint angles."""
        pose = IDENTITY
        while name != ancestor:
            node = self.nodes[name]
            pose = compose((tuple(node["pos"]), normalized(node["quat"])), pose)
            name = node["parent"]
        return pose


def hand_frame(tree):
    """X_HandBase_H: x to the middle knuckle, z (out of the back of the hand) = base +x made orthogonal."""
    knuckle = tree.pose_in("Middle R J0", "Hand R Base")[0]
    x = normalized(knuckle)
    back = (1.0, 0.0, 0.0)
    along = sum(a * b for a, b in zip(back, x))
    z = normalized(tuple(b - along * a for a, b in zip(x, back)))
    return (0.0, 0.0, 0.0), quat_from_axes(x, cross(z, x), z)


def add_defaults(root):
    main = add(add(root, "default"), "default", class_="armar3b")
    add(main, "joint", type="hinge")
    visual = add(main, "default", class_="visual")
    add(visual, "geom", group=2, contype=0, conaffinity=0, mass=0, material="shell")
    collision = add(main, "default", class_="collision")
    add(collision, "geom", group=3, type="capsule", mass=0, rgba=(0.8, 0.5, 0.3, 0.6))
    hand = add(main, "default", class_="hand")
    add(hand, "geom", group=3, type="capsule", condim=4, friction=(0.9, 0.005, 0.0001), solref=(0.01, 1),
        solimp=(0.95, 0.99, 0.001), rgba=(0.8, 0.5, 0.3, 0.6))
    add(hand, "joint", armature=0.0001, damping=0.02, stiffness=0.08, springref=-0.2, range=(0, 1.570796))
    add(hand, "general", dyntype="filter", dynprm=0.1, gaintype="fixed", gainprm=0.1, biastype="none", ctrlrange=(0, 5))
    palm = add(hand, "default", class_="palm")
    add(palm, "joint", stiffness=0.16, range=(0, 0.698132))
    add(palm, "general", gainprm=0.2)
    sites = add(main, "default", class_="frame")
    add(sites, "site", group=4, size=0.005, rgba=(1, 0.8, 0.1, 1))
    pad = add(main, "default", class_="pad")
    add(pad, "site", group=4, size=PAD_RADIUS + 0.001, rgba=(0.1, 0.8, 0.3, 0.4))
    for name, armature, damping, kp in (("torso", 1.0, 500, 20000), ("neck", 0.02, 20, 2500), ("eyes", 0.001, 0.05, 1)):
        group = add(main, "default", class_=name)
        add(group, "joint", armature=armature, damping=damping)
        add(group, "position", kp=kp)
    arm = add(main, "default", class_="arm")
    add(arm, "joint", armature=0.05, damping=0.5)
    wrist = add(arm, "default", class_="wrist")
    add(wrist, "joint", armature=0.02, damping=0.2)


def joint_class(body):
    if body.startswith("torso_"):
        return "torso"
    if body.startswith("eye"):
        return "eyes"
    if body.startswith(("neck_", "head_")):
        return "neck"
    if body.startswith("arm_"):
        return "wrist" if "wrist" in body else "arm"
    return "palm" if body == "hand_r_palm" else "hand"


def add_inertial(element, body, node):
    """Published mass, centre and box inertia; eyes and second wrist body take their mass from their neighbour."""
    if body.startswith("eye"):
        add(element, "inertial", pos=(0, 0, 0), mass=EYE_MASS, diaginertia=(4e-5, 4e-5, 4e-5))
    elif body == "arm_r_wrist2":
        centre, half = node["box"]
        squares = [x * x for x in half]
        add(element, "inertial", pos=centre, mass=WRIST2_MASS,
            diaginertia=[WRIST2_MASS / 3 * (sum(squares) - q) for q in squares])
    elif "mass" in node:
        mass, inertia = node["mass"], node["inertia_diag"]
        given_away = {"head_tilt": 3 * EYE_MASS, "arm_r_wrist1": WRIST2_MASS}.get(body, 0.0)
        if given_away:
            scale = (mass - given_away) / mass
            mass, inertia = mass * scale, [scale * i for i in inertia]
        add(element, "inertial", pos=node["com"], mass=mass, diaginertia=inertia)


def add_capsule(element, class_, name, axis, centre, radius, half_length, mass=None):
    direction = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}[axis]
    ends = [c - half_length * d for c, d in zip(centre, direction)] + [c + half_length * d
                                                                       for c, d in zip(centre, direction)]
    add(element, "geom", class_=class_, name=name, fromto=ends, size=radius, mass=mass)


def add_collision(element, body, node):
    """Published box for the torso, published capsules for the other links outside the hand."""
    if body == "torso_yaw":
        centre, half = node["box"]
        add(element, "geom", class_="collision", name=f"{body}_box", type="box", pos=centre, size=half)
    elif body not in ("eye_l_pan", "eye_r_pan") and "capsule" in node:
        axis, radius, half_length = node["capsule"]
        add_capsule(element, "collision", f"{body}_capsule", axis, node["box"][0], radius, half_length)


def add_palm(element, body, tree):
    if body == "hand_r":
        node = tree.nodes["Hand Palm 1 R"]
        offset = tree.pose_in("Hand Palm 1 R", "Hand R Base")[0]
        centre, half = node["box"]
        add(element, "geom", class_="hand", name="hand_r_carpus_box", type="box",
            pos=[a + b for a, b in zip(offset, centre)], size=half, mass=HAND_MASS[body])
        add(element, "site", class_="frame", name="hand_r_H", quat=hand_frame(tree)[1])
        for name, source in (("tcp", "TCP R"), ("gcp", "GCP R")):
            pos, quat = tree.pose_in(source, "Hand R Base")
            add(element, "site", class_="frame", name=f"hand_r_{name}", pos=pos, quat=quat)
    else:
        centre, half = tree.nodes["Hand Palm 2 R"]["box"]
        add(element, "geom", class_="hand", name="hand_r_palm_box", type="box", pos=centre,
            size=(PALM_HALF_THICKNESS, half[1], half[2]), mass=HAND_MASS[body])
        add(element, "site", class_="frame", name="hand_r_palm_centre",
            pos=(centre[0] - PALM_HALF_THICKNESS, centre[1], centre[2]), quat=hand_frame(tree)[1])


def add_phalanx(element, body, tree, fingertips):
    """Proximal capsule on the joint line; distal capsule on the published axis, its end sphere being the pad."""
    finger, is_distal = body.split("_")[2], body.endswith("j1")
    tip = fingertips[finger]
    axis = 0 if finger == "thumb" else 2
    sign = -1.0 if finger == "thumb" else 1.0
    if not is_distal:
        end = [0.0] * 3
        end[axis] = sign * 0.0402
        add(element, "geom", class_="hand", name=f"{body}_capsule", fromto=[0, 0, 0] + end, size=PROXIMAL_RADIUS,
            mass=HAND_MASS["j0"])
        return
    start, end = list(tip), list(tip)
    start[axis] = sign * (PAD_RADIUS - 0.0026)  # the published mesh begins 2.6 mm before the joint
    end[axis] -= sign * PAD_RADIUS
    add(element, "geom", class_="hand", name=f"{body}_capsule", fromto=start + end, size=PAD_RADIUS,
        mass=HAND_MASS["j1"])
    add(element, "site", class_="pad", name=f"hand_r_{finger}_tip", pos=end)


def add_bodies(world, tree, fingertips):
    root = add(world, "body", name="armar3b", childclass="armar3b")
    platform = tree.nodes["Platform"]
    add(root, "inertial", pos=platform["com"], mass=platform["mass"], diaginertia=platform["inertia_diag"])
    for name, pos, size in looks.PLATFORM_COLLISION:
        add(root, "geom", class_="collision", name=name, type="cylinder", pos=pos, size=size)
    looks.add_visuals(root, "armar3b", IDENTITY)
    elements, sources = {"armar3b": root}, {"armar3b": "Platform"}
    for body, source, parent in BODIES:
        pos, quat = tree.pose_in(source, sources[parent])
        element = add(elements[parent], "body", name=body, pos=pos, quat=quat)
        elements[body], sources[body] = element, source
        node = tree.nodes[source]
        is_hand = body.startswith("hand_r")
        if not is_hand:
            add_inertial(element, body, node)
        if node["joint"] == "hinge":
            class_ = joint_class(body)
            add(element, "joint", class_=class_, name=body, axis=node["axis"],
                range=None if is_hand else node["range"])
        if body in ("hand_r", "hand_r_palm"):
            add_palm(element, body, tree)
        elif is_hand:
            add_phalanx(element, body, tree, fingertips)
        else:
            add_collision(element, body, node)
        if body in ("eye_l_pan", "eye_r_pan"):
            add(element, "camera", name=f"{body[:5]}_wide", pos=(0.02, 0, 0), xyaxes=(0, 1, 0, 0, 0, -1), fovy=47.88)
        looks.add_visuals(element, body, tree.pose_in(source, "Platform"))


def add_drives(root):
    names = [b for b, source, _ in BODIES if b not in ("neck_base", "hand_r")]
    tendon = add(add(root, "tendon"), "fixed", name="hand_r_ring_pinkie")
    for finger in ("ring", "pinkie"):
        for j in (0, 1):
            add(tendon, "joint", joint=f"hand_r_{finger}_j{j}", coef=1)
    actuator, sensor = add(root, "actuator"), add(root, "sensor")
    for name in names:
        class_ = joint_class(name)
        if class_ in ("torso", "neck", "eyes"):
            limits = looks.ranges[name]
            add(actuator, "position", class_=class_, name=name, joint=name, ctrlrange=limits)
        elif class_ in ("arm", "wrist"):
            limit = ARM_TORQUE[name.removeprefix("arm_r_")]
            add(actuator, "motor", class_=class_, name=name, joint=name, ctrlrange=(-limit, limit),
                forcerange=(-limit, limit))
    remark(actuator, "valves: control and activation in bar; torque = gain (Nm/bar) times activation")
    valves = [("palm", "palm")] + [(f"{f}_{part}", f"{f}_j{j}") for f in ("thumb", "index", "middle")
                                   for j, part in enumerate(("proximal", "distal"))]
    for valve, joint in valves:
        add(actuator, "general", class_=joint_class(f"hand_r_{joint}"), name=f"hand_r_{valve}", joint=f"hand_r_{joint}")
    add(actuator, "general", class_="hand", name="hand_r_ring_pinkie", tendon="hand_r_ring_pinkie")
    for name in names:
        if name.startswith("hand_r"):
            add(sensor, "jointpos", name=f"{name}_angle", joint=name)
    for finger in FINGERS:
        add(sensor, "touch", name=f"hand_r_{finger}_touch", site=f"hand_r_{finger}_tip")
    for valve in [v for v, _ in valves] + ["ring_pinkie"]:
        add(sensor, "actuatorfrc", name=f"hand_r_{valve}_torque", actuator=f"hand_r_{valve}")


def add_keyframes(root):
    """Joint order: torso 3, head 7, arm 7, hand 11; controls: positions 10, torques 7, valves 8."""
    keyframe = add(root, "keyframe")
    for name, torso_head, arm in looks.POSTURES:
        add(keyframe, "key", name=name, qpos=(*torso_head, *arm, *[0] * 11), ctrl=(*torso_head, *[0] * 15))


def build(tree, fingertips):
    root = ET.Element("mujoco", model="armar3b")
    remark(root, "Written by scripts/make_armar3b.py; origin of every number: README.md.")
    add(root, "compiler", autolimits="true", angle="radian")
    add(root, "option", timestep=0.002, iterations=50, solver="Newton", cone="elliptic", impratio=10)
    add_defaults(root)
    looks.add_materials(root)
    add_bodies(add(root, "worldbody"), tree, fingertips)
    contact = add(root, "contact")
    for first, second, reason in EXCLUDES:
        remark(contact, reason)
        add(contact, "exclude", body1=first, body2=second)
    add_drives(root)
    add_keyframes(root)
    return root


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--output", type=pathlib.Path, default=MODEL_DIR / "armar3b.xml")
    arguments = parser.parse_args()
    tree = Tree(MODEL_DIR / "links.json")
    data = json.loads((MODEL_DIR / "links.json").read_text(encoding="utf-8"))
    names = {"Thumb": "thumb", "Index": "index", "Middle": "middle", "Ring": "ring", "Pinky": "pinkie"}
    fingertips = {names[t["name"].split()[0]]: t["pos"] for t in data["fingertips"] if " R " in t["name"]}
    looks.ranges = {b: tree.nodes[s].get("range") for b, s, _ in BODIES}
    write(build(tree, fingertips), arguments.output)


if __name__ == "__main__":
    main()
