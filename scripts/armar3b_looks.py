"""How the robot looks: materials and visual shapes, drawn after photographs of ARMAR-III, estimated by eye.

Shapes of torso and head are given in the robot's root frame at zero joint angles (x right, y forward, z up), those of
the right arm and hand in the frame of their body, where the long axes are simple; the left ones are their mirror image.
"""

from armar3b_tree import all_bodies
from mjcf_tools import add, conjugate, inverse, multiply, transform

MATERIALS = {  # rgba, specular, shininess
    "shell": ((0.36, 0.45, 0.58, 1), 0.5, 0.6),
    "cover": ((0.86, 0.87, 0.89, 1), 0.4, 0.5),
    "metal": ((0.62, 0.64, 0.67, 1), 0.7, 0.7),
    "dark": ((0.16, 0.17, 0.20, 1), 0.2, 0.3),
    "rubber": ((0.11, 0.11, 0.13, 1), 0.05, 0.1),
    "eyeball": ((0.96, 0.96, 0.96, 1), 0.6, 0.8),
    "lens": ((0.02, 0.02, 0.03, 1), 0.9, 0.9),
}

COLLISION = {  # in the frame of the body; instead of the published shape
    # within the published bounds (half 0.34 x 0.34, top 0.95), split by eye
    "armar3b": [{"type": "cylinder", "pos": (0.0, 0.0, 0.26), "size": (0.335, 0.24)},
                {"type": "cylinder", "pos": (0.0, 0.08, 0.70), "size": (0.20, 0.20)}],
    # the published box ends above the neck's joint and inside the shoulders
    "torso_yaw": [{"type": "box", "pos": (0.0, -0.0517, 0.2757), "size": (0.170, 0.1474, 0.2543)},
                  {"type": "box", "pos": (0.0, -0.0517, 0.5600), "size": (0.110, 0.0900, 0.0350)}],
    "neck_1_pitch": [{"fromto": (0.006, 0, -0.034, 0.006, 0, 0.034), "size": 0.0200}],
    # slim towards elbow and wrist, so that both bend to their ends
    "arm_r_upperarm": [{"fromto": (0.001, 0, -0.06, 0.001, 0, -0.185), "size": 0.041},
                       {"fromto": (0.001, 0, -0.185, 0.001, 0, -0.235), "size": 0.028}],
    "arm_r_underarm": [{"fromto": (0, 0, -0.108, 0, 0, -0.145), "size": 0.044},
                       {"fromto": (0, 0, -0.145, 0, 0, -0.175), "size": 0.024}],
}


def collision_of(body):
    """Our shapes for a body, or None where the published one is used."""
    return COLLISION.get(body.replace("_l_", "_r_"))


_GAZE = (0, 0, 0, 0, 0, 0, -0.35, 0.25, 0, 0)      # torso, neck, head, eyes: at the hands
_FORWARD = (-0.2, 0.2, 0.0, -0.1, 1.3, 0.0, 0.0)  # arm: forearm level, palm inwards
POSTURES = {  # name: torso 3, neck and head 4, eyes 3; right arm 7 (the left mirrors it); posture of the hands
    "home": ((0,) * 10, (0,) * 7, "open"),
    "ready": (_GAZE, _FORWARD, "open"),
    "look_at_table": ((0, 0, 0, -0.35, 0, 0, -0.5, 0.35, 0, 0), (0.25, 0.25, 0, -0.35, 0.9, 0, 0), "open"),
    "arms_out": ((0,) * 10, (0, 0.9, 0, 0, 0.8, 0, 0), "open"),
    **{f"hand_{name}": (_GAZE, _FORWARD, name) for name in ("open", "power", "pinch", "tripod", "lateral")},
}
ARM_MIRROR = (1, -1, -1, 1, -1, -1, 1)  # of the seven joint angles, right to left


def _shape(material, kind, *, size, pos=None, fromto=None, quat=None):
    return {"material": material, "type": kind, "size": size, "pos": pos, "fromto": fromto, "quat": quat}


def _ball(material, pos, size):
    return _shape(material, "ellipsoid", pos=pos, size=(size,) * 3 if isinstance(size, float) else size)


