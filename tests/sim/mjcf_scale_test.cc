#include "sim/mjcf_scale.h"

#include <gmock/gmock.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "sim/mujoco_handles.h"

namespace springgrasp {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// Two links with everything that has a length, some of it from a default class.
const char* const kLinks = R"(
<mujoco>
  <compiler angle="radian" autolimits="true"/>
  <default>
    <default class="link"><geom type="capsule" size="0.02"/><site size="0.004"/></default>
  </default>
  <worldbody>
    <body name="upper" pos="0.1 0 0.2" childclass="link">
      <joint name="shoulder" axis="0 1 0" pos="0 0.01 0" range="-1 2"/>
      <geom fromto="0 0 0 0 0 0.3"/>
      <site name="elbow" pos="0 0 0.3"/>
      <body name="lower" pos="0 0 0.3" quat="0.8 0.6 0 0">
        <joint name="elbow" axis="1 0 0" range="0 1.5"/>
        <geom type="box" size="0.02 0.03 0.1" pos="0 0 0.1"/>
        <geom type="sphere" size="0.05" pos="0 0 0.25" mass="0.4"/>
        <site name="tip" pos="0.01 0 0.3" size="0.01"/>
      </body>
    </body>
  </worldbody>
</mujoco>
)";

std::string Scaled(const std::string& mjcf, double factor) {
  XmlDocument part;
  part.Parse(mjcf.c_str());
  ScaleMjcfPart(part, factor);
  tinyxml2::XMLPrinter printer;
  part.Print(&printer);
  return printer.CStr();
}

std::string MessageOf(const std::string& mjcf, double factor) {
  try {
    Scaled(mjcf, factor);
  } catch (const Error& e) {
    return e.what();
  }
  return "(no error)";
}

// Fails where `found` is not `factor` times `wanted`, entry by entry.
void ExpectTimes(const mjtNum* found, const mjtNum* wanted, int count, double factor,
                 const char* what) {
  for (int i = 0; i < count; ++i) {
    EXPECT_NEAR(found[i], factor * wanted[i], 1e-9 * (1 + std::abs(wanted[i]))) << what << " " << i;
  }
}

TEST(MjcfScaleTest, LengthsGrowWithTheFactorMassesWithItsCube) {
  const ModelPtr plain = LoadModelText(Scaled(kLinks, 1), "plain");
  const DataPtr plain_data = MakeData(*plain);
  RandomEngine engine = MakeStream(1, 0, "scale");
  for (const double s : {0.6, 0.873, 1.25, 2.0}) {
    SCOPED_TRACE(s);
    const ModelPtr m = LoadModelText(Scaled(kLinks, s), "scaled");
    const DataPtr d = MakeData(*m);
    for (int j = 0; j < m->nq; ++j) {
      d->qpos[j] = plain_data->qpos[j] =
          Uniform(engine, m->jnt_range[2 * j], m->jnt_range[2 * j + 1]);
    }
    mj_kinematics(plain.get(), plain_data.get());
    mj_kinematics(m.get(), d.get());
    ExpectTimes(d->site_xpos, plain_data->site_xpos, 3 * m->nsite, s, "site");
    ExpectTimes(d->xanchor, plain_data->xanchor, 3 * m->njnt, s, "joint");
    ExpectTimes(m->geom_size, plain->geom_size, 3 * m->ngeom, s, "geom size");
    for (int i = 0; i < m->nsite; ++i) {  // balls: the other two sizes mean nothing
      ExpectTimes(m->site_size + 3 * i, plain->site_size + 3 * i, 1, s, "site size");
    }
    ExpectTimes(m->body_mass, plain->body_mass, m->nbody, s * s * s, "mass");
    ExpectTimes(m->body_inertia, plain->body_inertia, 3 * m->nbody, std::pow(s, 5), "inertia");
    ExpectTimes(m->jnt_range, plain->jnt_range, 2 * m->njnt, 1, "range");
  }
}

TEST(MjcfScaleTest, WhatCannotBeScaledIsAnErrorWithItsLine) {
  const auto with = [](const std::string& element) {
    return "<mujoco>\n<worldbody>\n<body>\n" + element + "\n</body></worldbody></mujoco>";
  };
  EXPECT_THAT(MessageOf(with("<joint type='slide'/>"), 2),
              AllOf(HasSubstr("line 4"), HasSubstr("slide")));
  EXPECT_THAT(MessageOf(with("<inertial mass='1' pos='0 0 0'/>"), 2),
              AllOf(HasSubstr("line 4"), HasSubstr("<inertial>")));
  EXPECT_THAT(MessageOf(with("<geom size='big'/>"), 2),
              AllOf(HasSubstr("line 4"), HasSubstr("'big'"), HasSubstr("expected numbers")));
  EXPECT_THAT(MessageOf("<mujoco>\n<asset>\n<mesh file='a.obj'/></asset></mujoco>", 2),
              AllOf(HasSubstr("line 3"), HasSubstr("<mesh>")));
  EXPECT_THAT(MessageOf(kLinks, 0), HasSubstr("expected a positive factor"));
}

}  // namespace
}  // namespace springgrasp
