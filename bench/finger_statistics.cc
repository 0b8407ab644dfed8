// Position control of the pneumatic fingers: steps and grasp-like trajectories of a free hand, with
// the model-based controller and with a PID on the angle alone.
//   finger_statistics [TRAJECTORIES] [SEED]   (50, 1001)
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "base/random.h"
#include "control/pneumatic_hand.h"
#include "motion/minimum_jerk.h"
#include "sim/model_index.h"
#include "sim/pneumatics.h"
#include "sim/robot_io.h"
#include "sim/scene_builder.h"
#include "statistics_main.h"

namespace springgrasp {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kStep = 0.7, kStepDuration = 1.5, kSettled = 0.6;  // rad, s, s
constexpr double kRest = 0.3;                                       // rad, of what does not step
constexpr int kStarts = 5;
constexpr double kHeld = 1e6;  // Nm s/rad: damping that holds the arm

// Angle-only control for comparison, per valve; gains found by `finger_statistics tune`.
struct Pid {
  double proportional = 14, integral = 20, damping = 0.8;  // bar/rad, bar/(rad s), bar s/rad
};

struct Condition {
  std::string name;
  PneumaticParameters pneumatics;  // of the hand, as it is
  bool model_based = true;
  Pid pid;
  PneumaticGains gains;
};

// The robot's hand in the air, held by its arm, gravity along one of six directions of the hand.
class FreeHand {
 public:
  FreeHand(const Condition& condition, int gravity, RandomEngine engine)
      : condition_(condition),
        simulation_(BuildModel(Built(condition.pneumatics))),
        robot_(simulation_.model()),
        model_(robot_.layout()),
        drives_(condition.pneumatics, simulation_.timestep(), engine) {
    if (condition.pneumatics.model_error > 0) {
      model_ = WithErrors(model_, condition.pneumatics.model_error, engine);
    }
    mjModel& m = const_cast<mjModel&>(simulation_.model());
    m.opt.disableflags |= mjDSBL_CONTACT;
    for (int i = 0; i < m.nv; ++i) {
      if (NameOf(m, mjOBJ_JOINT, m.dof_jntid[i]).rfind("arm_", 0) == 0) m.dof_damping[i] = kHeld;
    }
    const Eigen::Vector3d down =
        robot_.HandPose(simulation_).linear().col(gravity / 2) * (gravity % 2 == 0 ? 9.81 : -9.81);
    std::copy_n(down.data(), 3, m.opt.gravity);
  }

  double dt() const { return simulation_.timestep(); }

  // At rest at q, chambers filled.
  void Start(const HandVector& q) {
    robot_.Place(robot_.Read(simulation_).arm_q, q, simulation_);
    simulation_.Forward();
    HandTarget target;
    target.q = q;
    for (int i = 0; i < std::lround(2.0 / dt()); ++i) Step(target);
  }

  // With the valves of `opened` let out, whatever the controller wants.
  void Step(HandTarget target, const std::array<bool, kNumValves>& opened = {}) {
    RobotState state = robot_.Read(simulation_);
    const ValveVector pressure = state.pressure;
    drives_.Sense(state);
    target.sensing_delay = condition_.pneumatics.sensing_delay;
    RobotCommand command;
    command.valve_pressure =
        condition_.model_based ? ControlHand(model_, condition_.gains, target, state, dt(), memory_)
                               : ControlPid(target, state);
    for (int v = 0; v < kNumValves; ++v) {
      if (opened[v]) command.valve_pressure[v] = 0;
    }
    command.valve_pressure = drives_.Step(command.valve_pressure, pressure);
    robot_.Write(command, simulation_);
    simulation_.Step();
  }

  // True angles, as means over the joints of each valve.
  ValveVector Angles() const {
    return MeanOfValves(robot_.layout(), robot_.Read(simulation_).hand_q);
  }
  const HandLayout& layout() const { return robot_.layout(); }

 private:
  static Scene Built(const PneumaticParameters& pneumatics) {
    Scene scene = ParseScene("active: [right_arm, right_hand]\n", "finger_statistics");
    scene.pneumatics = pneumatics;
    return scene;
  }

  ValveVector ControlPid(const HandTarget& target, const RobotState& state) {
    const ValveVector error =
        MeanOfValves(layout(), target.q) - MeanOfValves(layout(), state.hand_q);
    const ValveVector speed = MeanOfValves(layout(), state.hand_qd);
    ValveVector u;
    for (int v = 0; v < kNumValves; ++v) {
      const double wanted =
          condition_.pid.proportional * error[v] + integral_[v] - condition_.pid.damping * speed[v];
      u[v] = std::clamp(wanted, 0.0, kMaxPressureBar);
      // Integrates only where that does not drive the valve further into its stop.
      if (wanted == u[v] || (wanted - u[v]) * error[v] < 0) {
        integral_[v] += condition_.pid.integral * error[v] * dt();
      }
    }
    return u;
  }

