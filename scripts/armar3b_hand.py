"""The pneumatic hand: palm, phalanges, the opposition joint of the variant, valves and their sensors."""

from armar3b_tree import FINGERS, hand_frame
from mjcf_tools import add, remark

PAD_RADIUS = 0.0093          # end sphere of the distal capsule: half the width of the published distal mesh
PROXIMAL_RADIUS = 0.008
PALM_HALF_THICKNESS = 0.006  # published plate: 3.3 mm; thicker, so that no object passes it within one step
MASS = {"carpus": 0.2, "palm": 0.1, "j0": 0.012, "j1": 0.018}  # kg

# Chambers. Torque per bar = 1e5 Pa x effective area x lever arm.
AREA_CM2 = {"finger": 1.0, "palm": 2.0}
LEVER_CM = 1.0
FILL_TIME = 0.1              # s
SUPPLY_BAR, EXHAUST_BAR = 5.0, 0.0
STIFFNESS = {"finger": 0.08, "palm": 0.16}   # of the return spring, Nm/rad
SPRING_REST = -0.2           # rad before the joint's lower end
DAMPING = 0.02               # Nm s/rad
FRICTION = 0.002             # Nm
ARMATURE = 0.0001            # kg m^2
RANGE = {"finger": 1.570796, "palm": 0.698132}

# The variant's thumb turns about the long axis of the hand, through the palm; positive towards the index.
OPPOSITION_AXIS_AT = (-0.0087, 0.0, 0.06525)  # m, in the frame of the hand's base
OPPOSITION_RANGE = (-0.523599, 1.745329)
CARRIER_MASS = 0.02          # kg, taken off the carpus


def torque_per_bar(kind):
    return 1e5 * AREA_CM2[kind] * 1e-4 * LEVER_CM * 1e-2


def add_defaults(main):
    hand = add(main, "default", class_="hand")
    add(hand, "geom", group=3, type="capsule", condim=4, friction=(0.9, 0.005, 0.0001), solref=(0.01, 1),
        solimp=(0.95, 0.99, 0.001), rgba=(0.8, 0.5, 0.3, 0.6))
    add(hand, "joint", armature=ARMATURE, damping=DAMPING, frictionloss=FRICTION, stiffness=STIFFNESS["finger"],
        springref=SPRING_REST, range=(0, RANGE["finger"]), solreflimit=(0.01, 1), solimplimit=(0.95, 0.99, 0.01))
    add(hand, "general", dyntype="filter", dynprm=FILL_TIME, gaintype="fixed", gainprm=1, biastype="none",
        gear=torque_per_bar("finger"), ctrlrange=(EXHAUST_BAR, SUPPLY_BAR))
    palm = add(hand, "default", class_="palm")
    add(palm, "joint", stiffness=STIFFNESS["palm"], frictionloss=2 * FRICTION, range=(0, RANGE["palm"]))
    add(palm, "general", gear=torque_per_bar("palm"))
    opposition = add(hand, "default", class_="opposition")
    add(opposition, "joint", springref=OPPOSITION_RANGE[0] + SPRING_REST, range=OPPOSITION_RANGE)
    frame = add(main, "default", class_="frame")
    add(frame, "site", group=4, size=0.005, rgba=(1, 0.8, 0.1, 1))
    tip = add(main, "default", class_="tip")
    add(tip, "site", group=4, size=PAD_RADIUS + 0.001, rgba=(0.1, 0.8, 0.3, 0.4))
    pad = add(main, "default", class_="pad")
    add(pad, "site", group=4, size=0.002, rgba=(0.1, 0.8, 0.3, 1))


