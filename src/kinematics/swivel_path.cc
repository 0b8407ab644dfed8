#include "kinematics/swivel_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace springgrasp {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kKnot = 0.05;          // s, between knots
constexpr double kGrid = 0.0873;        // rad, 5 degrees
constexpr double kInset = 1e-4;         // rad, from the ends of an interval
constexpr double kSpeedWeight = 1;      // s/rad^2, of the squared joint speeds
constexpr double kBendWeight = 2e-3;    // s^3/rad^2, of the squared joint accelerations
constexpr double kSpeedReserve = 0.85;  // of max_speed, between knots; peaks are higher
constexpr double kEndPull = 20;         // per rad^2, towards the postures wanted at the ends
constexpr int kSweeps = 12;

struct Node {
  SwivelInterval interval;
  double swivel = 0;
  SevenJoints q = SevenJoints::Zero();
  double cost = 0;   // of being here
  double total = 0;  // of the best way to here
  int from = -1;     // node of the knot before
};

struct Knot {
  int sample = 0;
  ArmSolutions solutions;
  std::vector<Node> nodes;
};

class Planner {
 public:
  Planner(const ArmGeometry& geometry, const SwivelPathRequest& request,
          const ArmPreference& preference)
      : geometry_(geometry), request_(request), preference_(preference) {
    const int last = static_cast<int>(request.X_WH.size()) - 1;
    const int count = std::max(1, static_cast<int>(std::lround(last * request.dt / kKnot)));
    knots_.resize(last > 0 ? count + 1 : 1);
    for (int k = 0; k < static_cast<int>(knots_.size()); ++k) {
      knots_[k].sample = last > 0 ? static_cast<int>(std::lround(1.0 * k * last / count)) : 0;
    }
  }

  ArmPath Plan() {
    ArmPath path;
    if (!FindWay(path.reason)) return path;
    Descend();
    Interpolate(path);
    return path;
  }

 private:
  double PostureCost(const Knot& knot, const Node& node) const {
    double cost =
        ArmCost(geometry_, knot.solutions, node.interval, node.swivel, node.q, preference_);
    if (request_.obstacles) cost += request_.obstacles(node.q, knot.sample);
    return cost;
  }

  double Time(int k) const { return request_.dt * (knots_[k].sample - knots_[k - 1].sample); }

  double StepCost(const Node& a, const Node& b, double time) const {
    const SevenJoints step = b.q - a.q;
    if (step.cwiseAbs().maxCoeff() > kSpeedReserve * request_.max_speed * time) return kInfinity;
    return kSpeedWeight * step.squaredNorm() / time;
  }

  // What the ends cost beside a posture's own cost.
  double EndCost(int k, const Node& node) const {
    double cost = 0;
    if (k + 1 == static_cast<int>(knots_.size()) && request_.goal) {
      cost += kEndPull * (node.q - *request_.goal).squaredNorm();
    }
    if (k == 0 && request_.origin && !request_.start) {
      cost += kEndPull * (node.q - *request_.origin).squaredNorm();
    }
    return cost;
  }

  void AddNode(Knot& knot, const SwivelInterval& interval, double swivel, double time) {
    Node node;
    node.interval = interval;
    node.swivel = swivel;
    node.q = knot.solutions.JointsAt(interval, swivel);
    node.cost = time * PostureCost(knot, node);
    if (node.cost < kInfinity) knot.nodes.push_back(node);
  }

  void FillNodes(int k) {
    Knot& knot = knots_[k];
    knot.solutions.Solve(geometry_, request_.X_WH[knot.sample], request_.margin);
    const double time = k > 0 ? Time(k) : kKnot;
    if (k == 0 && request_.start) {
      // Where the arm stands is taken as it is, even a little outside of what is allowed later.
      const auto found = knot.solutions.SwivelOf(*request_.start);
      if (!found) return;
      Node node;
      node.interval = found->first;
      node.interval.from = node.interval.to = found->second;
      node.swivel = found->second;
      node.q = *request_.start;
      knot.nodes.push_back(node);
      return;
    }
    for (const SwivelInterval& interval : knot.solutions.intervals()) {
      const double inset = std::min(kInset, 0.4 * (interval.to - interval.from));
      const double from = interval.from + inset, width = interval.to - interval.from - 2 * inset;
      const int steps = std::max(1, static_cast<int>(std::ceil(width / kGrid)));
      for (int i = 0; i <= steps; ++i) AddNode(knot, interval, from + width * i / steps, time);
    }
  }