def _rod(material, kind, start, end, radius):
    return _shape(material, kind, fromto=(*start, *end), size=radius)


def _sides(make):
    return [make(-1.0), make(1.0)]


IN_ROOT_FRAME = {
    "armar3b": [
        _rod("dark", "cylinder", (0, 0, 0.03), (0, 0, 0.10), 0.31),
        _rod("shell", "cylinder", (0, 0, 0.10), (0, 0, 0.34), 0.335),
        _rod("cover", "cylinder", (0, 0, 0.34), (0, 0, 0.36), 0.337),
        _ball("shell", (0, 0, 0.36), (0.32, 0.32, 0.13)),
        _rod("metal", "cylinder", (0, 0.06, 0.45), (0, 0.08, 0.80), 0.15),
        _shape("shell", "box", pos=(0, 0.045, 0.62), size=(0.17, 0.14, 0.16)),
        *_sides(lambda s: _rod("shell", "capsule", (0.155 * s, 0.16, 0.46), (0.155 * s, 0.16, 0.78), 0.035)),
        *_sides(lambda s: _rod("shell", "capsule", (0.155 * s, -0.07, 0.46), (0.155 * s, -0.07, 0.78), 0.035)),
        _ball("dark", (0, 0.06, 0.80), (0.16, 0.15, 0.06)),
        *_sides(lambda s: _shape("metal", "box", pos=(0.185 * s, 0.150, 0.85), size=(0.015, 0.05, 0.075))),
    ],
    "torso_pitch": [_rod("metal", "cylinder", (-0.20, 0.158, 0.89), (0.20, 0.158, 0.89), 0.055),
                    *_sides(lambda s: _rod("cover", "cylinder", (0.20 * s, 0.158, 0.89), (0.21 * s, 0.158, 0.89),
                                           0.06))],
    "torso_roll": [_ball("dark", (0, 0.14, 0.91), (0.11, 0.09, 0.085))],
    "torso_yaw": [
        _rod("metal", "cylinder", (0, 0.125, 0.95), (0, 0.125, 1.06), 0.095),
        _ball("cover", (0, 0.12, 1.07), (0.125, 0.115, 0.07)),
        _ball("shell", (0, 0.118, 1.245), (0.178, 0.128, 0.215)),
        _ball("shell", (0, 0.138, 1.320), (0.182, 0.118, 0.122)),
        _ball("cover", (0, 0.232, 1.255), (0.085, 0.018, 0.030)),
        _rod("metal", "capsule", (-0.20, 0.118, 1.385), (0.20, 0.118, 1.385), 0.062),
        _ball("shell", (0, 0.105, 1.435), (0.155, 0.098, 0.055)),
        _shape("dark", "box", pos=(0, -0.005, 1.28), size=(0.13, 0.035, 0.16)),
    ],
    "neck_base": [_rod("dark", "cylinder", (0, 0.123, 1.44), (0, 0.123, 1.495), 0.062)],
    "neck_1_pitch": [_rod("metal", "cylinder", (-0.065, 0.123, 1.493), (0.065, 0.123, 1.493), 0.026)],
    "neck_2_roll": [_rod("metal", "cylinder", (0, 0.075, 1.493), (0, 0.165, 1.493), 0.030)],
    "neck_3_yaw": [_rod("dark", "cylinder", (0, 0.123, 1.50), (0, 0.123, 1.60), 0.034),
                   *[_rod("metal", "cylinder", (0, 0.123, z), (0, 0.123, z + 0.012), 0.039)
                     for z in (1.525, 1.555)],
                   _rod("metal", "cylinder", (-0.075, 0.123, 1.613), (0.075, 0.123, 1.613), 0.024)],
    "head_tilt": [
        _ball("shell", (0, 0.140, 1.682), (0.106, 0.090, 0.106)),
        _ball("shell", (0, 0.158, 1.632), (0.078, 0.066, 0.060)),
        _ball("dark", (0, 0.150, 1.668), (0.091, 0.080, 0.034)),
        _rod("cover", "capsule", (-0.050, 0.198, 1.709), (0.050, 0.198, 1.709), 0.012),
        *_sides(lambda s: _rod("cover", "cylinder", (0.096 * s, 0.135, 1.675), (0.114 * s, 0.135, 1.675), 0.034)),
        *_sides(lambda s: _rod("dark", "cylinder", (0.114 * s, 0.135, 1.675), (0.117 * s, 0.135, 1.675), 0.022)),
        _rod("cover", "capsule", (-0.022, 0.2150, 1.609), (0.022, 0.2150, 1.609), 0.0045),
    ],
}

