// The movement primitive of a grasp file.
#include <cmath>

#include "grasp/grasp_yaml_text.h"

namespace springgrasp {
namespace {

constexpr const char* kCoordinates[] = {"x", "y", "z", "wx", "wy", "wz"};

}  // namespace

void FormatReach(std::string& out, const PoseDmp& reach) {
  auto to = std::back_inserter(out);
  const Dmp& dmp = reach.motion;
  const Eigen::Quaterniond& R = reach.R_ref;
  const double R_ref[4] = {R.w(), R.x(), R.y(), R.z()};
  fmt::format_to(to,
                 "reach:  # DMP of the grasp frame G in O: x y z (m), "
                 "rotation vector (rad)\n");
  fmt::format_to(to, "  K: {:.17g}\n  D: {:.17g}\n  alpha: {:.17g}\n  tau: {:.17g}\n", dmp.K, dmp.D,
                 dmp.alpha, dmp.tau);
  fmt::format_to(to,
                 "  reference: {}  # orientation R_OG that the rotation vector "
                 "counts from\n",
                 List(R_ref, 4));
  fmt::format_to(to, "  start: {}\n  goal: {}\n", Column(dmp.x0, 0), Column(dmp.g, 0));
  fmt::format_to(to, "  centers: {}\n  widths: {}\n", Column(dmp.centers, 0),
                 Column(dmp.widths, 0));
  for (Eigen::Index c = 0; c < 6; ++c) {
    fmt::format_to(to, "  weights_{}: {}\n", kCoordinates[c], Column(dmp.weights, c));
  }
}

void ParseReach(YamlReader yaml, PoseDmp& reach) {
  Dmp& dmp = reach.motion;
  ReadRequired(yaml, "K", dmp.K, Bounds{1e-6, 1e9});
  ReadRequired(yaml, "D", dmp.D, Bounds{0, 1e9});
  ReadRequired(yaml, "alpha", dmp.alpha, Bounds{1e-6, 1e3});
  ReadRequired(yaml, "tau", dmp.tau, Bounds{1e-3, 1e3});
  const Eigen::VectorXd R = ReadVector(yaml, "reference", 4);
  ThrowUnless(std::abs(R.norm() - 1) < 1e-2, "{}: reference has norm {}, expected 1",
              yaml.Where("reference"), R.norm());
  reach.R_ref = Eigen::Quaterniond(R[0], R[1], R[2], R[3]);
  // Only what a hand has edited is normalised; what the program wrote stays the
  // same to the bit.
  if (std::abs(R.norm() - 1) > 1e-12) reach.R_ref.normalize();
  dmp.x0 = ReadVector(yaml, "start", 6);
  dmp.g = ReadVector(yaml, "goal", 6);
  dmp.centers = ReadVector(yaml, "centers", 0);
  const auto bases = static_cast<std::size_t>(dmp.centers.size());
  ThrowUnless(bases >= 2, "{}: {} centers, expected at least 2", yaml.Where("centers"), bases);
  dmp.widths = ReadVector(yaml, "widths", bases);
  ThrowUnless(dmp.widths.minCoeff() > 0, "{}: widths must be positive", yaml.Where("widths"));
  dmp.weights.resize(dmp.centers.size(), 6);
  for (Eigen::Index c = 0; c < 6; ++c) {
    dmp.weights.col(c) = ReadVector(yaml, std::string("weights_") + kCoordinates[c], bases);
  }
  yaml.Finish();
}

}  // namespace springgrasp
