// Grasp YAML: `FormatGrasp` and `ParseGrasp` name the same keys in the same order.
#include <cmath>

#include "base/files.h"
#include "grasp/grasp.h"
#include "grasp/grasp_yaml_text.h"

namespace springgrasp {
namespace {

constexpr int kFormat = 1;       // of the file; 1 if it is not given
constexpr double kAgree = 1e-6;  // relative; derived numbers in the file are checked, not used

// Double-quoted YAML text.
std::string Quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out + "\"";
}

std::string Names(const PerFinger<bool>& marked) {
  std::vector<std::string_view> names;
  for (int i = 0; i < kNumFingers; ++i) {
    if (marked[i]) names.push_back(kFingerNames[i]);
  }
  return fmt::format("[{}]", fmt::join(names, ", "));
}

int FingerIndex(YamlReader& yaml, const std::string& key, const std::string& name) {
  for (int i = 0; i < kNumFingers; ++i) {
    if (kFingerNames[i] == name) return i;
  }
  Fail("{}: '{}' is no finger, expected thumb, index, middle, ring or pinkie", yaml.Where(key),
       name);
}

PerFinger<bool> ReadFingers(YamlReader& yaml, const std::string& key) {
  yaml.Require(key);
  std::vector<std::string> names;
  yaml.Read(key, names);
  PerFinger<bool> marked = {};
  for (const std::string& name : names) marked[FingerIndex(yaml, key, name)] = true;
  return marked;
}

void CheckDerived(YamlReader& yaml, const std::string& key, double derived) {
  if (!yaml.Has(key)) return;
  double value = 0;
  yaml.Read(key, value);
  ThrowUnless(std::abs(value - derived) <= kAgree * std::max(1.0, std::abs(derived)),
              "{}: {} is {}, but the springs and the movement above give {}; change them "
              "together, or leave this line out",
              yaml.Where(key), key, value, derived);
}

void FormatSprings(std::string& out, const Grasp& grasp) {
  auto to = std::back_inserter(out);
  const DimensionlessGains gains = GainsOf(grasp);
  fmt::format_to(to, "springs:\n  dim: {}\n", grasp.dim);
  fmt::format_to(to, "  hand_plane: {}  # X_HP, used where dim is 2\n", List(grasp.X_HP));
  fmt::format_to(to, "  mass: {:.17g}  # kg, of every fingertip\n", grasp.mass);
  fmt::format_to(to, "  contact_stiffness: {:.17g}  # kc, N/m\n", grasp.kc);
  fmt::format_to(to, "  contact_damping: {:.17g}  # dc, N s/m\n", grasp.dc);
  fmt::format_to(to, "  ambient_damping: {:.17g}  # d0, N s/m\n", grasp.ambient_damping);
  fmt::format_to(to, "  ratio: {}  # of Eq. (4): paper | reciprocal | balanced\n", grasp.ratio);
  fmt::format_to(to, "  max_ratio: {:.17g}\n", grasp.max_ratio);
  fmt::format_to(to, "  edges:  # k N/m, rest_length m, damping N s/m, at the duration below\n");
  for (const GraspEdge& edge : grasp.edges) {
    fmt::format_to(to,
                   "    - {{fingers: [{}, {}], k: {:.17g}, rest_length: {:.17g}, "
                   "damping: {:.17g}, standard_error: {:.17g}}}\n",
                   kFingerNames[edge.i], kFingerNames[edge.j], edge.k, edge.rest_length,
                   edge.damping, edge.standard_error);
  }
  fmt::format_to(to, "gains:  # dimensionless\n");
  fmt::format_to(to, "  reach: {:.17g}  # gamma A / (m x0)\n", gains.reach);
  fmt::format_to(to, "  delay: {:.17g}  # of f_cen, fraction of T\n", gains.delay);
  fmt::format_to(to, "  closing: {:.17g}  # beta, on f_cen > 0\n", gains.closing);
  fmt::format_to(to, "  holding: {:.17g}  # f_cen after T / (kc x0)\n", gains.holding);
  fmt::format_to(to, "  # follow from the springs and the movement; checked when present\n");
  fmt::format_to(to, "  omega_T: {:.17g}  # T sqrt(kc / m)\n", gains.omega_T);
  fmt::format_to(to, "  zeta: {:.17g}  # dc / (2 sqrt(kc m))\n", gains.zeta);
  fmt::format_to(to, "  stiffness: {}  # k / kc, per edge\n", List(gains.stiffness));
}

void ParseSprings(YamlReader& yaml, Grasp& grasp) {
  YamlReader springs = yaml.Child("springs");
  ReadRequired(springs, "dim", grasp.dim, Bounds{2, 3});
  springs.Read("hand_plane", grasp.X_HP);
  ReadRequired(springs, "mass", grasp.mass, Bounds{1e-6, 100});
  ReadRequired(springs, "contact_stiffness", grasp.kc, Bounds{1e-9, 1e9});
  ReadRequired(springs, "contact_damping", grasp.dc, Bounds{0, 1e9});
  springs.Read("ambient_damping", grasp.ambient_damping, Bounds{0, 1e9});
  springs.Read("ratio", grasp.ratio, {"paper", "reciprocal", "balanced"});
  springs.Read("max_ratio", grasp.max_ratio, Bounds{1, 1e6});
  springs.Require("edges");
  for (YamlReader& item : springs.Children("edges")) {
    GraspEdge edge;
    item.Require("fingers");
    std::vector<std::string> names;
    item.Read("fingers", names);
    ThrowUnless(names.size() == 2 && names[0] != names[1],
                "{}: a spring joins two different fingers", item.Where("fingers"));
    edge.i = FingerIndex(item, "fingers", names[0]);
    edge.j = FingerIndex(item, "fingers", names[1]);
    ReadRequired(item, "k", edge.k, Bounds{0, 1e9});
    ReadRequired(item, "rest_length", edge.rest_length, Bounds{0, 1});
    ReadRequired(item, "damping", edge.damping, Bounds{0, 1e9});
    item.Read("standard_error", edge.standard_error, Bounds{0, 1e12});
    item.Finish();
    grasp.edges.push_back(edge);
  }
  springs.Finish();

  YamlReader gains = yaml.Child("gains");
  ReadRequired(gains, "reach", grasp.reach_gain, Bounds{0, 1e6});
  gains.Read("delay", grasp.delay, Bounds{0, 0.9});
  gains.Read("closing", grasp.closing, Bounds{0, 1e6});
  gains.Read("holding", grasp.holding, Bounds{0, 1e6});
  const DimensionlessGains derived = GainsOf(grasp);
  CheckDerived(gains, "omega_T", derived.omega_T);
  CheckDerived(gains, "zeta", derived.zeta);
  std::vector<double> stiffness = derived.stiffness;
  gains.Read("stiffness", stiffness, Bounds{0, 1e9});
  ThrowUnless(stiffness.size() == grasp.edges.size(), "{}: stiffness has {} numbers, expected {}",
              gains.Where("stiffness"), stiffness.size(), grasp.edges.size());
  for (std::size_t e = 0; e < stiffness.size(); ++e) {
    ThrowUnless(std::abs(stiffness[e] - derived.stiffness[e]) <= kAgree * (1 + stiffness[e]),
                "{}: stiffness of edge {} is {}, but k and contact_stiffness above give {}; "
                "change them together, or leave this line out",
                gains.Where("stiffness"), e, stiffness[e], derived.stiffness[e]);
  }
  gains.Finish();
}

void FormatFingers(std::string& out, const Grasp& grasp) {
  auto to = std::back_inserter(out);
  fmt::format_to(to, "fingers:  # offset (m) from the contact at the start; uninvolved: from H\n");
  for (int i = 0; i < kNumFingers; ++i) {
    fmt::format_to(to, "  - finger: {}\n", kFingerNames[i]);
    if (grasp.involved[i]) {
      fmt::format_to(to, "    contact_direction: {}  # ray in O\n", List(grasp.rays[i].direction));
      fmt::format_to(to, "    contact_height: {:.17g}  # of the object's, -0.5 to 0.5\n",
                     grasp.rays[i].height);
    }
    if (grasp.involved[i] && grasp.share[i] != 1) {
      fmt::format_to(to, "    share: {:.17g}  # of c(i), between two grasps\n", grasp.share[i]);
      fmt::format_to(to, "    clearance: {:.17g}  # of the contact, m\n", grasp.clearance[i]);
    }
    fmt::format_to(to, "    offset: {}\n", List(grasp.offset[i]));
    fmt::format_to(to, "    velocity: {}\n", List(grasp.velocity[i]));
    if (grasp.involved[i] && !grasp.opening[i].isZero(0)) {
      fmt::format_to(to, "    opening: {}  # from the contact in H, m\n", List(grasp.opening[i]));
    }
    if (grasp.involved[i] && !grasp.opening_bend[i].isZero(0)) {
      fmt::format_to(to, "    opening_bend: {}  # of that way, in H, 1/m\n",
                     List(grasp.opening_bend[i]));
    }
    if (grasp.involved[i] && !grasp.bend[i].isZero(0)) {
      fmt::format_to(to, "    bend: {}  # of the way back, in H, 1/m\n", List(grasp.bend[i]));
    }
    if (grasp.involved[i] && grasp.lag[i] != 0) {
      fmt::format_to(to, "    lag: {:.17g}  # closes later than t_switch, fraction of T\n",
                     grasp.lag[i]);
    }
  }
}

void ParseFingers(YamlReader& yaml, Grasp& grasp) {
  PerFinger<bool> found = {};
  for (YamlReader& item : yaml.Children("fingers")) {
    item.Require("finger");
    std::string name;
    item.Read("finger", name);
    const int i = FingerIndex(item, "finger", name);
    ThrowUnless(!found[i], "{}: finger '{}' is given twice", item.Where("finger"), name);
    found[i] = true;
    if (grasp.involved[i]) {
      ReadRequired(item, "contact_direction", grasp.rays[i].direction, Bounds{-1.01, 1.01});
      ReadRequired(item, "contact_height", grasp.rays[i].height, Bounds{-0.5, 0.5});
      ThrowUnless(std::abs(grasp.rays[i].direction.norm() - 1) < 1e-2,
                  "{}: contact_direction has length {}, expected 1",
                  item.Where("contact_direction"), grasp.rays[i].direction.norm());
    }
    ReadRequired(item, "offset", grasp.offset[i], Bounds{-2, 2});
    item.Read("velocity", grasp.velocity[i], Bounds{-20, 20});
    if (grasp.involved[i]) {
      item.Read("share", grasp.share[i], Bounds{0, 1});
      item.Read("clearance", grasp.clearance[i], Bounds{0, 1});
      item.Read("opening", grasp.opening[i], Bounds{-2, 2});
      item.Read("opening_bend", grasp.opening_bend[i], Bounds{-1e3, 1e3});
      item.Read("bend", grasp.bend[i], Bounds{-1e3, 1e3});
      item.Read("lag", grasp.lag[i], Bounds{-1, 1});
    }
    item.Finish();
  }
  for (int i = 0; i < kNumFingers; ++i) {
    ThrowUnless(found[i], "{}: finger '{}' is missing", yaml.Where("fingers"), kFingerNames[i]);
  }
}

void FormatQuality(std::string& out, const GraspQuality& quality) {
  auto to = std::back_inserter(out);
  fmt::format_to(to, "quality:  # how well it reproduces its demonstration, m\n");
  fmt::format_to(to, "  rmse: {}  # thumb to pinkie\n",
                 List(quality.rmse.data(), quality.rmse.size()));
  const std::vector<double> samples(quality.samples.begin(), quality.samples.end());
  fmt::format_to(to, "  samples: {}\n", List(samples));
  fmt::format_to(to, "  begin: {:.17g}  # of the reach, s of the recording\n", quality.begin);
  fmt::format_to(to, "  reach_rmse: {:.17g}\n", quality.reach_rmse);
  fmt::format_to(to, "  aperture: [{:.17g}, {:.17g}]  # widest, observed and reproduced\n",
                 quality.aperture, quality.aperture_reproduced);
  fmt::format_to(to, "  aperture_time: [{:.17g}, {:.17g}]  # fractions of T\n",
                 quality.aperture_time, quality.aperture_time_reproduced);
  fmt::format_to(to, "  aperture_rmse: {:.17g}\n", quality.aperture_rmse);
  fmt::format_to(to, "  condition_number: {:.17g}\n", quality.condition_number);
  fmt::format_to(to, "  planarity: {:.17g}\n", quality.planarity);
  fmt::format_to(to, "  noise: {:.17g}\n", quality.noise);
}

void ParseQuality(YamlReader yaml, GraspQuality& quality) {
  std::vector<double> rmse(kNumFingers, 0.0), samples(kNumFingers, 0.0);
  yaml.Read("rmse", rmse, Bounds{0, 1e3});
  yaml.Read("samples", samples, Bounds{0, 1e9});
  ThrowUnless(rmse.size() == kNumFingers && samples.size() == kNumFingers,
              "{}: rmse and samples need {} numbers", yaml.Where("rmse"), kNumFingers);
  for (int i = 0; i < kNumFingers; ++i) {
    quality.rmse[i] = rmse[static_cast<std::size_t>(i)];
    quality.samples[i] = static_cast<int>(samples[static_cast<std::size_t>(i)]);
  }
  yaml.Read("begin", quality.begin, Bounds{-1e6, 1e9});
  yaml.Read("reach_rmse", quality.reach_rmse, Bounds{0, 1e3});
  std::vector<double> aperture(2, 0.0), time(2, 0.0);
  yaml.Read("aperture", aperture, Bounds{0, 10});
  yaml.Read("aperture_time", time, Bounds{0, 10});
  ThrowUnless(aperture.size() == 2 && time.size() == 2,
              "{}: aperture and aperture_time need 2 numbers", yaml.Where("aperture"));
  quality.aperture = aperture[0];
  quality.aperture_reproduced = aperture[1];
  quality.aperture_time = time[0];
  quality.aperture_time_reproduced = time[1];
  yaml.Read("aperture_rmse", quality.aperture_rmse, Bounds{0, 10});
  yaml.Read("condition_number", quality.condition_number, Bounds{0, 1e300});
  yaml.Read("planarity", quality.planarity, Bounds{0, 1e3});
  yaml.Read("noise", quality.noise, Bounds{0, 1e3});
  yaml.Finish();
}

}  // namespace

