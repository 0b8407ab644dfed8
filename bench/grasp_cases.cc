#include "grasp_cases.h"

#include <fmt/format.h>

#include "base/files.h"
#include "base/random.h"
#include "experiment/grasp_requests.h"
#include "grasp/generate.h"
#include "kinematics/smooth_hand_ik.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

RobotBody BodyWith(const std::string& hand) {
  Scene scene;
  scene.hand = hand;
  scene.start = {{"arm_r_shoulder1", 0.2}, {"arm_r_elbow", 0.3}};
  Simulation simulation(BuildModel(scene));
  return MakeRobotBody(simulation);
}

Shape DrawShape(const std::string& type, const Shape& shown, RandomEngine& engine) {
  if (type == "pinch") return ParseShape(fmt::format("sphere:{}", Uniform(engine, 0.025, 0.06)));
  if (type == "tripod") {
    return ParseShape(
        fmt::format("cylinder:{}x{}", Uniform(engine, 0.04, 0.065), Uniform(engine, 0.08, 0.14)));
  }
  if (type == "power") {
    return ParseShape(fmt::format("cylinder:{}x0.18", Uniform(engine, 0.04, 0.07)));
  }
  Shape plate = shown;
  plate.size.z() = Uniform(engine, 0.004, 0.012);
  return plate;
}

}  // namespace

GraspBodies MakeGraspBodies() { return {BodyWith("documented"), BodyWith("opposition")}; }

std::vector<Grasp> ReadLibrary() {
  std::vector<Grasp> library;
  for (const char* type : {"pinch", "tripod", "power", "lateral"}) {
    library.push_back(ReadGrasp(SourceFolder() + "/models/grasps/" + type + ".yaml"));
  }
  return library;
}

int Anchor(const GraspCase& c) { return static_cast<int>(ContactSample(c.motion, c.request.dt)); }

GraspCase MakeGraspCase(const GraspBodies& bodies, const std::vector<Grasp>& library,
                        std::uint64_t seed, std::uint64_t n, double dt) {
  RandomEngine engine = MakeStream(seed, n, "grasp cases");
  const Grasp& grasp = library[n % library.size()];
  GraspCase c;
  c.type = grasp.type;
  c.body = &bodies.For(grasp.type);
  c.human = ScaledHand(c.body->human, grasp.hand_length / kMmmHandLength);
  GenerateOptions options;
  options.shape = DrawShape(grasp.type, grasp.shape, engine);
  options.tip_radius = c.body->hand.tip_radius;
  options.dt = dt;
  options.duration = Uniform(engine, 1.5, 3.0);  // s, what the planner takes
  options.X_WO = MakePose({Uniform(engine, 0.2, 0.5), Uniform(engine, 0.4, 0.6), 1.0},
                          ExpRotation({0, 0, Uniform(engine, -1.0, 1.0)}));
  const Pose X_WH_start = HandPose(c.body->arm, c.body->arm.q(c.body->arm.joints));
  const Pose X_turn = MakePose({Uniform(engine, -0.1, 0.1), Uniform(engine, -0.1, 0.1), 0},
                               ExpRotation({0, 0, Uniform(engine, -0.3, 0.3)}));
  c.motion = GenerateMotion(grasp, options);
  c.q_human = SolveHandMotionSmoothly(c.human, TipsOf(c.motion), {.dt = dt});
  c.posture = SolveContactPosture(
      c.body->hand,
      RequestContacts(c.human, c.body->hand, c.motion, c.q_human[ContactSample(c.motion, dt)]));
  options.similar_reach = true;
  options.X_WG_start = X_turn * X_WH_start * c.posture.X_HG;
  c.motion = GenerateMotion(grasp, options);
  c.q_human = SolveHandMotionSmoothly(c.human, TipsOf(c.motion), {.dt = dt});
  std::vector<Pose> X_WH;
  for (const FingertipMotionSample& sample : c.motion.samples) {
    X_WH.push_back(sample.X_WG * c.posture.X_HG.inverse());
  }
  c.request = RequestHandMotion(c.motion, c.q_human, c.posture, X_WH, options.X_WO, dt);
  return c;
}

}  // namespace springgrasp