_EYE = [_ball("eyeball", (-0.004, 0, 0), 0.0225),
        _rod("metal", "cylinder", (0.0135, 0, 0), (0.0180, 0, 0), 0.0105),
        _rod("lens", "cylinder", (0.0180, 0, 0), (0.0186, 0, 0), 0.0080),
        _rod("metal", "cylinder", (0.0120, 0, -0.0140), (0.0180, 0, -0.0140), 0.0050),
        _rod("lens", "cylinder", (0.0180, 0, -0.0140), (0.0186, 0, -0.0140), 0.0036)]

IN_BODY_FRAME = {
    "eye_l_pan": _EYE,
    "eye_r_pan": _EYE,
    "arm_r_shoulder1": [_ball("shell", (0.004, 0, 0.030), (0.068, 0.070, 0.062)),
                        _rod("cover", "cylinder", (0, 0, 0.070), (0, 0, 0.100), 0.045)],
    "arm_r_shoulder2": [_ball("cover", (0.0095, 0.0222, 0), (0.050, 0.052, 0.050))],
    "arm_r_upperarm": [
        _rod("cover", "cylinder", (0, 0, -0.050), (0, 0, -0.085), 0.046),
        _rod("shell", "capsule", (0.001, 0, -0.115), (0.001, 0, -0.225), 0.046),
        _rod("cover", "cylinder", (0.003, 0, -0.245), (0.004, 0, -0.262), 0.042),
        _rod("metal", "capsule", (0.005, 0, -0.255), (0.018, 0, -0.300), 0.030),
    ],
    "arm_r_elbow": [_rod("cover", "cylinder", (0, 0, -0.030), (0, 0, 0.046), 0.036),
                    _rod("shell", "cylinder", (0, 0, 0.046), (0, 0, 0.050), 0.030),
                    _rod("shell", "cylinder", (0, 0, -0.034), (0, 0, -0.030), 0.030)],
    "arm_r_underarm": [
        _rod("cover", "cylinder", (0, 0, -0.030), (0, 0, -0.065), 0.038),
        _rod("shell", "capsule", (-0.001, 0.001, -0.090), (-0.001, 0.001, -0.165), 0.045),
        _rod("shell", "capsule", (0, 0, -0.160), (0, 0, -0.185), 0.038),
        _rod("metal", "cylinder", (0, 0, -0.190), (0, 0, -0.232), 0.024),
    ],
    "arm_r_wrist1": [_rod("dark", "cylinder", (0, 0, -0.028), (0, 0, 0.028), 0.016)],
    "arm_r_wrist2": [_rod("metal", "cylinder", (0, 0, -0.029), (0, 0, 0.029), 0.017)],
    "hand_r": [
        _rod("metal", "cylinder", (-0.004, 0.010, 0.012), (-0.012, 0.020, 0.034), 0.020),
        _shape("dark", "box", pos=(-0.016, 0.0224, 0.0465), size=(0.030, 0.040, 0.0195)),
        *[_rod("cover", "capsule", (0.0115, y, 0.032), (0.0115, y, 0.062), 0.009)
          for y in (-0.012, 0.011, 0.034, 0.057)],
        *[_rod("dark", "capsule", (-0.046, y, 0.033), (-0.046, y, 0.060), 0.007) for y in (-0.014, 0.0595)],
        _rod("dark", "capsule", (-0.0455, -0.0165, 0.0465), (-0.0455, 0.0615, 0.0465), 0.0071),
        _rod("metal", "cylinder", (-0.0489, -0.012, 0.06525), (-0.0489, 0.012, 0.06525), 0.0075),
        _rod("metal", "cylinder", (-0.0087, -0.024, 0.06525), (-0.0087, 0.069, 0.06525), 0.006),
    ],
    "hand_r_palm": [
        _shape("shell", "box", pos=(0.001, 0.0331, 0.0198), size=(0.0042, 0.0400, 0.0190)),
        *[_rod("cover", "capsule", (0.0015, y, 0.006), (0.0015, y, 0.033), 0.0062) for y in (0.0, 0.027, 0.051, 0.073)],
        _rod("metal", "cylinder", (0, -0.009, 0.0404), (0, 0.082, 0.0404), 0.0045),
    ],
}