std::string FormatGrasp(const Grasp& grasp) {
  std::string out = "# A grasp of the springgrasp library: SI units, quaternions w first.\n";
  auto to = std::back_inserter(out);
  fmt::format_to(to, "format: {}\n", kFormat);
  fmt::format_to(to, "name: {}\ntype: {}\nsource: {}\nprofile: {}\n", Quoted(grasp.name),
                 grasp.type, Quoted(grasp.source), grasp.profile);
  fmt::format_to(to, "hand_length: {:.17g}\ntip_radius: {:.17g}\n", grasp.hand_length,
                 grasp.tip_radius);
  fmt::format_to(to, "involved: {}  # the paper's c(i)\nobserved: {}\n", Names(grasp.involved),
                 Names(grasp.observed));
  fmt::format_to(to, "object:\n  origin: {}\n  shape: {}\n",
                 grasp.object_given ? "given" : "inferred", FormatShape(grasp.shape));
  fmt::format_to(to, "  hand: {}  # X_OH at contact\n", List(grasp.X_OH));
  fmt::format_to(to, "grasp_frame: {}  # X_HG at contact\n", List(grasp.X_HG));
  fmt::format_to(to, "movement:\n  duration: {:.17g}  # T, s\n  length: {:.17g}  # A, m\n",
                 grasp.scales.T, grasp.scales.A);
  fmt::format_to(to, "  distance: {:.17g}  # x0, mean distance from the contacts at t = 0, m\n",
                 grasp.scales.x0);
  fmt::format_to(to, "  switch: {}  # of f_cen: learned (peak speed) | fitted\n",
                 grasp.switch_rule);
  fmt::format_to(to, "  t_switch: {:.17g}  # fraction of T\n", grasp.t_switch);
  FormatSprings(out, grasp);
  FormatFingers(out, grasp);
  FormatReach(out, grasp.reach);
  FormatQuality(out, grasp.quality);
  return out;
}

