#include "render/osmesa_context.h"

#include <GL/osmesa.h>

#include <cstdlib>
#include <vector>

#include "base/error.h"

namespace springgrasp {
namespace {

constexpr int kGlRenderer = 0x1F01;  // GL_RENDERER
constexpr int kGlVersion = 0x1F02;   // GL_VERSION

// MuJoCo draws into its own framebuffer; this one only has to exist.
constexpr int kSize = 16;

struct Context {
  OSMesaContext handle = nullptr;
  std::vector<unsigned char> buffer = std::vector<unsigned char>(4 * kSize * kSize);

  Context() {
    const char* asked = std::getenv("MUJOCO_GL");
    const std::string backend = asked == nullptr || *asked == '\0' ? "osmesa" : asked;
    ThrowUnless(backend == "osmesa", "MUJOCO_GL is '{}', but this build can draw only with osmesa",
                backend);
    handle = OSMesaCreateContextExt(OSMESA_RGBA, 24, 8, 0, nullptr);
    ThrowUnless(handle != nullptr, "OSMesa: no off-screen context could be created");
  }
};

}  // namespace

void MakeRenderContextCurrent() {
  // Kept to the end of the process: destroying it at exit can come after the driver's own end.
  static Context* context = new Context();
  if (OSMesaGetCurrentContext() == context->handle) return;
  ThrowUnless(OSMesaMakeCurrent(context->handle, context->buffer.data(), 0x1401 /* bytes */, kSize,
                                kSize) != 0,
              "OSMesa: the off-screen context cannot be made current");
}

std::recursive_mutex& RenderMutex() {
  static auto* mutex = new std::recursive_mutex();
  return *mutex;
}

std::string RendererDescription() {
  const std::lock_guard lock(RenderMutex());
  MakeRenderContextCurrent();
  using GetString = const unsigned char* (*)(unsigned);
  const auto get = reinterpret_cast<GetString>(OSMesaGetProcAddress("glGetString"));
  if (get == nullptr) return "OSMesa";
  const auto text = [&](unsigned what) {
    const unsigned char* s = get(what);
    return s == nullptr ? std::string("?") : std::string(reinterpret_cast<const char*>(s));
  };
  return fmt::format("OSMesa, {}, OpenGL {}", text(kGlRenderer), text(kGlVersion));
}

}  // namespace springgrasp
