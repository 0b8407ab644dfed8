// Owning pointers for MuJoCo, and the one place where its errors become ours.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <string>

namespace springgrasp {

struct MujocoDeleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using ModelPtr = std::unique_ptr<mjModel, MujocoDeleter>;
using DataPtr = std::unique_ptr<mjData, MujocoDeleter>;

// Makes mju_error throw Error and mju_warning silent (warnings are read from mjData.warning).
// After such an Error the mjData at work must be dropped. Called by the loaders below; idempotent.
void InstallMujocoHandlers();

// The last warning text of this thread since the previous call; empty if none.
std::string TakeMujocoWarning();

// Compiles MJCF. File names inside it must be absolute (from text) or relative to the file.
// Throws Error with MuJoCo's message and `name`.
ModelPtr LoadModelText(const std::string& mjcf, const std::string& name);
ModelPtr LoadModelFile(const std::string& path);

DataPtr MakeData(const mjModel& model);

}  // namespace springgrasp
