#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "base/error.h"
#include "base/random.h"
#include "grasp/grasp.h"
#include "grasp/grasp_frame.h"
#include "grasp/spring_system.h"

namespace springgrasp {
namespace {

using ::testing::HasSubstr;

Eigen::Vector3d RandomVector(RandomEngine& engine, double size) {
  return {Uniform(engine, -size, size), Uniform(engine, -size, size), Uniform(engine, -size, size)};
}

Pose RandomPose(RandomEngine& engine) {
  return MakePose(RandomVector(engine, 0.3), ExpRotation(RandomVector(engine, 1.5)));
}

// One of everything, all numbers random.
Grasp RandomGrasp(std::uint64_t seed) {
  RandomEngine engine = MakeStream(seed, 0, "test");
  Grasp grasp;
  grasp.name = "a \"quoted\" name";
  grasp.type = "tripod";
  grasp.source = "folder/demo: 1.csv";
  grasp.profile = "paper";
  grasp.hand_length = Uniform(engine, 0.15, 0.2);
  grasp.involved = InvolvedFingers("tripod");
  grasp.observed = {true, true, true, true, false};
  grasp.object_given = true;
  grasp.shape = {Shape::Kind::kCylinder, {0.1 / 3, 0.1 / 3, 0.2 / 7}};
  grasp.tip_radius = Uniform(engine, 0.005, 0.01);
  grasp.X_OH = RandomPose(engine);
  grasp.X_HG = RandomPose(engine);
  grasp.X_HP = RandomPose(engine);
  grasp.dim = 2;
  grasp.kc = Uniform(engine, 1, 2);
  grasp.dc = Uniform(engine, 0.3, 0.6);
  grasp.mass = Uniform(engine, 0.01, 0.03);
  for (const auto& [i, j] : SpringTopology("fan7")) {
    grasp.edges.push_back({i, j, Uniform(engine, 0, 1), Uniform(engine, 0.01, 0.1),
                           Uniform(engine, 0, 0.1), Uniform(engine, 0, 0.1)});
  }
  grasp.reach_gain = Uniform(engine, 20, 80);
  grasp.delay = Uniform(engine, 0, 0.3);
  grasp.closing = Uniform(engine, 1, 4);
  grasp.holding = Uniform(engine, 0.1, 1);
  grasp.ratio = "paper";
  grasp.switch_rule = "fitted";
  grasp.t_switch = Uniform(engine, 0.3, 0.5);
  for (int i = 0; i < kNumFingers; ++i) {
    grasp.offset[i] = RandomVector(engine, 0.05);
    grasp.velocity[i] = RandomVector(engine, 0.5);
    grasp.rays[i] = {RandomVector(engine, 1).normalized(), Uniform(engine, -0.5, 0.5)};
    grasp.quality.rmse[i] = Uniform(engine, 0, 0.005);
    grasp.quality.samples[i] = 100 + i;
  }
  grasp.scales = {Uniform(engine, 0.8, 2), Uniform(engine, 0.2, 0.4), Uniform(engine, 0.02, 0.05)};
  Eigen::VectorXd x0(6), g(6);
  for (int c = 0; c < 6; ++c) {
    x0[c] = Uniform(engine, -1, 1);
    g[c] = Uniform(engine, -1, 1);
  }
  DmpOptions options;
  options.tau = grasp.scales.T;
  grasp.reach.motion = MakeDmp(x0, g, options);
  for (double& w : grasp.reach.motion.weights.reshaped()) w = Uniform(engine, -50, 50);
  grasp.reach.R_ref = ExpRotation(RandomVector(engine, 1));
  grasp.quality.condition_number = Uniform(engine, 3, 50);
  return grasp;
}

TEST(GraspYamlTest, EveryNumberSurvivesWritingAndReading) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Grasp a = RandomGrasp(seed);
    const Grasp b = ParseGrasp(FormatGrasp(a), "grasp.yaml");
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.source, b.source);
    EXPECT_EQ(a.involved, b.involved);
    EXPECT_EQ(a.observed, b.observed);
    EXPECT_EQ(a.shape.kind, b.shape.kind);
    EXPECT_EQ(a.shape.size, b.shape.size);
    EXPECT_EQ(a.kc, b.kc);
    EXPECT_EQ(a.dc, b.dc);
    EXPECT_EQ(a.mass, b.mass);
    ASSERT_EQ(a.edges.size(), b.edges.size());
    for (std::size_t e = 0; e < a.edges.size(); ++e) {
      EXPECT_EQ(a.edges[e].i, b.edges[e].i);
      EXPECT_EQ(a.edges[e].j, b.edges[e].j);
      EXPECT_EQ(a.edges[e].k, b.edges[e].k);
      EXPECT_EQ(a.edges[e].rest_length, b.edges[e].rest_length);
      EXPECT_EQ(a.edges[e].damping, b.edges[e].damping);
      EXPECT_EQ(a.edges[e].standard_error, b.edges[e].standard_error);
    }
    EXPECT_EQ(a.reach_gain, b.reach_gain);
    EXPECT_EQ(a.delay, b.delay);
    EXPECT_EQ(a.t_switch, b.t_switch);
    EXPECT_EQ(a.scales.T, b.scales.T);
    EXPECT_EQ(a.scales.x0, b.scales.x0);
    EXPECT_EQ(a.offset, b.offset);
    EXPECT_EQ(a.velocity, b.velocity);
    EXPECT_EQ(a.quality.rmse, b.quality.rmse);
    EXPECT_EQ(a.quality.samples, b.quality.samples);
    EXPECT_EQ(a.reach.motion.weights, b.reach.motion.weights);
    EXPECT_EQ(a.reach.motion.x0, b.reach.motion.x0);
    EXPECT_EQ(a.reach.motion.widths, b.reach.motion.widths);
    EXPECT_EQ(a.reach.R_ref.coeffs(), b.reach.R_ref.coeffs());
    // Poses go through a quaternion: the last digit may turn.
    EXPECT_TRUE(a.X_OH.isApprox(b.X_OH, 1e-14));
    EXPECT_TRUE(a.X_HG.isApprox(b.X_HG, 1e-14));
    for (int i = 0; i < kNumFingers; ++i) {
      if (!a.involved[i]) continue;
      EXPECT_EQ(a.rays[i].direction, b.rays[i].direction);
    }
  }
}

