// springgrasp generate: a learned grasp for a new object, without physics.
#include <fmt/format.h>

#include <memory>
#include <string_view>

#include "apps/command.h"
#include "base/files.h"
#include "grasp/blend.h"
#include "grasp/generate.h"
#include "grasp/mesh_contacts.h"
#include "sim/object_mesh.h"

namespace springgrasp {
namespace {

struct Options {
  std::string grasp, object, shape, output, start, blend;
  double duration = 0;
  double yaw = 0;
  double part = 0.5;
  bool centre = false;
};

int Generate(const Options& options) {
  CheckOutputPath(options.output);
  Grasp grasp = ReadGrasp(options.grasp);
  GenerateOptions generate;
  constexpr std::string_view kMesh = "mesh:";
  if (options.shape.starts_with(kMesh)) {
    generate.mesh = std::make_shared<const TriangleMesh>(
        CentredMesh(ReadObjectMesh(options.shape.substr(kMesh.size()))));
    generate.shape = BoxAround(*generate.mesh);
  } else {
    generate.shape = ParseShape(options.shape);
  }
  generate.X_WO = ParsePose(options.object, "--object");
  generate.yaw = options.yaw;
  generate.object_centre = options.centre;
  if (!options.blend.empty()) {
    // On a mesh two grasps meet as they do on the box around it; its surface is met afterwards.
    grasp = BlendGrasps(grasp, ReadGrasp(options.blend), options.part, generate.shape,
                        generate.tip_radius);
  }
  if (!options.start.empty()) generate.X_WG_start = ParsePose(options.start, "--start");
  if (options.duration > 0) generate.duration = options.duration;
  const FingertipMotion motion = GenerateMotion(grasp, generate);
  MakeFolderOf(options.output);
  WriteFileAtomically(options.output, FormatFingertipMotion(motion));
  fmt::print("{}: {} samples, reach of {:.2f} s, closing from {:.2f} s\n", options.output,
             motion.samples.size(), motion.T, motion.t_switch);
  return kDone;
}

}  // namespace

void AddGenerateCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = AddCommand(
      app, "generate", "Generates reach, central force and fingertips of a grasp for an object.",
      "experiments/first_grasps/pinch.yaml --object \"0.35 0.5 0.9 1 0 0 0\" --shape sphere:0.04 "
      "-o out/motion.csv");
  command->add_option("grasp", options->grasp, "grasp YAML of `learn`")->required();
  command->add_option("--object", options->object, "pose of the object \"x y z qw qx qy qz\", m")
      ->required();
  command
      ->add_option("--shape", options->shape,
                   "sphere:D, cylinder:DxH, box:XxYxZ, metres, or mesh:FILE (OBJ, STL; its box's "
                   "middle is the object's origin)")
      ->required();
  command->add_option("-o,--output", options->output, "motion CSV")->required();
  command->add_option("--duration", options->duration, "of the reach, s (default: as demonstrated)")
      ->check(CLI::Range(0.1, 20.0));
  command->add_option("--start", options->start,
                      "pose of the grasp frame G at the start \"x y z qw qx qy qz\" (default: as "
                      "demonstrated relative to the object)");
  command->add_option("--yaw", options->yaw, "turns the reach about the object's z, rad")
      ->check(CLI::Range(-6.2832, 6.2832));
  command->add_flag("--centre", options->centre,
                    "by the object's centre and mean radius alone (Eq. (6)), without contacts");
  CLI::Option* blend = command->add_option("--blend", options->blend,
                                           "a second grasp YAML: a grasp between the two");
  command->add_option("--part", options->part, "of the way to the second grasp")
      ->check(CLI::Range(0.0, 1.0))
      ->needs(blend)
      ->capture_default_str();
  command->callback([options, &exit_code] { exit_code = Generate(*options); });
}

}  // namespace springgrasp
