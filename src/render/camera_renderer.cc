#include "render/camera_renderer.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "render/camera_geometry.h"
#include "render/osmesa_context.h"
#include "sim/model_index.h"
#include "sim/mujoco_handles.h"

namespace springgrasp {
namespace {

constexpr int kMaxGeoms = 4000;
// Model and data are const for us; MuJoCo's drawing functions only lack the word.
mjData* Mutable(const mjData& data) { return const_cast<mjData*>(&data); }

void ToFloat(const Eigen::Vector3d& v, float* out) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(v[i]);
}

}  // namespace

RenderOptions RenderOptions::Pretty(int width, int height) {
  RenderOptions options;
  options.width = width;
  options.height = height;
  options.shadows = true;
  return options;
}

struct CameraRenderer::Impl {
  const mjModel& model;
  const RenderOptions& options;
  mjvScene scene;
  mjvOption visual;
  mjrContext context;
  cv::Mat rgb;
  std::vector<float> depth;

  Impl(const mjModel& m, const RenderOptions& o) : model(m), options(o) {
    InstallMujocoHandlers();
    MakeRenderContextCurrent();
    ThrowUnless(o.width > 0 && o.height > 0 && o.width <= m.vis.global.offwidth &&
                    o.height <= m.vis.global.offheight,
                "a picture of {}x{} does not fit the model's off-screen buffer of {}x{}", o.width,
                o.height, m.vis.global.offwidth, m.vis.global.offheight);
    mjv_defaultScene(&scene);
    mjr_defaultContext(&context);
    mjv_defaultOption(&visual);
    std::fill_n(visual.geomgroup, mjNGROUP, 0);
    std::fill_n(visual.sitegroup, mjNGROUP, 0);
    for (int g = 0; g < mjNGROUP && g < static_cast<int>(o.groups.size()); ++g) {
      visual.geomgroup[g] = o.groups[g];
    }
    mjv_makeScene(&model, &scene, kMaxGeoms);
    // The buffer is as large as asked for, not as the model allows: cheaper to clear and read.
    mjModel sized = model;
    sized.vis.global.offwidth = o.width;
    sized.vis.global.offheight = o.height;
    sized.vis.quality.shadowsize = o.shadows ? o.shadow_size : 0;
    mjr_makeContext(&sized, &context, mjFONTSCALE_100);
    mjr_setBuffer(mjFB_OFFSCREEN, &context);
    ThrowUnless(context.currentBuffer == mjFB_OFFSCREEN, "OSMesa: MuJoCo got no off-screen buffer");
    rgb.create(o.height, o.width, CV_8UC3);
    depth.resize(static_cast<std::size_t>(o.width) * o.height);
  }

  ~Impl() {
    const std::lock_guard lock(RenderMutex());
    MakeRenderContextCurrent();
    mjr_freeContext(&context);
    mjv_freeScene(&scene);
  }

  Pose PoseOf(const mjData& data, const CameraView& view) const {
    return view.name.empty() ? view.X_WC : CameraPose(model, data, view.name);
  }
  double FovyOf(const CameraView& view) const {
    return view.name.empty() ? view.fovy_deg : CameraFovyDeg(model, view.name);
  }

  // Fills the scene's list of geoms and points both its cameras as `view` says.
  void Update(const mjData& data, const CameraView& view) {
    MakeRenderContextCurrent();
    mjr_setBuffer(mjFB_OFFSCREEN, &context);  // another renderer may have drawn in between
    mjr_restoreBuffer(&context);
    mjvCamera any;
    mjv_defaultCamera(&any);
    mjv_updateScene(&model, Mutable(data), &visual, nullptr, &any, mjCAT_ALL, &scene);
    const Pose X_WC = PoseOf(data, view);
    const double fovy = FovyOf(view);
    const double near = model.vis.map.znear * model.stat.extent;
    const double far = model.vis.map.zfar * model.stat.extent;
    const auto top = static_cast<float>(near * std::tan(fovy * M_PI / 360));
    for (mjvGLCamera& camera : scene.camera) {
      ToFloat(X_WC.translation(), camera.pos);
      ToFloat(X_WC.linear().col(2), camera.forward);
      ToFloat(-X_WC.linear().col(1), camera.up);
      camera.frustum_center = 0;
      camera.frustum_top = top;
      camera.frustum_bottom = -top;
      camera.frustum_near = static_cast<float>(near);
      camera.frustum_far = static_cast<float>(far);
    }
    std::fill_n(scene.flags, mjNRNDFLAG, 0);
    scene.flags[mjRND_SHADOW] = options.shadows;
    scene.flags[mjRND_REFLECTION] = options.reflections;
    scene.flags[mjRND_SKYBOX] = 1;
    scene.flags[mjRND_CULL_FACE] = 1;
    if (!options.shadows && !options.reflections) DropUnseen(X_WC, fovy);
  }

