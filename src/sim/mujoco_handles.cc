#include "sim/mujoco_handles.h"

#include <array>
#include <filesystem>
#include <mutex>

#include "base/error.h"

namespace springgrasp {
namespace {

thread_local std::string last_warning;

void OnError(const char* message) { throw Error(fmt::format("MuJoCo: {}", message)); }
void OnWarning(const char* message) { last_warning = message; }

// First line of MuJoCo's message: one clear line is what the user gets.
std::string OneLine(const char* message) {
  std::string line(message);
  for (char& c : line) {
    if (c == '\n') c = ' ';
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line;
}

ModelPtr Load(const std::string& file, const mjVFS* vfs, const std::string& name) {
  InstallMujocoHandlers();
  std::array<char, 1024> message{};
  ModelPtr model(mj_loadXML(file.c_str(), vfs, message.data(), static_cast<int>(message.size())));
  ThrowUnless(model != nullptr, "{}: not a valid model: {}", name, OneLine(message.data()));
  return model;
}

}  // namespace

void InstallMujocoHandlers() {
  static std::once_flag once;
  std::call_once(once, [] {
    mju_user_error = OnError;
    mju_user_warning = OnWarning;
  });
}

std::string TakeMujocoWarning() { return std::exchange(last_warning, {}); }

ModelPtr LoadModelText(const std::string& mjcf, const std::string& name) {
  constexpr const char* kVirtualFile = "springgrasp_scene.xml";
  auto vfs = std::make_unique<mjVFS>();  // megabytes: never on the stack
  mj_defaultVFS(vfs.get());
  ThrowUnless(mj_makeEmptyFileVFS(vfs.get(), kVirtualFile, static_cast<int>(mjcf.size())) == 0,
              "{}: MJCF of {} bytes does not fit the virtual file system", name, mjcf.size());
  const int index = mj_findFileVFS(vfs.get(), kVirtualFile);
  std::copy(mjcf.begin(), mjcf.end(), static_cast<char*>(vfs->filedata[index]));
  struct Free {
    mjVFS* vfs;
    ~Free() { mj_deleteVFS(vfs); }
  } free{vfs.get()};
  return Load(kVirtualFile, vfs.get(), name);
}

ModelPtr LoadModelFile(const std::string& path) {
  ThrowUnless(std::filesystem::is_regular_file(path), "{}: no such model file", path);
  return Load(path, nullptr, path);
}

DataPtr MakeData(const mjModel& model) {
  InstallMujocoHandlers();
  DataPtr data(mj_makeData(&model));
  ThrowUnless(data != nullptr, "MuJoCo: no memory for the state of a model");
  return data;
}

}  // namespace springgrasp
