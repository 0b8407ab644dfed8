#include "sim/simulation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "sim/box_contacts.h"
#include "sim/model_index.h"

namespace springgrasp {
namespace {

constexpr double kFastest = 1000;  // m/s, rad/s

constexpr std::array<const char*, mjNWARNING> kWarningNames = {
    "inertia matrix is singular",    "contact list is full",     "constraint list is full",
    "list of drawn geoms is full",   "bad number in a position", "bad number in a velocity",
    "bad number in an acceleration", "bad number in a control"};

void Save(const mjtNum* from, int n, std::vector<double>& to) { to.assign(from, from + n); }

void Load(const std::vector<double>& from, int n, mjtNum* to) {
  ThrowUnless(from.size() == static_cast<std::size_t>(n),
              "a snapshot of another model: {} numbers, expected {}", from.size(), n);
  std::copy(from.begin(), from.end(), to);
}

}  // namespace

Simulation::Simulation(ModelPtr model) : model_(std::move(model)) {
  ThrowUnless(model_ != nullptr, "a simulation needs a model");
  DropPhantomBoxContacts();
  data_ = MakeData(*model_);
  contacts_.reserve(128);
  Reset();
}

void Simulation::Reset() {
  const int key = FindId(*model_, mjOBJ_KEY, "start");
  if (key >= 0) {
    mj_resetDataKeyframe(model_.get(), data_.get(), key);
  } else {
    mj_resetData(model_.get(), data_.get());
  }
  divergence_.reset();
  Forward();
}

void Simulation::Forward() {
  contacts_.clear();
  FirstHalf();
  Check();
}

void Simulation::Step(int steps) {
  for (int i = 0; i < steps && !divergence_; ++i) {
    // The second half of a step first: step1 has been done, so that whoever set the controls saw
    // kinematics and inertia of this very instant. Together the same as mj_step.
    try {
      mj_step2(model_.get(), data_.get());
      ReadContacts(*model_, *data_, contacts_);
      if (!Check()) return;
      FirstHalf();
    } catch (const Error& e) {
      divergence_ = Divergence{e.what(), data_->time};
      return;
    }
    Check();
  }
}

void Simulation::FirstHalf() {
  Save(data_->qpos, model_->nq, raw_qpos_);
  mj_step1(model_.get(), data_.get());
  Save(data_->qpos, model_->nq, unit_qpos_);
}

bool Simulation::Check() {
  // MuJoCo resets the state by itself after a bad number; the count survives.
  for (int w = 0; w < mjNWARNING && !divergence_; ++w) {
    if (data_->warning[w].number > 0) divergence_ = Divergence{kWarningNames[w], data_->time};
  }
  for (int i = 0; i < model_->nq && !divergence_; ++i) {
    if (!std::isfinite(data_->qpos[i])) divergence_ = Divergence{"non-finite position", time()};
  }
  // Long before its numbers are bad for MuJoCo, a state is no mechanics any more.
  for (int i = 0; i < model_->nv && !divergence_; ++i) {
    if (std::abs(data_->qvel[i]) > kFastest) {
      divergence_ = Divergence{"speed beyond 1000 m/s or rad/s", time()};
    }
  }
  return !divergence_;
}

void Simulation::SetControl(int actuator, double value) { data_->ctrl[actuator] = value; }

void Simulation::SetControl(const std::string& actuator, double value) {
  SetControl(IdOf(*model_, mjOBJ_ACTUATOR, actuator), value);
}

Snapshot Simulation::TakeSnapshot() const {
  Snapshot s;
  s.time = data_->time;
  // The engine makes quaternions unit again on restoring, which is not idempotent to the last bit.
  const bool untouched = std::equal(unit_qpos_.begin(), unit_qpos_.end(), data_->qpos);
  Save(untouched ? raw_qpos_.data() : data_->qpos, model_->nq, s.qpos);
  Save(data_->qvel, model_->nv, s.qvel);
  Save(data_->act, model_->na, s.act);
  Save(data_->ctrl, model_->nu, s.ctrl);
  Save(data_->qacc_warmstart, model_->nv, s.qacc_warmstart);
  Save(data_->xfrc_applied, 6 * model_->nbody, s.xfrc_applied);
  Save(data_->mocap_pos, 3 * model_->nmocap, s.mocap_pos);
  Save(data_->mocap_quat, 4 * model_->nmocap, s.mocap_quat);
  return s;
}

void Simulation::Restore(const Snapshot& s) {
  mj_resetData(model_.get(), data_.get());
  data_->time = s.time;
  Load(s.qpos, model_->nq, data_->qpos);
  Load(s.qvel, model_->nv, data_->qvel);
  Load(s.act, model_->na, data_->act);
  Load(s.ctrl, model_->nu, data_->ctrl);
  Load(s.qacc_warmstart, model_->nv, data_->qacc_warmstart);
  Load(s.xfrc_applied, 6 * model_->nbody, data_->xfrc_applied);
  Load(s.mocap_pos, 3 * model_->nmocap, data_->mocap_pos);
  Load(s.mocap_quat, 4 * model_->nmocap, data_->mocap_quat);
  divergence_.reset();
  Forward();
}

void Simulation::SetJoint(const std::string& joint, double position) {
  const int id = IdOf(*model_, mjOBJ_JOINT, joint);
  const int type = model_->jnt_type[id];
  ThrowUnless(type == mjJNT_HINGE || type == mjJNT_SLIDE, "joint '{}' has no single position",
              joint);
  data_->qpos[model_->jnt_qposadr[id]] = position;
}

void Simulation::PlaceBody(const std::string& body, const Pose& X_WB) {
  const int id = IdOf(*model_, mjOBJ_BODY, body);
  const Eigen::Matrix<double, 7, 1> pose = PoseToArray(X_WB);
  if (const int mocap = model_->body_mocapid[id]; mocap >= 0) {
    std::copy_n(pose.data(), 3, data_->mocap_pos + 3 * mocap);
    std::copy_n(pose.data() + 3, 4, data_->mocap_quat + 4 * mocap);
    return;
  }
  const int joint = model_->body_jntadr[id];
  ThrowUnless(joint >= 0 && model_->jnt_type[joint] == mjJNT_FREE,
              "body '{}' cannot be placed: it is neither a mocap body nor free", body);
  std::copy_n(pose.data(), 7, data_->qpos + model_->jnt_qposadr[joint]);
  std::fill_n(data_->qvel + model_->jnt_dofadr[joint], 6, 0.0);
}

void Simulation::ApplyForce(const std::string& body, const Eigen::Vector3d& f_W) {
  const int id = IdOf(*model_, mjOBJ_BODY, body);
  std::copy_n(f_W.data(), 3, data_->xfrc_applied + 6 * id);
}

BodyState ReadBodyState(const mjModel& model, const mjData& data, int body) {
  BodyState state;
  state.X_WB = PoseFromXmat(data.xpos + 3 * body, data.xmat + 9 * body);
  state.p_WC = Vector3From(data.xipos + 3 * body);
  // cvel is taken at the centre of mass of the whole tree of the body; shift it to the body's own.
  const Eigen::Vector3d p_WT = Vector3From(data.subtree_com + 3 * model.body_rootid[body]);
  state.w_WB = Vector3From(data.cvel + 6 * body);
  state.v_WC = Vector3From(data.cvel + 6 * body + 3) + state.w_WB.cross(state.p_WC - p_WT);
  return state;
}

}  // namespace springgrasp
