// The off-screen OpenGL context: one per process, made at the first use, kept to the end.
#pragma once

#include <string>

namespace springgrasp {

// Makes the process's context current in this thread, creating it first if need be. Throws Error
// if MUJOCO_GL asks for something other than osmesa (the default), or creation fails. All drawing
// must happen in one thread at a time.
void MakeRenderContextCurrent();

// "OSMesa, llvmpipe (...)" for --version and provenance.
std::string RendererDescription();

}  // namespace springgrasp