  const Condition& condition_;
  Simulation simulation_;
  RobotIo robot_;
  PneumaticHandModel model_;
  PneumaticDrives drives_;
  HandControlState memory_;
  ValveVector integral_ = ValveVector::Zero();
};

// What is moved: the joints of one valve, or of all valves of the fingers at once (valve -1).
HandVector Posture(const HandLayout& layout, int valve, double angle) {
  HandVector q = HandVector::Constant(layout.num_joints(), kRest);
  for (int j = 1; j < layout.num_joints(); ++j) {
    if (valve < 0 || layout.valve_of_joint[j] == valve) q[j] = angle;
  }
  return q;
}

struct StepRow {
  int count = 0;
  double rise_sum = 0, rise = 0, overshoot_sum = 0, overshoot = 0, late_sum = 0, late = 0;
  int impossible = 0;      // that no controller can end in time
  double late_within = 0;  // largest of all others
  void Add(double t, double over, double error, bool possible) {
    ++count;
    if (possible) late_within = std::max(late_within, error);
    if (!possible) ++impossible;
    rise_sum += t, overshoot_sum += over, late_sum += error;
    rise = std::max(rise, t);
    overshoot = std::max(overshoot, over);
    late = std::max(late, error);
  }
};

// Which valves, let out from the first moment, come within 3 degrees of `to` in time.
std::array<bool, kNumValves> OpensInTime(const Condition& condition, int gravity, int valve,
                                         double from, double to) {
  FreeHand hand(condition, gravity, MakeStream(0, 0, "finger"));
  hand.Start(Posture(hand.layout(), valve, from));
  HandTarget target;
  target.q = Posture(hand.layout(), valve, to);
  std::array<bool, kNumValves> opened, in_time;
  for (int v = 0; v < kNumValves; ++v) opened[v] = v == valve || (valve < 0 && v > 0);
  for (int i = 0; i < std::lround(kSettled / hand.dt()); ++i) hand.Step(target, opened);
  for (int v = 0; v < kNumValves; ++v) in_time[v] = hand.Angles()[v] < to + 3 / kDegrees;
  return in_time;
}

// Steps of all five starts, valves and gravity directions.
StepRow Steps(const Condition& condition, bool closing, bool together, std::uint64_t seed) {
  StepRow row;
  for (int gravity = 0; gravity < 6; ++gravity) {
    for (int valve = together ? -1 : 1; valve < (together ? 0 : kNumValves); ++valve) {
      for (int s = 0; s < kStarts; ++s) {
        FreeHand hand(
            condition, gravity,
            MakeStream(seed, static_cast<std::uint64_t>(100 * gravity + 10 * s), "finger"));
        const double low = 0.2 * s, from = closing ? low : low + kStep;
        const double to = closing ? low + kStep : low, sign = closing ? 1 : -1;
        hand.Start(Posture(hand.layout(), valve, from));
        HandTarget target;
        target.q = Posture(hand.layout(), valve, to);
        ValveVector rise = ValveVector::Constant(kStepDuration);
        ValveVector over = ValveVector::Zero(), late = ValveVector::Zero();
        for (int i = 0; i < std::lround(kStepDuration / hand.dt()); ++i) {
          hand.Step(target);
          const double t = (i + 1) * hand.dt();
          const ValveVector q = hand.Angles();
          for (int v = 1; v < kNumValves; ++v) {
            const double done = sign * (q[v] - from) / kStep;
            if (done >= 0.9) rise[v] = std::min(rise[v], t);
            over[v] = std::max(over[v], done - 1);
            if (t >= kSettled) late[v] = std::max(late[v], std::abs(q[v] - to));
          }
        }
        std::array<bool, kNumValves> possible;
        possible.fill(true);
        if (!closing) possible = OpensInTime(condition, gravity, valve, from, to);
        for (int v = 1; v < kNumValves; ++v) {
          if (valve < 0 || v == valve) row.Add(rise[v], over[v], late[v], possible[v]);
        }
      }
    }
  }
  return row;
}

void PrintSteps(const Condition& condition, std::uint64_t seed) {
  for (const bool closing : {true, false}) {
    for (const bool together : {false, true}) {
      const StepRow r = Steps(condition, closing, together, seed);
      const double n = r.count;
      fmt::print(
          "{:<34} {:<8} {:<10} {:>4}  {:.3f} / {:.3f}   {:>5.1f} / {:>5.1f}   {:>5.2f} / "
          "{:>5.2f}; {} impossible, others {:.2f}\n",
          condition.name, closing ? "closing" : "opening", together ? "together" : "alone", r.count,
          r.rise_sum / n, r.rise, 100 * r.overshoot_sum / n, 100 * r.overshoot,
          kDegrees * r.late_sum / n, kDegrees * r.late, r.impossible, kDegrees * r.late_within);
      std::fflush(stdout);
    }
  }
}

// All fingers open to a preshape and close on an object, as in a reach of 1 s.
struct TrajectoryRow {
  double rms = 0, worst_rms = 0, largest = 0;
};
TrajectoryRow Trajectories(const Condition& condition, int count, std::uint64_t seed) {
  TrajectoryRow row;
  double squares = 0;
  for (int n = 0; n < count; ++n) {
    RandomEngine engine = MakeStream(seed, static_cast<std::uint64_t>(n), "trajectory");
    FreeHand hand(condition, n % 6, MakeStream(seed, static_cast<std::uint64_t>(n), "finger"));
    HandVector start = HandVector::Zero(hand.layout().num_joints()), wide = start, closed = start;
    start[0] = wide[0] = closed[0] = kRest;  // the palm's spring cannot lift the fingers
    for (int j = 1; j < start.size(); ++j) {
      const int v = hand.layout().valve_of_joint[j];
      const bool shares = hand.layout().valve_of_joint[j - 1] == v;
      start[j] = shares ? start[j - 1] : Uniform(engine, 0.2, 0.5);
      wide[j] = shares ? wide[j - 1] : start[j] - Uniform(engine, 0.1, 0.2);
      closed[j] = shares ? closed[j - 1] : wide[j] + Uniform(engine, 0.5, 1.0);
    }
    hand.Start(start);
    const double opening = Uniform(engine, 0.35, 0.45);  // s
    const auto at = [&](double t) -> HandVector {
      if (t < opening) return start + MinimumJerkPosition(t / opening) * (wide - start);
      return wide +
             MinimumJerkPosition(std::min(1.0, (t - opening) / (1 - opening))) * (closed - wide);
    };
    ValveVector sum = ValveVector::Zero();
    const auto steps = std::lround(1.0 / hand.dt());
    const double h = 0.005;
    for (long i = 0; i < steps; ++i) {
      const double t = static_cast<double>(i) * hand.dt();
      HandTarget target;
      target.q = at(t);
      target.qd = (at(t + h) - at(std::max(0.0, t - h))) / (t < h ? t + h : 2 * h);
      target.qdd = (at(t + h) - 2 * at(t) + at(std::max(0.0, t - h))) / (h * h);
      hand.Step(target);
      ValveVector error = hand.Angles() - MeanOfValves(hand.layout(), at(t + hand.dt()));
      error[0] = 0;
      sum += error.cwiseAbs2();
      row.largest = std::max(row.largest, error.cwiseAbs().maxCoeff());
    }
    squares += sum.sum() / (kNumValves - 1) / static_cast<double>(steps);
    row.worst_rms = std::max(row.worst_rms, std::sqrt(sum.maxCoeff() / static_cast<double>(steps)));
  }
  row.rms = std::sqrt(squares / count);
  return row;
}

PneumaticParameters Imperfect() {
  PneumaticParameters p;
  p.sensing_delay = 0.015;
  p.angle_noise = 0.0044;   // rad, a quarter of a degree
  p.pressure_noise = 0.02;  // bar
  p.model_error = 0.2;
  return p;
}

// Coarse grid for the PID, by the mean error over closing and opening steps, seed below 1000.
void TunePid() {
  for (const double kp : {4.0, 8.0, 14.0}) {
    for (const double ki : {8.0, 20.0, 50.0}) {
      for (const double kd : {0.0, 0.4, 0.8, 1.4}) {
        Condition c{"", {}, false, {kp, ki, kd}, {}};
        const StepRow a = Steps(c, true, true, 1), b = Steps(c, false, true, 1);
        const TrajectoryRow t = Trajectories(c, 6, 1);
        fmt::print(
            "{} {} {}: closing {:.3f} {:.1f} {:.2f} opening {:.3f} {:.1f} {:.2f} rms {:.2f}\n", kp,
            ki, kd, a.rise, 100 * a.overshoot, kDegrees * a.late, b.rise, 100 * b.overshoot,
            kDegrees * b.late, kDegrees * t.rms);
      }
    }
  }
}

int Main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "tune") {
    TunePid();
    return 0;
  }
  const int count = argc > 1 ? std::atoi(argv[1]) : 50;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1001;
  const std::vector<Condition> conditions = {
      {"model-based", {}, true, {}, {}},
      {"PID on the angle", {}, false, {}, {}},
      {"model-based, late, noisy, +-20 %", Imperfect(), true, {}, {}},
      {"PID, late, noisy", Imperfect(), false, {}, {}},
  };
  fmt::print(
      "steps of {} rad, 5 starts, 7 valves, 6 directions of gravity: time to 90 % (s), overshoot "
      "(%), largest error after {} s (degrees); each mean / worst; steps that the spring does not "
      "end in time even if the valve is let out from the first moment, and the worst of the "
      "others\n",
      kStep, kSettled);
  for (const Condition& c : conditions) PrintSteps(c, seed);
  fmt::print(
      "\n{} grasp-like trajectories of 1 s: error RMS, worst valve's RMS, largest (degrees)\n",
      count);
  for (const Condition& c : conditions) {
    const TrajectoryRow r = Trajectories(c, count, seed);
    fmt::print("{:<34} {:>6.2f} {:>6.2f} {:>6.2f}\n", c.name, kDegrees * r.rms,
               kDegrees * r.worst_rms, kDegrees * r.largest);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace springgrasp

int main(int argc, char** argv) { return StatisticsMain(argc, argv, springgrasp::Main); }