  bool FindWay(std::string& reason) {
    for (int k = 0; k < static_cast<int>(knots_.size()); ++k) {
      FillNodes(k);
      Knot& knot = knots_[k];
      bool any = false;
      for (Node& node : knot.nodes) {
        node.cost += EndCost(k, node);
        node.total = k == 0 ? node.cost : kInfinity;
        for (std::size_t i = 0; k > 0 && i < knots_[k - 1].nodes.size(); ++i) {
          const Node& before = knots_[k - 1].nodes[i];
          if (before.total == kInfinity) continue;
          const double total = before.total + node.cost + StepCost(before, node, Time(k));
          if (total >= node.total) continue;
          node.total = total;
          node.from = static_cast<int>(i);
        }
        any = any || node.total < kInfinity;
      }
      if (any) continue;
      reason =
          fmt::format("the arm cannot {} sample {} of {}", knot.nodes.empty() ? "reach" : "come to",
                      knot.sample, request_.X_WH.size());
      return false;
    }
    way_.resize(knots_.size());
    const std::vector<Node>& ends = knots_.back().nodes;
    int i = static_cast<int>(
        std::min_element(ends.begin(), ends.end(),
                         [](const Node& a, const Node& b) { return a.total < b.total; }) -
        ends.begin());
    for (std::size_t k = knots_.size(); k-- > 0;) {
      way_[k] = knots_[k].nodes[i];
      i = way_[k].from;
    }
    // Swivels in one run, without turns in between.
    for (std::size_t k = 1; k < way_.size(); ++k) {
      const double turns = 2 * kPi * std::round((way_[k].swivel - way_[k - 1].swivel) / (2 * kPi));
      way_[k].swivel -= turns;
      way_[k].interval.from -= turns;
      way_[k].interval.to -= turns;
    }
    return true;
  }

  double BendCost(int k, const Node& at_k, int replaced) const {
    const auto q = [&](int i) -> const SevenJoints& { return i == replaced ? at_k.q : way_[i].q; };
    const double time = Time(k);
    return kBendWeight * (q(k + 1) - 2 * q(k) + q(k - 1)).squaredNorm() / (time * time * time);
  }

  // What the way costs that depends on knot k, if it were `node`.
  double LocalCost(int k, const Node& node) const {
    const int last = static_cast<int>(way_.size()) - 1;
    double cost = (k > 0 ? Time(k) : kKnot) * PostureCost(knots_[k], node);
    if (k > 0) cost += StepCost(way_[k - 1], node, Time(k));
    if (k < last) cost += StepCost(node, way_[k + 1], Time(k + 1));
    cost += EndCost(k, node);
    for (int i = std::max(1, k - 1); i <= std::min(last - 1, k + 1); ++i) {
      cost += BendCost(i, node, k);
    }
    return cost;
  }

  // Off the grid: knot by knot to the lowest point nearby, with steps that shrink.
  void Descend() {
    double step = 0.5 * kGrid;
    for (int sweep = 0; sweep < kSweeps; ++sweep, step *= 0.7) {
      for (int k = request_.start ? 1 : 0; k < static_cast<int>(way_.size()); ++k) {
        double best = LocalCost(k, way_[k]);
        for (const double side : {step, -step}) {
          Node node = way_[k];
          const double inset = std::min(kInset, 0.4 * (node.interval.to - node.interval.from));
          node.swivel =
              std::clamp(node.swivel + side, node.interval.from + inset, node.interval.to - inset);
          node.q = knots_[k].solutions.JointsAt(node.interval, node.swivel);
          const double cost = LocalCost(k, node);
          if (cost >= best) continue;
          best = cost;
          way_[k] = node;
        }
      }
    }
  }

