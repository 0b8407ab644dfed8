// The video of a trial.
#pragma once

#include <string>
#include <vector>

#include "experiment/grasp_plan.h"
#include "experiment/phases.h"
#include "render/camera_renderer.h"
#include "render/video_writer.h"
#include "sim/contacts.h"
#include "sim/mujoco_handles.h"
#include "sim/robot_io.h"
#include "sim/scene.h"
#include "sim/simulation.h"

namespace springgrasp {

struct FilmOptions {
  std::string file;       // .mp4
  std::string camera;     // empty: the scene's overview cameras side by side
  bool annotate = false;  // contact forces (yellow, 10 mm per newton), fingertips of the involved
                          // fingers: planned (blue, until the grip) and reached (green)
};

// Films a trial with time and phase in the picture. It has a model of its own, with looks, so that
// a filmed trial is the same to the bit as one that is not. All references must outlive it.
class TrialFilm {
 public:
  TrialFilm(const Simulation& simulation, const RobotIo& robot, const Scene& scene,
            const GraspPlan& plan, const FilmOptions& options);

  // After every simulation step; takes a picture when it is time for one.
  void Look(const Simulation& simulation, Phase phase);
  void Finish() { writer_.Finish(); }

 private:
  std::vector<Mark> Marks(const Simulation& simulation, Phase phase) const;

  const RobotIo& robot_;
  const GraspPlan& plan_;
  const FilmOptions options_;
  ModelPtr model_;
  DataPtr data_;
  CameraRenderer renderer_;
  VideoWriter writer_;
  std::vector<std::string> cameras_;
  std::vector<GeomRole> roles_;
  double next_ = 0;         // s, of the next picture
  double reach_from_ = -1;  // s, when the reach began
};

}  // namespace springgrasp
