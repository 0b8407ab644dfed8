// The off-screen OpenGL context: one per process, made at the first use, kept to the end.
#pragma once

#include <mutex>
#include <string>

namespace springgrasp {

// Makes the process's context current in this thread, creating it first if need be. Throws Error
// if MUJOCO_GL asks for something other than osmesa (the default), or creation fails. Hold
// RenderMutex() from here to the last drawing call.
void MakeRenderContextCurrent();

// One thread draws at a time; CameraRenderer takes it by itself.
std::recursive_mutex& RenderMutex();

// "OSMesa, llvmpipe (...)" for --version and provenance.
std::string RendererDescription();

}  // namespace springgrasp