Grasp ParseGrasp(const std::string& text, const std::string& name) {
  YamlReader yaml = YamlReader::FromText(text, name);
  Grasp grasp;
  int format = kFormat;
  yaml.Read("format", format, Bounds{1, 1e6});
  ThrowUnless(format == kFormat, "{}: format {} is not known, this program reads {}",
              yaml.Where("format"), format, kFormat);
  ReadRequired(yaml, "name", grasp.name);
  ReadRequired(yaml, "type", grasp.type,
               std::vector<std::string>{"pinch", "tripod", "power", "lateral"});
  yaml.Read("source", grasp.source);
  yaml.Read("profile", grasp.profile, {"human", "paper", "unforced"});
  yaml.Read("hand_length", grasp.hand_length, Bounds{0.05, 0.5});
  yaml.Read("tip_radius", grasp.tip_radius, Bounds{0, 0.05});
  grasp.involved = ReadFingers(yaml, "involved");
  grasp.observed = yaml.Has("observed") ? ReadFingers(yaml, "observed") : grasp.involved;

  yaml.Require("object");
  YamlReader object = yaml.Child("object");
  std::string origin = "inferred";
  object.Read("origin", origin, {"given", "inferred"});
  grasp.object_given = origin == "given";
  std::string shape;
  ReadRequired(object, "shape", shape);
  try {
    grasp.shape = ParseShape(shape);
  } catch (const Error& error) {
    Fail("{}: {}", object.Where("shape"), error.what());
  }
  ReadRequired(object, "hand", grasp.X_OH);
  object.Finish();
  ReadRequired(yaml, "grasp_frame", grasp.X_HG);

  yaml.Require("movement");
  YamlReader movement = yaml.Child("movement");
  ReadRequired(movement, "duration", grasp.scales.T, Bounds{1e-3, 1e3});
  ReadRequired(movement, "length", grasp.scales.A, Bounds{1e-6, 1e3});
  ReadRequired(movement, "distance", grasp.scales.x0, Bounds{1e-6, 10});
  movement.Read("switch", grasp.switch_rule, {"learned", "fitted"});
  movement.Read("t_switch", grasp.t_switch, Bounds{0, 1});
  movement.Finish();

  yaml.Require("springs");
  yaml.Require("gains");
  ParseSprings(yaml, grasp);
  yaml.Require("fingers");
  ParseFingers(yaml, grasp);
  yaml.Require("reach");
  ParseReach(yaml.Child("reach"), grasp.reach);
  ParseQuality(yaml.Child("quality"), grasp.quality);
  yaml.Finish();
  return grasp;
}

Grasp ReadGrasp(const std::string& path) { return ParseGrasp(ReadFile(path), path); }

void WriteGrasp(const Grasp& grasp, const std::string& path) {
  WriteFileAtomically(path, FormatGrasp(grasp));
}

}  // namespace springgrasp