  // Slopes of the natural cubic spline through the knots' swivels, level at both ends.
  std::vector<double> Slopes() const {
    const int n = static_cast<int>(way_.size());
    std::vector<double> slope(n, 0.0), diagonal(n, 1.0);
    for (int k = 1; k + 1 < n; ++k) {
      const double h0 = Time(k), h1 = Time(k + 1);
      const double right = 3 * ((way_[k].swivel - way_[k - 1].swivel) / h0 / h0 +
                                (way_[k + 1].swivel - way_[k].swivel) / h1 / h1);
      const double below = k > 1 ? 1 / h0 / diagonal[k - 1] : 0;
      diagonal[k] = 2 / h0 + 2 / h1 - below / h0;
      slope[k] = right - below * slope[k - 1];
    }
    for (int k = n - 2; k >= 1; --k) {
      slope[k] = (slope[k] - slope[k + 1] / Time(k + 1)) / diagonal[k];
    }
    return slope;
  }

  void Interpolate(ArmPath& path) {
    const std::vector<double> slope = Slopes();
    const double most = 1.2 * request_.max_speed * request_.dt;
    ArmSolutions solutions;
    int k = 0;
    const int last = static_cast<int>(request_.X_WH.size()) - 1;
    for (int i = 0; i <= last; ++i) {
      if (i == 0) {
        path.q.push_back(way_[0].q);
        continue;
      }
      while (knots_[k + 1].sample < i) ++k;
      const double h = Time(k + 1), u = request_.dt * (i - knots_[k].sample) / h;
      const double wanted = (1 + 2 * u) * (1 - u) * (1 - u) * way_[k].swivel +
                            u * u * (3 - 2 * u) * way_[k + 1].swivel +
                            h * u * (1 - u) * ((1 - u) * slope[k] - u * slope[k + 1]);
      solutions.Solve(geometry_, request_.X_WH[i], i < knots_[1].sample ? 0 : request_.margin);
      // Where the branches of two knots meet, the one that goes on is nearer.
      double least = kInfinity;
      Eigen::VectorXd q;
      for (const SwivelInterval& interval : solutions.intervals()) {
        if (!interval.SameBranch(way_[k].interval) && !interval.SameBranch(way_[k + 1].interval)) {
          continue;
        }
        const double middle = 0.5 * (interval.from + interval.to);
        const double near = wanted - 2 * kPi * std::round((wanted - middle) / (2 * kPi));
        const double inside = std::clamp(near, interval.from, interval.to);
        const SevenJoints found = solutions.JointsAt(interval, inside);
        const double far = std::abs(inside - near) + (found - path.q.back()).cwiseAbs().maxCoeff();
        if (far >= least) continue;
        least = far;
        q = found.cwiseMax(geometry_.lower).cwiseMin(geometry_.upper);
      }
      if (q.size() == 0) {
        path.reason = fmt::format("the arm cannot reach sample {} of {}", i, last + 1);
        return;
      }
      const double step = (q - path.q.back()).cwiseAbs().maxCoeff();
      if (step > std::max(most, 0.02)) {
        path.reason =
            fmt::format("the arm would jump by {:.2f} rad at sample {} of {}", step, i, last + 1);
        return;
      }
      path.max_step = std::max(path.max_step, step);
      path.q.push_back(q);
    }
    path.complete = true;
  }

  const ArmGeometry& geometry_;
  const SwivelPathRequest& request_;
  const ArmPreference& preference_;
  std::vector<Knot> knots_;
  std::vector<Node> way_;
};

}  // namespace

ArmPath PlanSwivelPath(const ArmGeometry& geometry, const SwivelPathRequest& request,
                       const ArmPreference& preference) {
  if (request.X_WH.empty()) return {};
  return Planner(geometry, request, preference).Plan();
}

}  // namespace springgrasp