def add_carpus(element, side, tree, opposition):
    letter, hand = side.upper(), f"hand_{side}"
    base = f"Hand {letter} Base"
    offset = tree.pose_in(f"Hand Palm 1 {letter}", base)[0]
    centre, half = tree.nodes[f"Hand Palm 1 {letter}"]["box"]
    add(element, "geom", class_="hand", name=f"{hand}_carpus_box", type="box",
        pos=[a + b for a, b in zip(offset, centre)], size=half,
        mass=MASS["carpus"] - (CARRIER_MASS if opposition else 0))
    add(element, "site", class_="frame", name=f"{hand}_H", quat=hand_frame(tree, side))
    for name, source in (("tcp", "TCP {}"), ("gcp", "GCP {}"), ("tcp_precision", "TCP {} Precision"),
                         ("tcp_power", "TCP {} Power")):
        pos, quat = tree.pose_in(source.format(letter), base)
        add(element, "site", class_="frame", name=f"{hand}_{name}", pos=pos, quat=quat)


def add_palm(element, side, tree):
    centre, half = tree.nodes[f"Hand Palm 2 {side.upper()}"]["box"]
    add(element, "geom", class_="hand", name=f"hand_{side}_palm_box", type="box", pos=centre,
        size=(PALM_HALF_THICKNESS, half[1], half[2]), mass=MASS["palm"])
    add(element, "site", class_="frame", name=f"hand_{side}_palm_centre",
        pos=(centre[0] - PALM_HALF_THICKNESS, centre[1], centre[2]), quat=hand_frame(tree, side))


def add_phalanx(element, body, side, tree):
    """Proximal capsule on the joint line; distal capsule on the published axis, its end sphere being the pad."""
    finger, is_distal = body.split("_")[2], body.endswith("j1")
    axis, sign = (0, -1.0) if finger == "thumb" else (2, 1.0)
    if not is_distal:
        end = [0.0] * 3
        end[axis] = sign * 0.0402
        add(element, "geom", class_="hand", name=f"{body}_capsule", fromto=[0, 0, 0] + end, size=PROXIMAL_RADIUS,
            mass=MASS["j0"])
        return
    tip = tree.fingertip(side, finger)
    start, end = list(tip), list(tip)
    start[axis] = sign * (PAD_RADIUS - 0.0026)  # the published mesh begins 2.6 mm before the joint
    end[axis] -= sign * PAD_RADIUS
    add(element, "geom", class_="hand", name=f"{body}_capsule", fromto=start + end, size=PAD_RADIUS, mass=MASS["j1"])
    add(element, "site", class_="tip", name=f"hand_{side}_{finger}_tip", pos=end)
    palmar = (0.0, 0.0, 1.0) if finger == "thumb" else (-1.0, 0.0, 0.0)
    add(element, "site", class_="pad", name=f"hand_{side}_{finger}_pad",
        pos=[e + PAD_RADIUS * n for e, n in zip(end, palmar)],
        quat=None if finger == "thumb" else (0.5**0.5, 0, -(0.5**0.5), 0))


def add_opposition(hand, side):
    """The body that carries the variant's thumb; its axis is turned over on the left, so that + is the index."""
    name = f"hand_{side}_thumb_opposition"
    carrier = add(hand, "body", name=name, pos=OPPOSITION_AXIS_AT)
    add(carrier, "joint", class_="opposition", name=name, axis=(0, 0, 1 if side == "r" else -1))
    add(carrier, "inertial", pos=(-0.02, 0, 0), mass=CARRIER_MASS, diaginertia=(1e-6, 4e-6, 4e-6))
    return carrier


def valves(opposition):
    """Valve and the joints it drives, both without the hand's prefix."""
    pairs = [(f"{f}_{part}", (f"{f}_j{j}",)) for f in ("index", "middle")
             for j, part in enumerate(("proximal", "distal"))]
    thumb = ([("thumb_opposition", ("thumb_opposition",)), ("thumb_flexion", ("thumb_j0", "thumb_j1"))] if opposition
             else [("thumb_proximal", ("thumb_j0",)), ("thumb_distal", ("thumb_j1",))])
    shared = tuple(f"{f}_j{j}" for f in ("ring", "pinkie") for j in (0, 1))
    return [("palm", ("palm",)), *thumb, *pairs, ("ring_pinkie", shared)]


