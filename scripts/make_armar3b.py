#!/usr/bin/env python3
"""Writes models/armar3b/armar3b.xml and armar3b_opposition.xml from models/armar3b/links.json (the published kinematics).

Usage: scripts/make_armar3b.py [--folder FOLDER]

Every moving node of the published tree becomes one body; fixed nodes between two moving ones are multiplied into the
body's pose. A fixed node stays a body only where it carries mass of its own (neck base, hand). What is not published
(hand masses, limits, drives, contact parameters, looks) is set here; models/armar3b/README.md gives origin and grade.
"""

import argparse
import pathlib
import xml.etree.ElementTree as ET

import armar3b_hand as hands
import armar3b_looks as looks
from armar3b_tree import ARM, MODEL_DIR, ROOT, SIDES, TRUNK, Tree, all_bodies, arm_bodies, hand_bodies
from mjcf_tools import IDENTITY, add, remark, write

EYE_MASS = 0.1     # of each eye and of their common carrier, taken off the published head mass
WRIST2_MASS = 0.3  # taken off the published mass of the whole wrist, which stands in its first node
FOVEAL_OFFSET = 0.012  # m, foveal above wide camera

# Twice the largest gravity torque over the ranges of arm and hand with 1 kg at the TCP, rounded up (see the README).
ARM_TORQUE = {"shoulder1": 68.0, "shoulder2": 68.0, "upperarm": 26.0, "elbow": 24.0, "underarm": 4.0, "wrist1": 4.0,
              "wrist2": 4.0}

EXCLUDES = [  # published pairs whose contacts are ignored, besides parent and child
    (ROOT, "torso_roll"), (ROOT, "torso_yaw"), ("torso_pitch", "torso_yaw"), ("torso_yaw", "neck_1_pitch"),
    ("torso_yaw", "neck_2_roll"), ("neck_base", "neck_2_roll"), ("neck_2_roll", "head_tilt"),
    ("torso_yaw", "head_tilt"), *[(f"arm_{s}_shoulder1", f"arm_{s}_upperarm") for s in SIDES],
]

SERVOS = (  # class, armature kg m^2, damping Nm s/rad, stiffness Nm/rad
    ("torso", 1.0, 500, 20000), ("neck", 0.02, 20, 2500), ("eyes", 0.001, 0.05, 1))
PLATFORM = (("platform_x", "slide", (1, 0, 0), (-10, 10)), ("platform_y", "slide", (0, 1, 0), (-10, 10)),
            ("platform_yaw", "hinge", (0, 0, 1), (-6.283185, 6.283185)))


def add_defaults(root):
    main = add(add(root, "default"), "default", class_=ROOT)
    add(main, "joint", type="hinge")
    visual = add(main, "default", class_="visual")
    add(visual, "geom", group=2, contype=0, conaffinity=0, mass=0, material="shell")
    collision = add(main, "default", class_="collision")
    add(collision, "geom", group=3, type="capsule", mass=0, rgba=(0.8, 0.5, 0.3, 0.6))
    hands.add_defaults(main)
    platform = add(main, "default", class_="platform")
    add(platform, "joint", damping=6000)
    add(platform, "position", kp=100000)
    for name, armature, damping, kp in SERVOS:
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
    return "palm" if body.endswith("_palm") else "hand"


def add_inertial(element, body, node):
    """Published mass, centre and box inertia; eyes and second wrist body take their mass from their neighbour."""
    if body.startswith("eye"):
        add(element, "inertial", pos=(0, 0, 0), mass=EYE_MASS, diaginertia=(4e-5, 4e-5, 4e-5))
    elif body.endswith("wrist2"):
        centre, half = node["box"]
        squares = [x * x for x in half]
        add(element, "inertial", pos=centre, mass=WRIST2_MASS,
            diaginertia=[WRIST2_MASS / 3 * (sum(squares) - q) for q in squares])
    elif "mass" in node:
        mass, inertia = node["mass"], node["inertia_diag"]
        given_away = 3 * EYE_MASS if body == "head_tilt" else WRIST2_MASS if body.endswith("wrist1") else 0.0
        if given_away:
            scale = (mass - given_away) / mass
            mass, inertia = mass * scale, [scale * i for i in inertia]
        add(element, "inertial", pos=node["com"], mass=mass, diaginertia=inertia)


def add_collision(element, body, node):
    """Our shape where the published one would meet a neighbour that the reference does not exclude, else that."""
    ours = looks.collision_of(body)
    for i, shape in enumerate(ours or []):
        add(element, "geom", class_="collision", name=f"{body}_shape{i}", **shape)
    if ours is not None or body.startswith("eye_") or "capsule" not in node:
        return
    axis, radius, half = node["capsule"]
    direction = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}[axis]
    centre = node["box"][0]
    ends = [c + s * half * d for s in (-1, 1) for c, d in zip(centre, direction)]
    add(element, "geom", class_="collision", name=f"{body}_shape0", fromto=ends, size=radius)


def add_cameras(element, body):
    for kind, z, fovy in (("wide", 0, 47.88), ("foveal", -FOVEAL_OFFSET, 16.84)):
        add(element, "camera", name=f"{body[:5]}_{kind}", pos=(0.02, 0, z), xyaxes=(0, 1, 0, 0, 0, -1), fovy=fovy)


