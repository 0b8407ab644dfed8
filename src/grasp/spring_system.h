// Virtual springs between fingertips, auxiliary springs to their contacts, and the central force,
// as one force balance per fingertip. In 2-D and 3-D from the same code.
//
// Spring e = (i, j), with D = p_i - p_j, V = v_i - v_j, r = sqrt(D.D + eps_s^2):
//   x_e = D (1 - l / r)                                                       Eq. (2)
//   force on i: -k x_e - d xd_e, on j the opposite, xd_e = D (D.V) / r^2      Eq. (1)
// Auxiliary spring of finger i, with y = p_i - c_i, q = sqrt(y.y + eps_c^2):
//   force -kc xc_i - dc v_i, xc_i = y (1 - L_i / q)                           Eq. (3)
//   at contact points L = 0; at the object's centre L = mean radius           Eq. (6)
//   s_i = sqrt(xc_i.xc_i + eps_c^2),  u_i = xc_i / s_i
// Force ratio over the virtual finger VF = involved fingers but the thumb:
//   f_thumb = f, f_i = R f, R = min(rho^2, r_max),
//   rho = mean of s_i over VF / s_thumb                                       Eq. (4)
// Motion, with the central force f of Eq. (7) (motion/central_force.h):
//   m_i dv_i/dt = springs + involved_i (-kc xc_i - dc v_i - f_i u_i) - d0 v_i Eq. (5)
//
// Where the paper is silent or contradicts itself: soft norms make every term finite and smooth,
// the dashpot acts along the spring, f < 0 pushes away from the contact. Object and contacts are at
// rest in the frame that all points are given in.
//
// Ratio "balanced" is ours: rho^2 equalises distances before it lets fingers arrive, and hands do
// not open along contact normals (a finger unfolds across them). There f < 0 pushes every finger
// towards its place in the opened hand, in proportion to its way there, and f > 0 back in
// proportion to its distance s_i / (mean s), along xc_i - |xc_i|^2 bend_i: straight, or on an arc.
// The ways out may be arcs too: along n_i + (o_i.y) b_i with b_i of opening_bend and o_i, the part
// of n_i orthogonal to it, the chord.
// Both make the fingers arrive together, which is what Eq. (4) is for.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

namespace springgrasp {

enum class SpringDamping { kAxial, kVector, kLiteral };    // D(D.V)/r^2 | V | d/dt of Eq. (2)
enum class ForceRatio { kPaper, kReciprocal, kBalanced };  // rho^2 | 1/rho^2 | 1 while f < 0
enum class OpeningDirection { kSurface, kOutward };        // f < 0 along u | along outward normals

struct Spring {
  int i = 0, j = 1;  // fingers
  double k = 0;      // N/m
  double l = 0;      // rest length, m
  double d = 0;      // damping, N s/m
};

// Points are dim x N matrices, a column per finger; 0 is the thumb.
struct SpringSystem {
  int dim = 3;  // 2 | 3
  std::vector<Spring> springs;
  Eigen::VectorXd mass;         // N, kg
  Eigen::MatrixXd anchors;      // dim x N: contact points, or the object's centre, m
  Eigen::VectorXd rest_radius;  // N: L, 0 at contact points, mean radius for Eq. (6), m
  std::vector<bool> involved;   // N: the paper's c(i)
  // N, 0 to 1: how much of its auxiliary spring and central force an involved finger has; 1 but
  // between two grasps (grasp/blend.h), where c(i) runs from 0 to 1.
  Eigen::VectorXd share;
  // dim x N directions in which f < 0 pushes, for kOutward: unit normals at the contacts, or
  // vectors whose lengths share f among the fingers (kBalanced). Where L > 0 the radius is used
  // instead, where a column is zero u_i.
  Eigen::MatrixXd normals;
  Eigen::MatrixXd opening_bend;       // dim x N, 1/m, of the ways along `normals` (kOutward)
  Eigen::MatrixXd bend;               // dim x N, 1/m, of the ways back to the contacts (kBalanced)
  double kc = 1, dc = 0.3;            // auxiliary spring N/m and damper N s/m, of every finger
  double d0 = 0;                      // ambient damper, N s/m
  double eps_s = 1e-6, eps_c = 1e-3;  // soft norms, m
  double r_max = 16;                  // cap of R; infinity for none
  SpringDamping damping = SpringDamping::kAxial;
  ForceRatio ratio = ForceRatio::kPaper;
  OpeningDirection opening = OpeningDirection::kSurface;

  int num_fingers() const { return static_cast<int>(mass.size()); }
  int num_coordinates() const { return dim * num_fingers(); }
};

// N fingers with equal mass, nobody involved, anchors and radii zero, no springs.
SpringSystem MakeSpringSystem(int num_fingers, int dim, double mass);

// Throws Error unless sizes agree, indices are valid and masses and soft norms positive.
void CheckSpringSystem(const SpringSystem& system);

// Edges of the named topology for five fingers: fan7 (thumb to each, neighbours), brace9 (and
// index-ring, middle-pinkie), chain4, ring5, full10. fan7 and brace9 are the smallest rigid graphs
// in 2-D and 3-D. Throws Error naming the valid ones.
std::vector<std::pair<int, int>> SpringTopology(std::string_view name);

// Every intermediate quantity of one evaluation.
struct SpringTerms {
  Eigen::MatrixXd x, xdot;    // dim x springs: Eq. (2) and Eq. (1), m and m/s
  Eigen::MatrixXd xc, u;      // dim x N: Eq. (3), Eq. (6), m; direction of the central force
  Eigen::MatrixXd direction;  // dim x N: u, or the outward direction while f < 0
  Eigen::VectorXd s;          // N, m
  Eigen::VectorXd f;          // N: central force given for each finger, N
  Eigen::VectorXd ratio;      // N: of it that acts on the finger: 1, R, or ours
  double R = 1;               // Eq. (4)
  Eigen::MatrixXd acc;        // dim x N, m/s^2
};

// Evaluates Eq. (5). `p`, `v` are dim x N, `f` the central force in N. Allocates only on the first
// use of `terms`.
void EvaluateSprings(const SpringSystem& system, const Eigen::Ref<const Eigen::MatrixXd>& p,
                     const Eigen::Ref<const Eigen::MatrixXd>& v, double f, SpringTerms& terms);
// The same where every finger has a central force of its own, N of them.
void EvaluateSprings(const SpringSystem& system, const Eigen::Ref<const Eigen::MatrixXd>& p,
                     const Eigen::Ref<const Eigen::MatrixXd>& v, const Eigen::VectorXd& f,
                     SpringTerms& terms);

// Analytic derivatives of the accelerations (finger-major, dim N rows) with respect to positions
// and velocities. `terms` is that of EvaluateSprings at the same state and force.
void SpringJacobian(const SpringSystem& system, const Eigen::Ref<const Eigen::MatrixXd>& p,
                    const Eigen::Ref<const Eigen::MatrixXd>& v, const SpringTerms& terms,
                    Eigen::MatrixXd& dacc_dp, Eigen::MatrixXd& dacc_dv);

// Kinetic energy + springs k/2 (r-l)^2 + involved contacts kc/2 (q-L)^2, J. Never grows with f = 0
// and axial or vector damping.
double SpringEnergy(const SpringSystem& system, const Eigen::Ref<const Eigen::MatrixXd>& p,
                    const Eigen::Ref<const Eigen::MatrixXd>& v);

}  // namespace springgrasp