def _phalanges():
    lengths = {"thumb": 0.0588, "index": 0.0588, "middle": 0.0588, "ring": 0.0512, "pinkie": 0.0438}
    shapes = {}
    for finger, tip in lengths.items():
        def at(back, along, side=0.0, thumb=finger == "thumb"):
            # the thumb lies along -x with its back to -z, the fingers along z with their back to +x
            return (-along, side, -back) if thumb else (back, side, along)

        joint = [_rod("metal", "cylinder", at(0, 0, -0.0085), at(0, 0, 0.0085), 0.0062)]
        bellows = [_rod("rubber", "cylinder", at(0.0035, a), at(0.0035, a + 0.0022), 0.0072)
                   for a in (-0.0052, -0.0016, 0.0020)]
        shapes[f"hand_r_{finger}_j0"] = joint + bellows + [
            _rod("cover", "capsule", at(0, 0.0085), at(0, 0.0320), 0.0078)]
        shapes[f"hand_r_{finger}_j1"] = joint + bellows + [
            _rod("cover", "capsule", at(0.0036, 0.0105), at(0.0042, tip - 0.020), 0.0086),
            _rod("rubber", "capsule", at(0.0042, tip - 0.019), at(0.0042, tip - 0.0093), 0.0092)]
    return shapes


IN_BODY_FRAME.update(_phalanges())


def add_materials(root):
    asset = add(root, "asset")
    for name, (rgba, specular, shininess) in MATERIALS.items():
        add(asset, "material", name=name, rgba=rgba, specular=specular, shininess=shininess)


def add_carrier(element):
    """Bracket of the variant's thumb, from the opposition axis to the thumb's axle."""
    add(element, "geom", class_="visual", type="cylinder", material="metal", size=0.009, fromto=(0, 0, -0.012, 0, 0, 0.012))
    add(element, "geom", class_="visual", type="capsule", material="metal", size=0.006, fromto=(0, 0, 0, -0.0402, 0, 0))


def _mirrored(body, tree):
    """X_LeftRight: takes a shape of the right body to the left one; both were published, so the frames differ."""
    sources = {name: source for name, source, _ in all_bodies()}
    left = tree.pose_in(sources[body], "Platform")
    right = tree.pose_in(sources[body.replace("_l_", "_r_").replace("hand_l", "hand_r")], "Platform")

    def point(p):
        x, y, z = transform(right, p)
        return transform(inverse(left), (-x, y, z))

    # the mirror image of a rotation, mirrored again in the shape's own x, is a rotation
    w, x, y, z = right[1]
    return point, multiply(conjugate(left[1]), (w, x, -y, -z))


def _add_shape(element, shape, point, quat):
    placed = dict(shape)
    if shape["fromto"] is not None:
        placed["fromto"] = point(shape["fromto"][:3]) + point(shape["fromto"][3:])
    else:
        placed["pos"] = point(shape["pos"])
        placed["quat"] = None if abs(quat[0]) > 1 - 1e-12 else quat
    add(element, "geom", class_="visual", **placed)


def add_visuals(element, body, pose_in_root, tree):
    """Adds the body's visual geoms; `pose_in_root` is X_RootBody at zero joint angles. Left = right mirrored."""
    to_body = inverse(pose_in_root)
    for shape in IN_ROOT_FRAME.get(body, []):
        _add_shape(element, shape, lambda p: transform(to_body, p), to_body[1])
    right = body.replace("_l_", "_r_").replace("hand_l", "hand_r")
    if body.startswith("eye") or right == body:
        for shape in IN_BODY_FRAME.get(body, []):
            _add_shape(element, shape, tuple, (1.0, 0.0, 0.0, 0.0))
        return
    point, quat = _mirrored(body, tree)
    for shape in IN_BODY_FRAME.get(right, []):
        _add_shape(element, shape, point, quat)