def add_platform(world, tree):
    root = add(world, "body", name=ROOT, childclass=ROOT)
    for name, kind, axis, limits in PLATFORM:
        add(root, "joint", class_="platform", name=name, type=kind, axis=axis,
            range=limits if kind == "hinge" else None)
    node = tree.nodes["Platform"]
    add(root, "inertial", pos=node["com"], mass=node["mass"], diaginertia=node["inertia_diag"])
    add_collision(root, ROOT, node)
    looks.add_visuals(root, ROOT, IDENTITY, tree)
    return root


def add_bodies(world, tree, opposition):
    elements, sources = {ROOT: add_platform(world, tree)}, {ROOT: "Platform"}
    for body, source, parent in all_bodies():
        holder, node = elements[parent], tree.nodes[source]
        pos, quat = tree.pose_in(source, sources[parent])
        is_hand, side = body.startswith("hand_"), body[5:6]
        if opposition and body.endswith("thumb_j0"):
            holder = hands.add_opposition(holder, side)
            looks.add_carrier(holder)
            pos = [a - b for a, b in zip(pos, hands.OPPOSITION_AXIS_AT)]
        element = add(holder, "body", name=body, pos=pos, quat=quat)
        elements[body], sources[body] = element, source
        if not is_hand:
            add_inertial(element, body, node)
        if node["joint"] == "hinge":
            add(element, "joint", class_=joint_class(body), name=body, axis=node["axis"],
                range=None if is_hand else node["range"])
        if body in ("hand_r", "hand_l"):
            hands.add_carpus(element, side, tree, opposition)
        elif body.endswith("_palm"):
            hands.add_palm(element, side, tree)
        elif is_hand:
            hands.add_phalanx(element, body, side, tree)
        else:
            add_collision(element, body, node)
        if body in ("eye_l_pan", "eye_r_pan"):
            add_cameras(element, body)
        looks.add_visuals(element, body, tree.pose_in(source, "Platform"), tree)


def joint_ranges(tree):
    ranges = {name: limits for name, _, _, limits in PLATFORM}
    ranges.update({body: tree.nodes[source]["range"] for body, source, _ in TRUNK if body != "neck_base"})
    return ranges


def hand_joints(side, opposition):
    names = [body for body, _, _ in hand_bodies(side)[1:]]
    if opposition:
        names.insert(1, f"hand_{side}_thumb_opposition")
    return names


def add_drives(root, tree, opposition):
    tendon, actuator, sensor = add(root, "tendon"), add(root, "actuator"), add(root, "sensor")
    remark(actuator, "servos: control in m or rad")
    for name, limits in joint_ranges(tree).items():
        class_ = "platform" if name.startswith("platform") else joint_class(name)
        add(actuator, "position", class_=class_, name=name, joint=name, ctrlrange=limits)
    for side in SIDES:
        remark(actuator, f"arm_{side}: torque in Nm")
        for part in ARM:
            name, limit = f"arm_{side}_{part}", ARM_TORQUE[part]
            add(actuator, "motor", class_="wrist" if "wrist" in part else "arm", name=name, joint=name,
                ctrlrange=(-limit, limit), forcerange=(-limit, limit))
    for side in SIDES:  # MuJoCo wants actuators with a state behind those without
        hands.add_valves(tendon, actuator, side, opposition)
    joints = list(joint_ranges(tree))
    for side in SIDES:
        joints += [body for body, _, _ in arm_bodies(side)] + hand_joints(side, opposition)
    for name in joints:
        add(sensor, "jointpos", name=f"{name}_angle" if "platform_" not in name else f"{name}_position", joint=name)
    for side in SIDES:
        hands.add_sensors(sensor, side, opposition)


def add_keyframes(root, opposition):
    """Joints: platform 3, torso 3, head 7, then arm 7 and hand of each side; controls: the same without hands, arms 0 Nm,
    then the valves of both."""
    keyframe = add(root, "keyframe")
    for name, (trunk, arm, hand) in looks.POSTURES.items():
        angles = hands.posture_angles(hand, opposition)
        pressures = hands.posture_pressures(angles, opposition)
        mirrored = [s * q for s, q in zip(looks.ARM_MIRROR, arm)]
        base = [0] * 3 + list(trunk)
        add(keyframe, "key", name=name, qpos=[*base, *arm, *angles.values(), *mirrored, *angles.values()],
            act=pressures * 2, ctrl=[*base, *[0] * 14, *pressures * 2])


def build(tree, opposition):
    root = ET.Element("mujoco", model="armar3b_opposition" if opposition else "armar3b")
    remark(root, "Written by scripts/make_armar3b.py; origin of every number: README.md.")
    add(root, "compiler", autolimits="true", angle="radian")
    add(root, "option", timestep=0.002, iterations=50, solver="Newton", cone="elliptic", impratio=10)
    add_defaults(root)
    looks.add_materials(root)
    add_bodies(add(root, "worldbody"), tree, opposition)
    contact = add(root, "contact")
    for first, second in EXCLUDES:
        add(contact, "exclude", body1=first, body2=second)
    if opposition:
        remark(contact, "parent and child in the documented hand")
        for side in SIDES:
            add(contact, "exclude", body1=f"hand_{side}", body2=f"hand_{side}_thumb_j0")
    add_drives(root, tree, opposition)
    add_keyframes(root, opposition)
    return root


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--folder", type=pathlib.Path, default=MODEL_DIR)
    folder = parser.parse_args().folder
    tree = Tree(MODEL_DIR / "links.json")
    write(build(tree, opposition=False), folder / "armar3b.xml")
    write(build(tree, opposition=True), folder / "armar3b_opposition.xml")


if __name__ == "__main__":
    main()