  // Leaves out geoms whose bounding sphere lies beside or behind the picture: the robot's own body
  // behind its eyes costs more than all they see.
  void DropUnseen(const Pose& X_WC, double fovy_deg) {
    const Pose X_CW = X_WC.inverse();
    const double tan_y = std::tan(fovy_deg * M_PI / 360);
    const double tan_x = tan_y * options.width / options.height;
    const double secant_x = std::hypot(1, tan_x), secant_y = std::hypot(1, tan_y);
    const auto unseen = [&](const mjvGeom& g) {
      if (g.objtype != mjOBJ_GEOM || g.modelrbound <= 0) return false;
      const Eigen::Vector3d p_C = X_CW * Eigen::Vector3d(g.pos[0], g.pos[1], g.pos[2]);
      const double r = 1.05 * g.modelrbound;
      return p_C.z() < -r || std::abs(p_C.x()) - p_C.z() * tan_x > r * secant_x ||
             std::abs(p_C.y()) - p_C.z() * tan_y > r * secant_y;
    };
    scene.ngeom = static_cast<int>(std::remove_if(scene.geoms, scene.geoms + scene.ngeom, unseen) -
                                   scene.geoms);
  }

  // Where the bounding sphere of a drawn geom may be seen; rows count from the bottom.
  cv::Rect BoxOf(const mjvGeom& g, const Pose& X_CW, double fovy_deg) const {
    const cv::Rect picture(0, 0, options.width, options.height);
    const Eigen::Vector3d p_C = X_CW * Eigen::Vector3d(g.pos[0], g.pos[1], g.pos[2]);
    const double radius = 1.2 * g.modelrbound;
    if (g.modelrbound <= 0 || p_C.z() <= 2 * radius) return picture;
    const double focal = options.height / (2 * std::tan(fovy_deg * M_PI / 360));
    const double u = options.width / 2.0 + focal * p_C.x() / p_C.z();
    const double v = options.height / 2.0 - focal * p_C.y() / p_C.z();
    const double reach = focal * radius / (p_C.z() - radius) + 2;
    return cv::Rect(cv::Point(cvFloor(u - reach), cvFloor(v - reach)),
                    cv::Point(cvCeil(u + reach), cvCeil(v + reach))) &
           picture;
  }

  // Pixels of the picture just drawn that are not black.
  int CountDrawn(const cv::Rect& box) {
    if (box.empty()) return 0;
    mjr_readPixels(rgb.data, nullptr, {box.x, box.y, box.width, box.height}, &context);
    const unsigned char* pixel = rgb.data;
    int count = 0;
    for (int i = 0; i < box.area(); ++i, pixel += 3) {
      count += (pixel[0] | pixel[1] | pixel[2]) != 0;
    }
    return count;
  }

  mjrRect Viewport() const { return {0, 0, options.width, options.height}; }

  void Draw() { mjr_render(Viewport(), &scene, &context); }

  void DrawSegments() {
    scene.flags[mjRND_SEGMENT] = 1;
    scene.flags[mjRND_IDCOLOR] = 1;
    scene.flags[mjRND_SHADOW] = 0;
    scene.flags[mjRND_SKYBOX] = 0;
    Draw();
  }

  // Colours as ids of the scene's geoms (24 bits, red lowest), first row on top.
  cv::Mat DrawIds() {
    DrawSegments();
    mjr_readPixels(rgb.data, nullptr, Viewport(), &context);
    cv::Mat ids(rgb.rows, rgb.cols, CV_32SC1);
    for (int r = 0; r < rgb.rows; ++r) {
      const cv::Vec3b* from = rgb.ptr<cv::Vec3b>(rgb.rows - 1 - r);
      int* to = ids.ptr<int>(r);
      for (int c = 0; c < rgb.cols; ++c) {
        to[c] = (from[c][0] | from[c][1] << 8 | from[c][2] << 16) - 1;
      }
    }
    return ids;
  }
};

CameraRenderer::CameraRenderer(const mjModel& model, RenderOptions options)
    : options_(std::move(options)) {
  const std::lock_guard lock(RenderMutex());
  impl_ = std::make_unique<Impl>(model, options_);
}
CameraRenderer::~CameraRenderer() = default;