def add_valves(tendons, actuators, side, opposition):
    hand = f"hand_{side}"
    remark(actuators, f"{hand}: control, activation and force in bar; torque = gear (Nm/bar) times pressure")
    for valve, joints in valves(opposition):
        name = f"{hand}_{valve}"
        if len(joints) == 1:
            class_ = "palm" if valve == "palm" else "hand"
            add(actuators, "general", class_=class_, name=name, joint=f"{hand}_{joints[0]}")
            continue
        tendon = add(tendons, "fixed", name=name)
        for joint in joints:
            add(tendon, "joint", joint=f"{hand}_{joint}", coef=1)
        add(actuators, "general", class_="hand", name=name, tendon=name)


def add_sensors(sensors, side, opposition):
    hand = f"hand_{side}"
    for finger in FINGERS:
        add(sensors, "touch", name=f"{hand}_{finger}_touch", site=f"{hand}_{finger}_tip")
    for valve, _ in valves(opposition):
        add(sensors, "actuatorfrc", name=f"{hand}_{valve}_pressure", actuator=f"{hand}_{valve}")


# Postures as joint angles, rad: palm, opposition of the variant's thumb, thumb (j0, j1), index, middle, and one angle for
# the four joints of ring and pinkie (one pressure). The pinch and tripod leave
# 40 mm between the pads.
POSTURES = {
    "open": (0, 0, (0, 0), (0, 0), (0, 0), 0),
    "power": (0.2, 0, (0.4, 0.3), (0.55, 0.75), (0.55, 0.75), 0.65),
    "pinch": (0.1, 0, (0.9, 0.05), (0.35, 0.45), (0.1, 0.1), 1.2),
    "pinch with opposition": (0.1, 0.17, (0.4, 0.4), (0.8, 0.15), (0.1, 0.1), 1.2),
    "tripod": (0.1, 0, (0.9, 0.05), (0.35, 0.45), (0.35, 0.45), 1.2),
    "tripod with opposition": (0.1, 0, (0.4, 0.4), (0.8, 0.15), (0.8, 0.15), 1.2),
    # the documented thumb cannot come beside the index: it lies over the bent fingers' ends
    "lateral": (0, 0, (0.3, 0.5), (1.0, 1.2), (1.0, 1.2), 1.1),
    "lateral with opposition": (0, 0.6, (0.85, 0.85), (0.6, 1.1), (0.7, 1.15), 1.0),
}


def posture_angles(posture, opposition):
    """Joint angles by joint name without prefix, in the order of the model's joints."""
    palm, turned, thumb, index, middle, rest = POSTURES.get(f"{posture} with opposition" if opposition else posture,
                                                            POSTURES[posture])
    angles = {"palm": palm}
    for finger, pair in (("index", index), ("middle", middle), ("ring", (rest, rest)), ("pinkie", (rest, rest))):
        angles.update({f"{finger}_j{j}": pair[j] for j in (0, 1)})
    if opposition:
        angles["thumb_opposition"] = turned
    angles.update({f"thumb_j{j}": thumb[j] for j in (0, 1)})  # the thumb stands behind the palm and its fingers
    return angles


def posture_pressures(angles, opposition):
    """Pressures (bar) at which springs and chambers balance at the angles, without gravity."""
    pressures = []
    for valve, joints in valves(opposition):
        kind = "palm" if valve == "palm" else "finger"
        lower = OPPOSITION_RANGE[0] if valve == "thumb_opposition" else 0.0
        mean = sum(angles[j] for j in joints) / len(joints)
        pressure = STIFFNESS[kind] * (mean - lower - SPRING_REST) / torque_per_bar(kind)
        pressures.append(0.0 if mean <= lower else pressure)
    return pressures
