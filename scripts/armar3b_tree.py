"""The published kinematic tree of ARMAR-III and the bodies that the MJCF model makes of it."""

import json
import pathlib

from mjcf_tools import IDENTITY, compose, cross, normalized, quat_from_axes

MODEL_DIR = pathlib.Path(__file__).resolve().parent.parent / "models" / "armar3b"
SIDES = ("r", "l")
FINGERS = {"thumb": "Thumb", "index": "Index", "middle": "Middle", "ring": "Ring", "pinkie": "Pinky"}
ARM = {"shoulder1": "Shoulder 1", "shoulder2": "Shoulder 2", "upperarm": "Upperarm", "elbow": "Elbow",
       "underarm": "Underarm", "wrist1": "Wrist 1", "wrist2": "Wrist 2"}
ROOT = "armar3b"

TRUNK = [  # body, source node, parent body; the joint of a moving body has the body's name
    ("torso_pitch", "Hip Pitch", ROOT),
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
]


def arm_bodies(side):
    names = [f"arm_{side}_{part}" for part in ARM]
    parents = ["torso_yaw", *names]
    return [(name, f"{source} {side.upper()}", parent) for name, source, parent in zip(names, ARM.values(), parents)]


def hand_bodies(side):
    hand, letter = f"hand_{side}", side.upper()
    bodies = [(hand, f"Hand {letter} Base", f"arm_{side}_wrist2"), (f"{hand}_palm", f"Hand Palm 2 {letter}", hand)]
    for finger, source in FINGERS.items():
        root = hand if finger == "thumb" else f"{hand}_palm"
        bodies += [(f"{hand}_{finger}_j{j}", f"{source} {letter} J{j}", f"{hand}_{finger}_j0" if j else root)
                   for j in (0, 1)]
    return bodies


def all_bodies():
    return TRUNK + [b for side in SIDES for b in arm_bodies(side) + hand_bodies(side)]


class Tree:
    """The published nodes: poses, and the chain of fixed nodes above each."""

    def __init__(self, path):
        data = json.loads(path.read_text(encoding="utf-8"))
        self.nodes = {n["name"]: n for n in data["nodes"]}
        self.fingertips = {t["name"]: t["pos"] for t in data["fingertips"]}

    def pose_in(self, name, ancestor):
        """X_AncestorNode at zero joint angles."""
        pose = IDENTITY
        while name != ancestor:
            node = self.nodes[name]
            pose = compose((tuple(node["pos"]), normalized(node["quat"])), pose)
            name = node["parent"]
        return pose

    def fingertip(self, side, finger):
        """Published end of a finger in its last joint's frame, m."""
        return self.fingertips[f"{FINGERS[finger]} {side.upper()} tip"]


def hand_frame(tree, side):
    """X_HandBase_H: x to the middle knuckle, z (out of the back of the hand) = base +x made orthogonal, y = z cross x."""
    base = f"Hand {side.upper()} Base"
    x = normalized(tree.pose_in(f"Middle {side.upper()} J0", base)[0])
    back = (1.0, 0.0, 0.0)
    along = sum(a * b for a, b in zip(back, x))
    z = normalized(tuple(b - along * a for a, b in zip(x, back)))
    return quat_from_axes(x, cross(z, x), z)