cv::Mat CameraRenderer::Bgr(const mjData& data, const CameraView& view,
                            const std::vector<Mark>& marks) {
  const std::lock_guard lock(RenderMutex());
  impl_->Update(data, view);
  mjvScene& scene = impl_->scene;
  for (const Mark& mark : marks) {
    if (scene.ngeom >= scene.maxgeom) break;
    mjvGeom& geom = scene.geoms[scene.ngeom++];
    const mjtNum size[3] = {mark.radius, mark.radius, mark.radius};
    const Eigen::Vector4f rgba = mark.rgba.cast<float>();
    const bool sphere = mark.kind == Mark::Kind::kSphere;
    mjv_initGeom(&geom, sphere ? mjGEOM_SPHERE : mjGEOM_ARROW, size, mark.p_W.data(), nullptr,
                 rgba.data());
    geom.category = mjCAT_DECOR;
    if (sphere) continue;
    const Eigen::Vector3d &a = mark.p_W, &b = mark.to_W;
    mjv_makeConnector(&geom, mjGEOM_ARROW, mark.radius, a.x(), a.y(), a.z(), b.x(), b.y(), b.z());
  }
  impl_->Draw();
  mjr_readPixels(impl_->rgb.data, nullptr, impl_->Viewport(), &impl_->context);
  cv::Mat flipped, bgr;
  cv::flip(impl_->rgb, flipped, 0);
  cv::cvtColor(flipped, bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

cv::Mat CameraRenderer::Depth(const mjData& data, const CameraView& view) {
  const std::lock_guard lock(RenderMutex());
  impl_->Update(data, view);
  impl_->Draw();
  mjr_readPixels(nullptr, impl_->depth.data(), impl_->Viewport(), &impl_->context);
  const double near = impl_->scene.camera[0].frustum_near;
  const double far = impl_->scene.camera[0].frustum_far;
  cv::Mat metres(options_.height, options_.width, CV_32FC1);
  for (int r = 0; r < metres.rows; ++r) {
    const float* from =
        impl_->depth.data() + static_cast<std::size_t>(metres.rows - 1 - r) * metres.cols;
    float* to = metres.ptr<float>(r);
    for (int c = 0; c < metres.cols; ++c) {
      to[c] = static_cast<float>(near * far / (far - from[c] * (far - near)));
    }
  }
  return metres;
}

cv::Mat CameraRenderer::Segmentation(const mjData& data, const CameraView& view) {
  const std::lock_guard lock(RenderMutex());
  impl_->Update(data, view);
  const mjvScene& scene = impl_->scene;
  cv::Mat ids = impl_->DrawIds();
  // From ids in the drawn list to ids in the model.
  std::vector<int> geom_of(kMaxGeoms, -1);
  for (int i = 0; i < scene.ngeom; ++i) {
    const mjvGeom& g = scene.geoms[i];
    if (g.segid >= 0 && g.segid < kMaxGeoms && g.objtype == mjOBJ_GEOM) geom_of[g.segid] = g.objid;
  }
  ids.forEach<int>([&](int& id, const int*) { id = id >= 0 && id < kMaxGeoms ? geom_of[id] : -1; });
  return ids;
}

std::vector<CameraRenderer::Visibility> CameraRenderer::CountVisible(
    const mjData& data, const CameraView& view, const std::vector<int>& geoms) {
  const std::lock_guard lock(RenderMutex());
  std::vector<Visibility> counts(geoms.size());
  const cv::Mat seen = Segmentation(data, view);
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    counts[i].visible = cv::countNonZero(seen == geoms[i]);
  }
  // Alone: the same list cut down to geoms that do not cover each other.
  const Pose X_CW = impl_->PoseOf(data, view).inverse();
  const double fovy = impl_->FovyOf(view);
  mjvScene& scene = impl_->scene;
  std::vector<std::pair<mjvGeom, std::size_t>> left;  // with the index of its count
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    for (int k = 0; k < scene.ngeom; ++k) {
      const mjvGeom& g = scene.geoms[k];
      if (g.objtype == mjOBJ_GEOM && g.objid == geoms[i]) left.emplace_back(g, i);
    }
  }
  while (!left.empty()) {
    std::vector<std::pair<cv::Rect, std::size_t>> drawn;
    std::vector<std::pair<mjvGeom, std::size_t>> later;
    scene.ngeom = 0;
    for (const auto& [g, i] : left) {
      const cv::Rect box = impl_->BoxOf(g, X_CW, fovy);
      const bool alone = std::all_of(drawn.begin(), drawn.end(), [&](const auto& other) {
        return (other.first & box).empty();
      });
      if (!alone) {
        later.emplace_back(g, i);
        continue;
      }
      scene.geoms[scene.ngeom++] = g;
      drawn.emplace_back(box, i);
    }
    impl_->DrawSegments();
    for (const auto& [box, i] : drawn) counts[i].unoccluded = impl_->CountDrawn(box);
    left = std::move(later);
  }
  return counts;
}

cv::Mat PictureOf(const mjModel& model, int width, int height, const std::string& camera,
                  const std::string& keyframe) {
  const DataPtr data = MakeData(model);
  const int key = keyframe.empty() ? 0 : IdOf(model, mjOBJ_KEY, keyframe);
  if (model.nkey > 0) mj_resetDataKeyframe(&model, data.get(), key);
  mj_forward(&model, data.get());
  CameraView view = CameraView::Named(camera);
  // An inspected file may allow only small pictures; the copy shares everything else.
  mjModel roomy = model;
  roomy.vis.global.offwidth = std::max(width, model.vis.global.offwidth);
  roomy.vis.global.offheight = std::max(height, model.vis.global.offheight);
  RenderOptions options = RenderOptions::Pretty(width, height);
  if (camera.empty()) {
    const Eigen::Vector3d centre(model.stat.center[0], model.stat.center[1], model.stat.center[2]);
    const double distance = 1.5 * model.stat.extent;
    view = CameraView::Free(
        LookAtPose(centre + distance * Eigen::Vector3d(0.5, 0.8, 0.35).normalized(), centre), 40);
  }
  CameraRenderer renderer(roomy, options);
  return renderer.Bgr(*data, view);
}

}  // namespace springgrasp