// Text of a grasp with one line replaced; the message of the error that reading it throws.
std::string ErrorOf(const std::string& from, const std::string& to) {
  std::string text = FormatGrasp(RandomGrasp(1));
  const auto begin = text.find(from);
  EXPECT_NE(begin, std::string::npos) << from;
  text.replace(begin, text.find('\n', begin) - begin, to);
  try {
    ParseGrasp(text, "grasp.yaml");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(GraspYamlTest, NegativeMassIsAnErrorWithFileAndLine) {
  const std::string message = ErrorOf("  mass:", "  mass: -0.02");
  EXPECT_THAT(message, HasSubstr("grasp.yaml:"));
  EXPECT_THAT(message, HasSubstr("mass"));
  EXPECT_THAT(message, HasSubstr("-0.02"));
}

TEST(GraspYamlTest, MistakesAreNamed) {
  EXPECT_THAT(ErrorOf("type:", "type: clutch"), HasSubstr("pinch, tripod, power, lateral"));
  EXPECT_THAT(ErrorOf("  max_ratio:", "  maximal_ratio: 4"), HasSubstr("maximal_ratio"));
  EXPECT_THAT(ErrorOf("  dim:", "  dim: 4"), HasSubstr("dim"));
  EXPECT_THAT(ErrorOf("  shape:", "  shape: ball:0.04"), HasSubstr("grasp.yaml:"));
  EXPECT_THAT(ErrorOf("involved:", "involved: [thumb, toe]"), HasSubstr("toe"));
  EXPECT_THAT(ErrorOf("  widths:", "  widths: [1, 2]"), HasSubstr("widths"));
  EXPECT_THAT(ErrorOf("  duration:", "  duration: 0"), HasSubstr("duration"));
  EXPECT_THAT(ErrorOf("reach:  # DMP", "rich:"), HasSubstr("reach"));
}

TEST(GraspYamlTest, DerivedGainsMustAgreeButMayBeLeftOut) {
  EXPECT_THAT(ErrorOf("  omega_T:", "  omega_T: 3"), HasSubstr("omega_T"));
  EXPECT_EQ(ErrorOf("  omega_T:", "  # gone"), "");
  EXPECT_THAT(ErrorOf("  contact_stiffness:", "  contact_stiffness: 7"), HasSubstr("omega_T"));
}

TEST(GraspYamlTest, GainsRestoredForTheDemonstratedMovementAreTheSame) {
  const Grasp grasp = RandomGrasp(3);
  const SpringGains gains = GainsFor(grasp, grasp.scales);
  EXPECT_NEAR(gains.kc, grasp.kc, 1e-12);
  EXPECT_NEAR(gains.dc, grasp.dc, 1e-12);
  for (std::size_t e = 0; e < grasp.edges.size(); ++e) {
    EXPECT_NEAR(gains.k[e], grasp.edges[e].k, 1e-12);
    EXPECT_NEAR(gains.d[e], grasp.edges[e].damping, 1e-12);
  }
  EXPECT_NEAR(gains.gamma * grasp.scales.A / (grasp.mass * grasp.scales.x0), grasp.reach_gain,
              1e-9);
}

}  // namespace
}  // namespace springgrasp
